/* Rays without sense against a surface: of length 0, NaN or infinite, along faces and axes, through corners and poles.
 */
#ifndef KAGE_ODD_RAYS_H
#define KAGE_ODD_RAYS_H

#include "geometry/surface.h"
#include "support/check.h"
#include "support/random_rays.h"

/* Of each ray r + s t, given as r and s, there is a hit or none; but never a t that is not finite and positive, nor a
 * part that does not exist; and the lane beside the last ray is not touched. */
static inline void check_odd_rays(const surface *f, int n, const double (*odd)[6])
{
    static rays x;
    static hits h;
    static partials q;
    static ray_origins from;
    int32_t part[LANES];
    real u[LANES], w[LANES], lit[LANES];
    for (int i = 0; i < n; i++) {
        vec3s_set(&x.r, i, (vec3){odd[i][0], odd[i][1], odd[i][2]});
        vec3s_set(&x.s, i, (vec3){odd[i][3], odd[i][4], odd[i][5]});
        from.id[i] = i % 2;
        from.part[i] = i % f->ops->parts;
        lit[i] = 1;
    }
    from.at = x.r;
    no_hits(&h, n + 1);
    f->ops->hit(f, n, &x, 0, &h);
    f->ops->hit_own(f, n, &x, &from, 0, &h);
    f->ops->locate(f, n, &x, h.t, part, u, w);
    f->ops->eval(f, n, part, u, w, 2, &q);
    f->ops->occlude(f, n, &x, lit);
    for (int i = 0; i < n; i++) {
        BETWEEN(-1, h.id[i], 0);
        CHECK(h.t[i], >, 0);
        CHECK(h.t[i], <=, REAL_FAR);
        BETWEEN(0, part[i], f->ops->parts - 1);
        CHECK(lit[i] == 0 || lit[i] == 1, ==, 1);
    }
    if (f->ops->occlude_own)
        f->ops->occlude_own(f, n, &x, part, lit);
    for (int i = 0; i < n; i++)
        CHECK(lit[i] == 0 || lit[i] == 1, ==, 1);
    assert_int_equal(h.id[n], -1);
}

#endif
