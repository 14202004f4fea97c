/* bumpshadow.h in float. */
#define BUMPSHADOW_NAME "bumpshadow.h in float"
#include "bumpshadow_cases.h"
