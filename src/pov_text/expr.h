/* An expression in the syntax of POV-Ray's functions, in the variables u and w. */
#ifndef KAGE_POV_TEXT_EXPR_H
#define KAGE_POV_TEXT_EXPR_H

#include "expr/expr.h"

/* The text, owned by the caller (free). NULL: it has noise or numbers that are not finite, which POV-Ray lacks; it is
 * longer than 256 KiB; or out of memory. */
char *expr_pov(const expr *e);

#endif
