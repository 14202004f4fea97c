/* Bumps and colours that wrap another one and reflect u at the ends of a range before they look it up. */
#include "texture/mirrored_uv.h"

#include <stdlib.h>

/* Where u is reflected. */
typedef struct ends {
    real lo, hi;
} ends;

/* u after reflection, and the sign of its derivative. */
STAGE static void reflect(int n, const ends *k, const real *restrict u, real *restrict to, real *restrict sign)
{
    const real lo = k->lo, hi = k->hi;
    for (int i = 0; i < n; i++) {
        const real x = u[i], y = x > hi ? 2 * hi - x : x, z = y < lo ? 2 * lo - y : y;
        to[i] = z;
        sign[i] = z == x ? R(1) : R(-1);
    }
}

STAGE static void apply_sign(int n, const real *restrict sign, real *restrict x)
{
    for (int i = 0; i < n; i++)
        x[i] *= sign[i];
}

typedef struct mirrored_bump {
    bump base;
    bump_ops methods; /* of the original's kind; no jets and no bound, which only patches need */
    bump *of;         /* the original; owned */
    ends k;
} mirrored_bump;

static void mirrored_bump_eval(const bump *base, int n, const real *u, const real *w, int order, bump_values *h)
{
    const mirrored_bump *f = (const mirrored_bump *)base;
    real at[LANES], sign[LANES];
    reflect(n, &f->k, u, at, sign);
    f->of->ops->eval(f->of, n, at, w, order, h);
    if (order >= 1)
        apply_sign(n, sign, h->Pu);
    if (order == 3)
        apply_sign(n, sign, h->Puw);
}

/* Where `reflect` puts the ends of a range: it folds at an end that the range goes beyond. */
STAGE static void reflect_range(int n, const ends *k, const real *restrict u0, const real *restrict u1,
                                real *restrict to0, real *restrict to1)
{
    const real lo = k->lo, hi = k->hi;
    for (int i = 0; i < n; i++) {
        const real a = u0[i], b = u1[i], back = 2 * hi - b;
        const real least = b > hi ? real_min(a > hi ? back : a, back) : a;
        const real most = b > hi ? (a > hi ? 2 * hi - a : hi) : b;
        const real forth = 2 * lo - least;
        to0[i] = least < lo ? (most < lo ? 2 * lo - most : lo) : least;
        to1[i] = least < lo ? real_max(most, forth) : most;
    }
}

/* On one side of a fold P runs as the original, on the other against it. */
STAGE static void either_sign(int n, bump_ranges *r)
{
    for (int i = 0; i < n; i++) {
        r->Pu_lo[i] = -r->Pu[i];
        r->Pu_hi[i] = r->Pu[i];
    }
}

static void mirrored_bump_range(const bump *base, int n, const real *u0, const real *u1, const real *w0, const real *w1,
                                bump_ranges *out)
{
    const mirrored_bump *f = (const mirrored_bump *)base;
    real from[LANES], to[LANES];
    reflect_range(n, &f->k, u0, u1, from, to);
    f->of->ops->range(f->of, n, from, to, w0, w1, out);
    either_sign(n, out);
}

/* The original keeps its pyramid. */
static bool mirrored_bump_prepare(bump *base, const progress *w)
{
    const bump *of = ((mirrored_bump *)base)->of;
    if (!bump_prepare(((mirrored_bump *)base)->of, w))
        return false;
    base->Puu_max = of->Puu_max;
    base->Puw_max = of->Puw_max;
    base->Pww_max = of->Pww_max;
    return true;
}

static void mirrored_bump_free(bump *base)
{
    bump_free(((mirrored_bump *)base)->of);
    free(base);
}

bump *bump_mirrored_uv(bump *p, double lo, double hi)
{
    mirrored_bump *f = p ? malloc(sizeof *f) : NULL;
    if (!f) {
        bump_free(p);
        return NULL;
    }
    f->base = *p;
    f->methods = (bump_ops){.kind = p->ops->kind,
                            .eval = mirrored_bump_eval,
                            .range = mirrored_bump_range,
                            .prepare = mirrored_bump_prepare,
                            .free = mirrored_bump_free};
    f->of = p;
    f->k = (ends){(real)lo, (real)hi};
    f->base.ops = &f->methods;
    f->base.pyramid = NULL;
    f->base.others = f->base.ready = 0;
    return &f->base;
}

typedef struct mirrored_color {
    color_texture base;
    color_texture_ops methods;
    color_texture *of; /* owned */
    ends k;
} mirrored_color;

static void mirrored_color_eval(const color_texture *base, int n, const real *u, const real *w, vec3s *color)
{
    const mirrored_color *f = (const mirrored_color *)base;
    real at[LANES], sign[LANES];
    reflect(n, &f->k, u, at, sign);
    f->of->ops->eval(f->of, n, at, w, color);
}

static void mirrored_color_free(color_texture *base)
{
    color_texture_free(((mirrored_color *)base)->of);
    free(base);
}

color_texture *color_mirrored_uv(color_texture *p, double lo, double hi)
{
    mirrored_color *f = p ? malloc(sizeof *f) : NULL;
    if (!f) {
        color_texture_free(p);
        return NULL;
    }
    *f = (mirrored_color){
        *p, {.kind = p->ops->kind, .eval = mirrored_color_eval, .free = mirrored_color_free}, p, {(real)lo, (real)hi}};
    f->base.ops = &f->methods;
    return &f->base;
}
