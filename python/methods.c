/* The functions of bumpshadow.h in loops over arrays, in float. */
#include "methods_loops.h"
