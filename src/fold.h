/* P and colours on (u,w) of which one part lies mirrored beyond the ends of u, as mesh.h lays what is mirrored: beyond `hi` and below `lo` u goes
 * back again. Their partials by u turn their sign there.
 */
#ifndef KAGE_FOLD_H
#define KAGE_FOLD_H

#include "perturb.h"
#include "pigment.h"

/* Own p, also on failure. NULL: out of memory. */
perturb *perturb_folded(perturb *p, double lo, double hi);
pigment *pigment_folded(pigment *p, double lo, double hi);

#endif
