/* Rays through a wide hierarchy. All arithmetic is float's + - * / and comparisons, so the same rays reach the same
 * items everywhere. A node's box contains its items' boxes exactly, and the test of a ray and a box is monotonic, so no
 * item depends on the nodes above it.
 */
#include "bvh/wide_node.h"

#include "base/bits.h"
#include "base/real.h"

enum { WORK = 320 }; /* nodes and items that a beam tests; in more, single rays are faster */

/* What the division by 0 becomes: finite, so that 0 times it is 0. */
#define STEEP 1e30f

/* Put what is entered at x on a stack, below its top, the nearest last; not deeper than `bottom`. */
static inline void place_in_order(float *enter, int32_t *left, int bottom, int top, float x, int32_t child)
{
    int at = top;
    for (; at > bottom && enter[at - 1] < x; at--) {
        enter[at] = enter[at - 1];
        left[at] = left[at - 1];
    }
    enter[at] = x;
    left[at] = child;
}

/* ---- a ray ---- */

/* 1/s, finite. */
static float over(double s)
{
    const double x = 1 / s;
    return x > -(double)STEEP && x < (double)STEEP ? (float)x : STEEP;
}

/* An end in float, and a little later. */
static float later(double end) { return end < (double)STEEP ? (float)(end * (1 + WIDE_AIR)) : STEEP; }

void wide_begin(wide_walk *k, vec3 r, vec3 s)
{
    const double at[3] = {r.x, r.y, r.z}, way[3] = {s.x, s.y, s.z};
    const double air = WIDE_AIR * (fabs(r.x) + fabs(r.y) + fabs(r.z));
    for (int a = 0; a < 3; a++) {
        k->low[a] = (float)(at[a] + air);
        k->high[a] = (float)(at[a] - air);
        k->over[a] = over(way[a]);
    }
    k->top = 1;
    k->enter[0] = 0;
    k->left[0] = 0;
}

/* Where the ray enters the node's eight boxes. Returns a bit for each that it passes up to `end`. */
STAGE static unsigned wide_pass(const wide_node *restrict x, const wide_walk *restrict k, float end,
                                float *restrict enter)
{
    const float lx = k->low[0], ly = k->low[1], lz = k->low[2], hx = k->high[0], hy = k->high[1], hz = k->high[2];
    const float ox = k->over[0], oy = k->over[1], oz = k->over[2];
    unsigned met = 0;
    for (int c = 0; c < WIDE_WIDTH; c++) {
        const float ax = (x->lo[0][c] - lx) * ox, bx = (x->hi[0][c] - hx) * ox;
        const float ay = (x->lo[1][c] - ly) * oy, by = (x->hi[1][c] - hy) * oy;
        const float az = (x->lo[2][c] - lz) * oz, bz = (x->hi[2][c] - hz) * oz;
        const float nx = ax < bx ? ax : bx, fx = ax > bx ? ax : bx;
        const float ny = ay < by ? ay : by, fy = ay > by ? ay : by;
        const float nz = az < bz ? az : bz, fz = az > bz ? az : bz;
        const float nxy = nx > ny ? nx : ny, fxy = fx < fy ? fx : fy;
        const float in = nxy > nz ? nxy : nz, out = fxy < fz ? fxy : fz;
        const float from = in > 0 ? in : 0, to = out * (float)(1 + WIDE_AIR), last = to < end ? to : end;
        enter[c] = from;
        met |= from <= last ? 1u << c : 0;
    }
    return met;
}

/* Put the children that the ray passes on the stack, the nearest last. */
static void push(const wide_node *x, wide_walk *k, float end)
{
    float enter[WIDE_WIDTH];
    const int bottom = k->top;
    for (unsigned met = wide_pass(x, k, end, enter) & x->present; met; met &= met - 1) {
        const int c = lowest_bit(met);
        place_in_order(k->enter, k->left, bottom, k->top++, enter[c], x->child[c]);
    }
}

int32_t wide_next(const wide_bvh *w, wide_walk *k, double end)
{
    const float last = later(end);
    while (k->top > 0) {
        const int at = --k->top;
        const int32_t x = k->left[at];
        if (k->enter[at] > last)
            continue;
        if (x < 0)
            return ~x;
        push(&w->node[x], k, last);
    }
    return -1;
}

/* ---- a beam of rays ---- */

/* The least of 16 numbers, which are used up; halves are compared, as a sum over lanes would not vectorise. */
static inline float least16(float *restrict v)
{
    for (int i = 0; i < 8; i++)
        v[i] = v[i] < v[i + 8] ? v[i] : v[i + 8];
    for (int i = 0; i < 4; i++)
        v[i] = v[i] < v[i + 4] ? v[i] : v[i + 4];
    const float a = v[0] < v[2] ? v[0] : v[2], b = v[1] < v[3] ? v[1] : v[3];
    return a < b ? a : b;
}

/* The least and the most of 16 numbers. */
static inline void bounds16(const float *restrict v, float *least, float *most)
{
    float low[WIDE_RAYS], high[WIDE_RAYS];
    for (int i = 0; i < WIDE_RAYS; i++) {
        low[i] = v[i];
        high[i] = -v[i];
    }
    *least = least16(low);
    *most = -least16(high);
}

/* Ends in float, a little later, and the largest. */
STAGE static void wide_beam_ends(wide_beam *restrict k, const float *restrict end)
{
    float none;
    for (int i = 0; i < WIDE_RAYS; i++)
        k->end[i] = end[i] < STEEP ? end[i] * (float)(1 + WIDE_AIR) : STEEP;
    bounds16(k->end, &none, &k->far);
}

/* The rays at[axis] + way[axis] t, wider by their rounding, and the bounds of all. */
STAGE static void wide_beam_rays_begin(wide_beam *restrict k, const float (*restrict at)[WIDE_RAYS],
                                       const float (*restrict way)[WIDE_RAYS])
{
    float none;
    for (int i = 0; i < WIDE_RAYS; i++) {
        const float x = at[0][i], y = at[1][i], z = at[2][i];
        const float air = (float)WIDE_AIR * (fabsf(x) + fabsf(y) + fabsf(z));
        k->low[0][i] = x + air, k->high[0][i] = x - air;
        k->low[1][i] = y + air, k->high[1][i] = y - air;
        k->low[2][i] = z + air, k->high[2][i] = z - air;
    }
    for (int a = 0; a < 3; a++) {
        for (int i = 0; i < WIDE_RAYS; i++) {
            const float x = 1 / way[a][i], least = x > -STEEP ? x : STEEP;
            k->over[a][i] = least < STEEP ? least : STEEP;
        }
        bounds16(k->high[a], &k->first[a], &none);
        bounds16(k->low[a], &none, &k->last[a]);
        bounds16(way[a], &k->slow[a][0], &k->fast[a][0]); /* s itself, until turn() */
    }
}

/* Lanes of an array; for those that the beam lacks the first one. */
static void pick16(int n, const int32_t *lane, const real *from, float *to)
{
    for (int i = 0; i < WIDE_RAYS; i++)
        to[i] = (float)from[lane[i < n ? i : 0]];
}

void wide_beam_shorten(wide_beam *k, const int32_t *lane, const real *end)
{
    float to[WIDE_RAYS];
    pick16(k->n, lane, end, to);
    for (int i = k->n; i < WIDE_RAYS; i++)
        to[i] = -1;
    wide_beam_ends(k, to);
}

/* From s to what a bound of t needs. */
static void turn(float k[3], bool from_below)
{
    const float x = over((double)k[0]);
    k[0] = from_below ? x : 0;
    k[1] = from_below ? 0 : x;
    k[2] = from_below ? STEEP : 0;
}

void wide_beam_begin(wide_beam *k, int n, const int32_t *lane, const real *const r[3], const real *const s[3],
                     const real *end)
{
    float at[3][WIDE_RAYS], way[3][WIDE_RAYS];
    for (int a = 0; a < 3; a++) {
        pick16(n, lane, r[a], at[a]);
        pick16(n, lane, s[a], way[a]);
    }
    k->n = n;
    wide_beam_rays_begin(k, (const float(*)[WIDE_RAYS])at, (const float(*)[WIDE_RAYS])way);
    for (int a = 0; a < 3; a++) {
        turn(k->slow[a], k->slow[a][0] < 0);
        turn(k->fast[a], !(k->fast[a][0] < 0));
    }
    wide_beam_shorten(k, lane, end);
    k->top = 1;
    k->enter[0] = 0;
    k->left[0] = 0;
    k->work = WORK;
}

/* The bounds of t on one axis, from below and from above. */
static inline void bound(float lo, float hi, const wide_beam *k, int a, float *from, float *to)
{
    const float slow = hi - k->first[a], fast = lo - k->last[a];
    const float s0 = slow * k->slow[a][0], s1 = slow * k->slow[a][1] + k->slow[a][2];
    const float f0 = fast * k->fast[a][0], f1 = fast * k->fast[a][1] + k->fast[a][2];
    const float below = s0 > f0 ? s0 : f0, above = s1 < f1 ? s1 : f1;
    *from = *from > below ? *from : below;
    *to = *to < above ? *to : above;
}

/* Where the beam enters the node's eight boxes. Returns a bit for each that some ray may pass. */
STAGE static unsigned wide_beam_pass(const wide_node *restrict x, const wide_beam *restrict k, float *restrict enter)
{
    unsigned met = 0;
    for (int c = 0; c < WIDE_WIDTH; c++) {
        float from = 0, to = STEEP;
        bound(x->lo[0][c], x->hi[0][c], k, 0, &from, &to);
        bound(x->lo[1][c], x->hi[1][c], k, 1, &from, &to);
        bound(x->lo[2][c], x->hi[2][c], k, 2, &from, &to);
        to *= (float)(1 + 2 * WIDE_AIR);
        const float last = to < k->far ? to : k->far;
        enter[c] = from;
        met |= from <= last ? 1u << c : 0;
    }
    return met;
}

/* A bit for each ray of the beam that passes box c of the node. */
STAGE static unsigned wide_beam_rays(const wide_node *restrict x, int c, const wide_beam *restrict k)
{
    const float lx = x->lo[0][c], ly = x->lo[1][c], lz = x->lo[2][c];
    const float hx = x->hi[0][c], hy = x->hi[1][c], hz = x->hi[2][c];
    unsigned met = 0;
    for (int i = 0; i < WIDE_RAYS; i++) {
        const float ox = k->over[0][i], oy = k->over[1][i], oz = k->over[2][i];
        const float ax = (lx - k->low[0][i]) * ox, bx = (hx - k->high[0][i]) * ox;
        const float ay = (ly - k->low[1][i]) * oy, by = (hy - k->high[1][i]) * oy;
        const float az = (lz - k->low[2][i]) * oz, bz = (hz - k->high[2][i]) * oz;
        const float nx = ax < bx ? ax : bx, fx = ax > bx ? ax : bx;
        const float ny = ay < by ? ay : by, fy = ay > by ? ay : by;
        const float nz = az < bz ? az : bz, fz = az > bz ? az : bz;
        const float nxy = nx > ny ? nx : ny, fxy = fx < fy ? fx : fy;
        const float in = nxy > nz ? nxy : nz, out = fxy < fz ? fxy : fz;
        const float from = in > 0 ? in : 0, to = out * (float)(1 + WIDE_AIR), last = to < k->end[i] ? to : k->end[i];
        met |= from <= last ? 1u << i : 0;
    }
    return met;
}

/* As for one ray. */
static void push_beam(const wide_bvh *w, int32_t at_node, wide_beam *k)
{
    const wide_node *x = &w->node[at_node];
    float enter[WIDE_WIDTH];
    const int bottom = k->top;
    for (unsigned met = wide_beam_pass(x, k, enter) & x->present; met; met &= met - 1) {
        const int c = lowest_bit(met);
        place_in_order(k->enter, k->left, bottom, k->top++, enter[c],
                       x->child[c] < 0 ? ~(WIDE_WIDTH * at_node + c) : x->child[c]);
    }
}

int32_t wide_beam_next(const wide_bvh *w, wide_beam *k, unsigned *rays)
{
    while (k->top > 0) {
        const int at = --k->top;
        const int32_t x = k->left[at];
        if (k->enter[at] > k->far)
            continue;
        if (--k->work < 0)
            return -1;
        if (x >= 0) {
            push_beam(w, x, k);
            continue;
        }
        const wide_node *of = &w->node[~x / WIDE_WIDTH];
        *rays = wide_beam_rays(of, ~x % WIDE_WIDTH, k);
        if (*rays)
            return ~of->child[~x % WIDE_WIDTH];
    }
    return -1;
}
