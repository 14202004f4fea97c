/* Pieces of a patch: their bounds, the subdivision of a whole patch, and a ray against a piece. */
#include "patch/piece.h"

#include "base/gate.h"

#include <math.h>
#include <stdlib.h>

/* How far a patch is subdivided before rendering: these numbers trade time before rendering and memory against time for
 * each ray, and decide nothing else. */
enum {
    FEWEST = 64, /* pieces, of any patch: below that the bounding sphere is still too wide to judge sizes by */
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION /* as all fuzzers define it: instrumented code is many times slower */
    MOST = 1 << 12,
#else
    MOST = 1 << 16, /* no round of halving begins beyond this; one round at most doubles the number */
#endif
    SHOWN = 256, /* progress is shown after so many halvings */
};
#define LARGEST (1 / 20.)   /* larger pieces, in radii of the patch's sphere, are halved however flat they are */
#define SMALLEST (1 / 300.) /* smaller ones are not halved however bent they are */

#define ROUNDING 1e-12 /* more than the roundings in e, as a share of the piece's place and size */
#define POINT 1e-10 /* a patch this small, as a share of its distance from the origin, is a point and its roundings */

static double length3(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

piece piece_of(const patch *q, int32_t part, const double u[2], const double w[2])
{
    const double hu = 0.5 * (u[1] - u[0]), hw = 0.5 * (w[1] - w[0]), mu = u[0] + hu, mw = w[0] + hw;
    piece f = {.part = part, .u = {u[0], u[1]}, .w = {w[0], w[1]}};
    patch_bounds b;
    patch_jets q0;
    double A[3], B[3], ra[3], rb[3], c[3], far[3];
    q->ops->bound(q, part, u, w, &b, NULL);
    q->ops->eval(q, 1, &part, &mu, &mw, 0, &q0);
    for (int k = 0; k < 3; k++) {
        const expr_bounds *z = &b.axis[k];
        const bool known = z->u[1] - z->u[0] < HUGE_VAL && z->w[1] - z->w[0] < HUGE_VAL;
        c[k] = q0.axis[k].v[0];
        A[k] = known ? 0.5 * hu * (z->u[0] + z->u[1]) : 0;
        B[k] = known ? 0.5 * hw * (z->w[0] + z->w[1]) : 0;
        ra[k] = known ? 0.5 * hu * (z->u[1] - z->u[0]) : HUGE_VAL;
        rb[k] = known ? 0.5 * hw * (z->w[1] - z->w[0]) : HUGE_VAL;
        const double out = fabs(A[k]) + fabs(B[k]) + ra[k] + rb[k];
        f.box[0][k] = greater(z->v[0], c[k] - out);
        f.box[1][k] = lesser(z->v[1], c[k] + out);
        far[k] = greater(z->v[1] - c[k], c[k] - z->v[0]) + fabs(A[k]) + fabs(B[k]);
    }
    f.c = (vec3){c[0], c[1], c[2]};
    f.A = (vec3){A[0], A[1], A[2]};
    f.B = (vec3){B[0], B[1], B[2]};
    f.ea = length3(ra);
    f.eb = length3(rb);
    f.e = lesser(f.ea + f.eb, length3(far));
    f.e += ROUNDING * (vec3_length(f.c) + vec3_length(f.A) + vec3_length(f.B));
    return f;
}

piece piece_half(const patch *q, const piece *f, int which)
{
    const double lu = vec3_length(f->A) + f->ea, lw = vec3_length(f->B) + f->eb;
    const double share_u = (f->u[1] - f->u[0]) / (q->u[1] - q->u[0]),
                 share_w = (f->w[1] - f->w[0]) / (q->w[1] - q->w[0]);
    const bool known = lu < HUGE_VAL || lw < HUGE_VAL, along_u = known ? lu >= lw : share_u >= share_w;
    double u[2] = {f->u[0], f->u[1]}, w[2] = {f->w[0], f->w[1]};
    double *x = along_u ? u : w;
    const double middle = x[0] + 0.5 * (x[1] - x[0]);
    x[1 - which] = middle;
    return piece_of(q, f->part, u, w);
}

double piece_radius(const piece *f) { return vec3_length(f->A) + vec3_length(f->B) + f->e; }

/* ---- the whole patch ---- */

static void measure(pieces *l)
{
    for (int k = 0; k < 3; k++) {
        l->lo[k] = HUGE_VAL;
        l->hi[k] = -HUGE_VAL;
        for (int i = 0; i < l->n; i++) {
            l->lo[k] = lesser(l->lo[k], l->piece[i].box[0][k]);
            l->hi[k] = greater(l->hi[k], l->piece[i].box[1][k]);
        }
    }
    l->space = bvh_space_about(l->lo, l->hi);
}

static bool needs_halving(const pieces *l, double flat, const piece *f)
{
    const double size = piece_radius(f);
    if (l->n < FEWEST || !(size <= LARGEST * l->space.radius))
        return true;
    return size > SMALLEST * l->space.radius && (f->ea > flat * vec3_length(f->A) || f->eb > flat * vec3_length(f->B));
}

/* One round: each piece that needs it is halved. False: out of memory, or stopped. *any: whether one was. */
static bool halve(const patch *q, double flat, const progress *w, pieces *l, bool *any)
{
    const int n = l->n;
    gate g = {.to = w, .what = "building", .done = n, .all = 2 * MOST};
    memory *m = progress_memory(w);
    piece *more = memory_resize(m, l->piece, sizeof *more * (size_t)(2 * n));
    *any = false;
    if (!more)
        return false;
    l->piece = more;
    int32_t *parent = memory_new(m, sizeof *parent * (size_t)n); /* the pieces that are halved */
    if (!parent)
        return false;
    int halved = 0;
    for (int i = 0; i < n; i++)
        if (needs_halving(l, flat, &more[i]))
            parent[halved++] = i;
    const int threads = threads_of(q->threads);
    (void)threads; /* without OpenMP */
#pragma omp parallel for num_threads(threads) schedule(static) if (halved > FEWEST)
    for (int k = 0; k < halved; k++) {
        if (!gate_is_open(&g))
            continue;
        const piece whole = more[parent[k]];
        more[parent[k]] = piece_half(q, &whole, 0);
        more[n + k] = piece_half(q, &whole, 1);
        if (k % SHOWN == SHOWN - 1)
            gate_pass(&g, SHOWN);
    }
    memory_free(parent);
    l->n = n + halved;
    *any = halved > 0;
    return gate_is_open(&g);
}

static bool has_bounds(const pieces *l)
{
    for (int i = 0; i < l->n; i++)
        if (!(vec3_length(l->piece[i].c) < HUGE_VAL))
            return false;
    return l->space.radius > POINT * vec3_length(l->space.centre) && l->space.radius < HUGE_VAL;
}

bool pieces_of(const patch *q, double flat, const progress *w, pieces *l, bool *bounded)
{
    *l = (pieces){.piece = memory_new(progress_memory(w), sizeof *l->piece * (size_t)q->parts)};
    bool good = l->piece, any = true;
    for (int part = 0; good && part < q->parts; part++)
        l->piece[l->n++] = piece_of(q, part, q->u, q->w);
    while (good && any && l->n < MOST) {
        measure(l);
        good = halve(q, flat, w, l, &any);
    }
    if (good) {
        measure(l);
        good = *bounded = has_bounds(l);
    }
    return good;
}

void pieces_free(pieces *l)
{
    memory_free(l->piece);
    *l = (pieces){0};
}

/* ---- a ray ---- */

piece_answer piece_intersect(const piece *f, vec3 r, vec3 s, double lo, double hi, double *a, double *b)
{
    /* Q is on the parallelogram moved by some d, |d| <= e: c + a A + b B + d = r + s t, solved by Cramer's rule. */
    const vec3 o = vec3_sub(r, f->c), Bs = vec3_cross(f->B, s), sA = vec3_cross(s, f->A);
    const double det = vec3_dot(f->A, Bs), lBs = vec3_length(Bs), lsA = vec3_length(sA), s2 = vec3_dot(s, s);
    const double across = vec3_dot(o, Bs), down = vec3_dot(o, sA);
    if (fabs(across) > fabs(det) + f->e * lBs || fabs(down) > fabs(det) + f->e * lsA)
        return PIECE_MISSED;
    const double middle = -vec3_dot(o, s), reach = fabs(vec3_dot(f->A, s)) + fabs(vec3_dot(f->B, s)) + f->e * sqrt(s2);
    if (middle + reach < lo * s2 || middle - reach > hi * s2)
        return PIECE_MISSED;
    *a = *b = 0;
    if (!(fabs(det) > 2 * (f->ea * lBs + f->eb * lsA + f->ea * f->eb * sqrt(s2))))
        return PIECE_OPEN;
    *a = lesser(greater(across / det, -1), 1);
    *b = lesser(greater(down / det, -1), 1);
    return PIECE_ONCE;
}
