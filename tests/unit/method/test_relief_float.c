/* bumpshadow.h's place to shade and own shadows, in float. */
#define BUMPSHADOW_NAME "relief in float"
#include "relief_cases.h"
