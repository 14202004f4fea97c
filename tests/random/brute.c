/* bvh/bvh.h and bvh/wide.h without hierarchies: each ray is told to reach every box. With it in place of bvh/'s own
 * (make BVH=brute) pictures must have the same bytes, as a box only says what may be left out. */
#include "bvh/bvh.h"
#include "bvh/wide.h"

#include <math.h>
#include <stdlib.h>

struct bvh {
    int n;
};

bvh *bvh_new(int n, const bvh_box *box, int threads, const progress *w)
{
    (void)box, (void)threads, (void)w;
    bvh *b = malloc(sizeof *b);
    if (b)
        b->n = n;
    return b;
}

void bvh_free(bvh *b) { free(b); }

void bvh_along(const bvh *b, const float r[3], const float s[3], float end, bvh_visit *visit, void *user)
{
    (void)r, (void)s, (void)end;
    for (int i = 0; i < b->n; i++)
        visit(user, i);
}

void bvh_packet_toward(const bvh *b, bvh_packet *x, bvh_meet *visit, void *user)
{
    for (int i = 0; i < b->n; i++) {
        uint32_t which = 0;
        for (int k = 0; k < BVH_PACKET; k++)
            which |= x->end[k] >= 0 ? 1u << k : 0;
        if (which)
            visit(user, i, which, x->end);
    }
}

void bvh_around(const bvh *b, const float p[3], float radius, bvh_visit *visit, void *user)
{
    (void)p, (void)radius;
    for (int i = 0; i < b->n; i++)
        visit(user, i);
}

/* ---- one whose rays can wait ---- */

struct wide_bvh {
    int n;
};

/* What a whole crowd is in is made of these. */
wide_box wide_box_of(const double lo[3], const double hi[3])
{
    wide_box b;
    for (int k = 0; k < 3; k++) {
        const double air = 1e-3 * (fabs(lo[k]) + fabs(hi[k]));
        b.lo[k] = (float)(lo[k] - air);
        b.hi[k] = (float)(hi[k] + air);
    }
    return b;
}

wide_bvh *wide_new(int n, const wide_box *box, int32_t *order, int threads, const progress *show)
{
    (void)box, (void)threads, (void)show;
    wide_bvh *w = malloc(sizeof *w);
    for (int i = 0; i < n; i++)
        order[i] = i;
    if (w)
        w->n = n;
    return w;
}

void wide_free(wide_bvh *w) { free(w); }

/* A beam gives up at once, and its rays go one by one. */
void wide_beam_begin(wide_beam *k, int n, const int32_t *lane, const real *const r[3], const real *const s[3],
                     const real *end)
{
    (void)lane, (void)r, (void)s, (void)end;
    k->n = n;
    k->work = -1;
}

void wide_beam_shorten(wide_beam *k, const int32_t *lane, const real *end) { (void)k, (void)lane, (void)end; }

int32_t wide_beam_next(const wide_bvh *w, wide_beam *k, unsigned *rays)
{
    (void)w, (void)k;
    *rays = 0;
    return -1;
}

/* k->top: the items that are told already. */
void wide_begin(wide_walk *k, vec3 r, vec3 s)
{
    (void)r, (void)s;
    k->top = 0;
}

int32_t wide_next(const wide_bvh *w, wide_walk *k, double end)
{
    (void)end;
    return k->top < w->n ? k->top++ : -1;
}
