/* bumpshadow.h in double. */
#define BS_DOUBLE
#define BUMPSHADOW_NAME "bumpshadow.h in double"
#include "bumpshadow_cases.h"
