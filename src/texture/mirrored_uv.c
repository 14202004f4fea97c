#include "texture/mirrored_uv.h"

#include <stdlib.h>

typedef struct ends {
    real lo, hi;
} ends;

/* u where it is looked up, and the sign of du there. */
STAGE static void fold(int n, const ends *k, const real *restrict u, real *restrict to, real *restrict sign)
{
    const real lo = k->lo, hi = k->hi;
    for (int i = 0; i < n; i++) {
        const real x = u[i], y = x > hi ? 2 * hi - x : x, z = y < lo ? 2 * lo - y : y;
        to[i] = z;
        sign[i] = z == x ? R(1) : R(-1);
    }
}

STAGE static void turn(int n, const real *restrict sign, real *restrict x)
{
    for (int i = 0; i < n; i++)
        x[i] *= sign[i];
}

typedef struct folded_perturb {
    bump base;
    bump_ops methods; /* the kind is that of what is folded; without jets and bound, as meshes are no sheets */
    bump *of;
    ends k;
} folded_perturb;

static void perturb_eval(const bump *base, int n, const real *u, const real *w, int order, bump_values *h)
{
    const folded_perturb *f = (const folded_perturb *)base;
    real at[LANES], sign[LANES];
    fold(n, &f->k, u, at, sign);
    f->of->ops->eval(f->of, n, at, w, order, h);
    if (order >= 1)
        turn(n, sign, h->Pu);
    if (order >= 2)
        turn(n, sign, h->Puw);
}

static void perturb_end(bump *base)
{
    bump_free(((folded_perturb *)base)->of);
    free(base);
}

bump *bump_mirrored_uv(bump *p, double lo, double hi)
{
    folded_perturb *f = p ? malloc(sizeof *f) : NULL;
    if (!f) {
        bump_free(p);
        return NULL;
    }
    *f = (folded_perturb){
        *p, {.kind = p->ops->kind, .eval = perturb_eval, .free = perturb_end}, p, {(real)lo, (real)hi}};
    f->base.ops = &f->methods;
    return &f->base;
}

typedef struct folded_pigment {
    color_texture base;
    color_texture_ops methods;
    color_texture *of;
    ends k;
} folded_pigment;

static void pigment_eval(const color_texture *base, int n, const real *u, const real *w, vec3s *color)
{
    const folded_pigment *f = (const folded_pigment *)base;
    real at[LANES], sign[LANES];
    fold(n, &f->k, u, at, sign);
    f->of->ops->eval(f->of, n, at, w, color);
}

static void pigment_end(color_texture *base)
{
    color_texture_free(((folded_pigment *)base)->of);
    free(base);
}

color_texture *color_mirrored_uv(color_texture *p, double lo, double hi)
{
    folded_pigment *f = p ? malloc(sizeof *f) : NULL;
    if (!f) {
        color_texture_free(p);
        return NULL;
    }
    *f = (folded_pigment){*p, {p->ops->kind, pigment_eval, pigment_end}, p, {(real)lo, (real)hi}};
    f->base.ops = &f->methods;
    return &f->base;
}
