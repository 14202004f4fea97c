/* The displaced surface of a patch, as a patch. Private to displaced/. */
#ifndef KAGE_DISPLACED_OFFSET_PATCH_H
#define KAGE_DISPLACED_OFFSET_PATCH_H

#include "patch/patch.h"
#include "texture/bump.h"

/* X = Q + P n/|n|, n = Qu x Qw; both must outlive it. It is evaluated to order 1 only, and has no Hessian bounds.
 * NULL: out of memory. */
patch *patch_offset_new(const patch *q, const bump *P);

#endif
