/* Bounds over windows. A window is free of hits up to where one of three bounds of the gap becomes 0:
 *   - the height against the range of P over the window's rectangle of (u,w), as in Tevs, Ihrke and Seidel 2008 and
 *     Thonat et al. 2023;
 *   - its value and the range of its slope, by the range of P's slopes there [Kalra and Barr 1989];
 *   - its value, slope and the bounds of its second derivative, where P has some.
 * Where its slope has one sign the window has one hit at most, so that its end shows whether there is one.
 */
#include "displaced/window.h"

#include "wave/lane.h"

static inline real size_of(const vec3s *v, int i) { return real_abs(v->x[i]) + real_abs(v->y[i]) + real_abs(v->z[i]); }

/* The ways of u and w, with the roundings of places on the ray. */
STAGE static void rectangles_over(const paths *restrict k, const path_bends *restrict b, const real *restrict tolerance,
                                  windows *restrict out, rectangles *restrict r)
{
    const int n = k->n;
    for (int i = 0; i < n; i++) {
        const real d = real_min(out->size[i], b->reach[i]), half = R(0.5) * d * d;
        const real u = k->p.u[i], w = k->p.w[i], du = k->du[i] * d, dw = k->dw[i] * d;
        const real au = b->u[i] * half + size_of(&k->p.gu, i) * tolerance[i],
                   aw = b->w[i] * half + size_of(&k->p.gw, i) * tolerance[i];
        out->size[i] = d;
        r->u0[i] = u + real_min(du, 0) - au;
        r->u1[i] = u + real_max(du, 0) + au;
        r->w0[i] = w + real_min(dw, 0) - aw;
        r->w1[i] = w + real_max(dw, 0) + aw;
    }
}

/* Bounds of P's second partials, finite as 0 times infinity is NaN. */
typedef struct bends {
    real uu, uw, ww;
} bends;

static bends bends_of(const domain *f, const bump *P)
{
    const bends none = {REAL_FAR, REAL_FAR, REAL_FAR};
    if (f->unclamped) /* P does not change with (u,w) beyond the piece */
        return none;
    return (bends){real_min(P->Puu_max, REAL_FAR), real_min(P->Puw_max, REAL_FAR), real_min(P->Pww_max, REAL_FAR)};
}

/* Comparisons are false and steps 0 where a bound is NaN: real_max(x, y) is y then. */
STAGE static void clear(const paths *restrict k, const bends *restrict P2, const path_bends *restrict b,
                        const bump_ranges *restrict P, const real *restrict side, const real *restrict tolerance,
                        windows *restrict out)
{
    const int n = k->n;
    const real uu = P2->uu, uw = P2->uw, ww = P2->ww;
    for (int i = 0; i < n; i++) {
        const real d = out->size[i], s = side[i], above = s * k->gap[i], h = s * k->dh[i], g = s * k->slope[i];
        const real bu = b->u[i] * d, bw = b->w[i] * d, bh = b->h[i] * d;
        const real U = real_abs(k->du[i]) + bu, W = real_abs(k->dw[i]) + bw;
        /* the slope's bounds, by P's slopes and by its bends */
        const real air = bh + P->Pu[i] * bu + P->Pw[i] * bw, du = k->du[i], dw = k->dw[i];
        const real u0 = du * P->Pu_lo[i], u1 = du * P->Pu_hi[i], w0 = dw * P->Pw_lo[i], w1 = dw * P->Pw_hi[i];
        const real low = real_min(u0, u1) + real_min(w0, w1), high = real_max(u0, u1) + real_max(w0, w1);
        const real turn = air + (uu * U * U + 2 * uw * U * W + ww * W * W) * d;
        const real least = real_max(g - turn, h - air - (s > 0 ? high : -low));
        const real most = real_min(g + turn, h + air - (s > 0 ? low : -high));
        const real by_slope = above / -least;
        /* above + g x - turn/d x^2/2 = 0; the root without cancellation */
        const real c = turn / d, root = real_sqrt(g * g + 2 * c * above),
                   by_bend = g > 0 ? (g + root) / c : 2 * above / (root - g);
        /* the height, against P over the window */
        const real room = (s > 0 ? k->p.h[i] - P->hi[i] : P->lo[i] - k->p.h[i]) - tolerance[i];
        const real fall = h - R(0.5) * bh, by_height = fall < 0 ? room / -fall : d;
        const real free_height = room > 0 ? by_height : 0;
        const real step = real_max(real_max(by_bend, by_slope), free_height);
        const int one = most < 0, all = (least > 0) | one;
        out->step[i] = all ? d : real_min(real_max(step, 0), d);
        out->one[i] = one;
    }
}

void windows_clear(const domain *f, const bump *P, const paths *k, const real *side, const real *tolerance,
                   windows *out)
{
    const bends second = bends_of(f, P);
    path_bends b;
    rectangles r;
    bump_ranges range;
    f->bend(f, k->n, k->lane, &k->x, &k->p, &b);
    rectangles_over(k, &b, tolerance, out, &r);
    f->places(f, k->n, k->lane, &r);
    P->ops->range(P, k->n, r.u0, r.u1, r.w0, r.w1, &range);
    clear(k, &second, &b, &range, side, tolerance, out);
}
