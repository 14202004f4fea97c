/* bumpshadow.h's place to shade and own shadows, in double. */
#define BS_DOUBLE
#define BUMPSHADOW_NAME "relief in double"
#include "relief_cases.h"
