/* The functions of bumpshadow.h in loops over arrays, in double. */
#define BS_DOUBLE
#include "methods_loops.h"
