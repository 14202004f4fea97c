/* An expression in the syntax of POV-Ray's functions, in the variables u and w. */
#ifndef KAGE_POV_TEXT_EXPR_H
#define KAGE_POV_TEXT_EXPR_H

#include "expr/expr.h"

/* The text, owned by the caller (free). NULL where there is none: POV-Ray has no such noise as ours, nor numbers that
 * are not finite; where it would be longer than 256 KiB; and where memory is out. */
char *expr_pov(const expr *e);

#endif
