/* Cone and cylinder about an axis, open or with caps. The side is Q(u,w) = F + rho (cos u X + sin u Z) + y Y, with w
 * the way down it from its upper end: rho = r_to + w sin a, y = length - w cos a, a the angle between side and axis.
 *
 * A cylinder is the cone with a = 0. Part 0 is the side, 1 the cap on top, 2 the one at the bottom; the caps are discs.
 */
#include "geometry/cone.h"

#include "base/frame.h"
#include "geometry/closed_form.h"

#include <stdio.h>
#include <stdlib.h>

/* Two intervals of t: within the infinite cone, from `in` to `out`, and between the planes of the ends. An interval
 * whose ends are in the wrong order is empty. */
typedef struct spans {
    real in, out, from, to;
} spans;

/* For the cone whose radius is rho at the lower end of the axis, with ends at the heights lo and hi.
 * t is measured from the point of the ray that is closest to the middle of the cone, so that a distant origin costs no
 * precision. The discriminant b^2 - a c of a t^2 + 2 b t + c is a difference of two squares, which cancels only at a
 * tangent. Where it is below 0 its root is NaN, and so are the results, for which every comparison is false. (Choices
 * by more than one comparison would keep gcc 12 from vectorising the loops.) */
KM_INLINE spans cone_spans(const cone *f, real rho, real lo, real hi, cone_ray l)
{
    real s2 = l.sx * l.sx + l.sy * l.sy + l.sz * l.sz;
    real tc = -(l.ox * l.sx + (l.oy - R(0.5) * f->length) * l.sy + l.oz * l.sz) / s2;
    real ox = l.ox + tc * l.sx, oy = l.oy + tc * l.sy, oz = l.oz + tc * l.sz;
    real grow = f->rise * l.sy, r = rho + f->rise * oy;
    real a = l.sx * l.sx + l.sz * l.sz - grow * grow, b = ox * l.sx + oz * l.sz - grow * r,
         c = ox * ox + oz * oz - r * r;
    real vx = r * l.sx - grow * ox, vz = r * l.sz - grow * oz, cross = ox * l.sz - oz * l.sx;
    real d = vx * vx + vz * vz - cross * cross;
    /* a < 0: steeper than the side, the ray is in both halves of the double cone and in this one towards where it
     * widens; its d is below 0 by rounding alone */
    real h = real_sqrt(a < 0 ? real_abs(d) : d);
    real q = b > 0 ? -b - h : h - b;
    real t0 = q / a,
         t1 = c / q; /* a = 0, a ray along the side: t0 is infinite; q = 0: t1 is NaN where t0 is the root */
    real low = real_min(t1, t0), high = real_max(t1, t0);
    real steep_in = grow > 0 ? high : -REAL_FAR, steep_out = grow > 0 ? REAL_FAR : low;
    real in = a < 0 ? steep_in : low, out = a < 0 ? steep_out : high;
    /* a = b = 0: along the axis of a cylinder all is inside, or nothing */
    real axial = c > 0 ? REAL_FAR : -REAL_FAR, slant = real_abs(a) + real_abs(b);
    in = slant == 0 ? axial : in;
    out = slant == 0 ? -axial : out;
    /* along the plane of an end, 0 * inf counts as inside or outside, as in box.c */
    real y0 = (lo - oy) / l.sy, y1 = (hi - oy) / l.sy;
    spans k = {tc + in, tc + out, tc + real_min(y0, y1), tc + real_max(y0, y1)};
    return k;
}

KM_INLINE spans spans_of(const cone *f, cone_ray l) { return cone_spans(f, f->from, 0, f->length, l); }

/* The ray may meet the surface at t0 <= t1: whether it does at the first, and at the second. */
typedef struct places {
    real t0, t1;
    int first, second;
} places;

KM_INLINE places cone_places(const cone *f, int capped, cone_ray l)
{
    spans k = spans_of(f, l);
    places p = {k.in, k.out, (k.in >= k.from) & (k.in <= k.to), (k.out >= k.from) & (k.out <= k.to)};
    if (capped) { /* a convex solid */
        p.t0 = real_max(k.from, k.in);
        p.t1 = real_min(k.to, k.out);
        p.first = p.second = p.t0 <= p.t1;
    }
    return p;
}

KM_INLINE void hit(const surface *base, int capped, int n, const rays *x, int32_t id, hits *h)
{
    const cone f = *(const cone *)base;
    for (int i = 0; i < n; i++) {
        places p = cone_places(&f, capped, cone_local_of(&f, x, i));
        int first = p.first & (p.t0 > 0), second = p.second & (p.t1 > 0);
        real t = first ? p.t0 : p.t1;
        int take = (first | second) & (t < h->t[i]);
        hits_take(h, i, take, t, id);
    }
}

/* For a ray from the side one root is 0, the other -2 b/a. An open side is met there if that is between its ends. */
KM_INLINE real cone_open_far(const cone *f, cone_ray l, int *met)
{
    real grow = f->rise * l.sy, r = f->from + f->rise * l.oy;
    real a = l.sx * l.sx + l.sz * l.sz - grow * grow, b = l.ox * l.sx + l.oz * l.sz - grow * r;
    real t = -2 * b / a, y = l.oy + t * l.sy;
    *met = (t > 0) & (y >= 0) & (y <= f->length);
    return t;
}

/* A ray from a capped cone enters the solid at its start or not at all. Inside, it leaves through the first of the
 * other parts; from the side to the side through the other root. */
KM_INLINE real cone_capped_far(const cone *f, cone_ray l, int part, int *met)
{
    real grow = f->rise * l.sy, r = f->from + f->rise * l.oy;
    real a = l.sx * l.sx + l.sz * l.sz - grow * grow, b = l.ox * l.sx + l.oz * l.sz - grow * r;
    real across = a > 0 ? -2 * b / a : REAL_FAR; /* a <= 0: it widens as the ray goes on */
    spans k = spans_of(f, l);
    real end = (l.sy > 0 ? f->length - l.oy : l.oy) / real_abs(l.sy); /* the cap ahead */
    real away = part == 0 ? b : part == 1 ? l.sy : -l.sy;
    real out = real_min(end, part == 0 ? across : k.out);
    *met = (away < 0) & (out > 0);
    return out;
}

KM_INLINE void hit_own(const surface *base, int capped, int n, const rays *x, const ray_origins *from, int32_t id,
                       hits *h)
{
    const cone f = *(const cone *)base;
    for (int i = 0; i < n; i++) {
        places p = cone_places(&f, capped, cone_local_of(&f, x, i));
        cone_ray l = cone_local_from(&f, &from->at, &x->s, i);
        int first = p.first & (p.t0 > 0), second = p.second & (p.t1 > 0), again, own = from->id[i] == id;
        real far = capped ? cone_capped_far(&f, l, from->part[i], &again) : cone_open_far(&f, l, &again);
        real near = first ? p.t0 : p.t1, t = own ? far : near;
        int met = (own & again) | ((1 - own) & (first | second)), take = met & (t < h->t[i]);
        hits_take(h, i, take, t, id);
    }
}

KM_INLINE void occlude(const surface *base, int capped, int n, const rays *x, real *lit)
{
    const cone f = *(const cone *)base;
    for (int i = 0; i < n; i++) {
        places p = cone_places(&f, capped, cone_local_of(&f, x, i));
        int met = (p.first & (p.t0 > 0) & (p.t0 < 1)) | (p.second & (p.t1 > 0) & (p.t1 < 1));
        lit[i] = met ? 0 : lit[i];
    }
}

/* The three stages of an open or a capped cone. */
#define CONE_STAGES(form, capped)                                                                                      \
    STAGE static void cone_##form##_hit(const surface *f, int n, const rays *x, int32_t id, hits *h)                   \
    {                                                                                                                  \
        hit(f, capped, n, x, id, h);                                                                                   \
    }                                                                                                                  \
    STAGE static void cone_##form##_hit_own(const surface *f, int n, const rays *x, const ray_origins *from,           \
                                            int32_t id, hits *h)                                                       \
    {                                                                                                                  \
        hit_own(f, capped, n, x, from, id, h);                                                                         \
    }                                                                                                                  \
    STAGE static void cone_##form##_occlude(const surface *f, int n, const rays *x, real *lit)                         \
    {                                                                                                                  \
        occlude(f, capped, n, x, lit);                                                                                 \
    }

CONE_STAGES(open, 0)
CONE_STAGES(capped, 1)

STAGE static void cone_open_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit)
{
    const cone f = *(const cone *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        int met;
        real t = cone_open_far(&f, cone_local_of(&f, x, i), &met);
        lit[i] = (met & (t < 1)) ? 0 : lit[i];
    }
}

STAGE static void cone_capped_occlude_own(const surface *base, int n, const rays *x, const int32_t *restrict part,
                                          real *restrict lit)
{
    const cone f = *(const cone *)base;
    for (int i = 0; i < n; i++) {
        int met;
        real t = cone_capped_far(&f, cone_local_of(&f, x, i), part[i], &met);
        lit[i] = (met & (t < 1)) ? 0 : lit[i];
    }
}

/* ---- for true displacement: side and caps each by itself ---- */

/* Q + P n/|n| on the side is on the cone whose radius is larger by P/cos a, from w = 0 to its side's end. Seen along
 * the axis that is from lo to hi. */
STAGE static void cone_side_bound(const cone *restrict base, int n, const rays *restrict x, const real *restrict end,
                                  real Pmin, real Pmax, real *restrict t0, real *restrict t1)
{
    const cone f = *base;
    const real lo = real_min(Pmin * f.sin, Pmax * f.sin), hi = f.length + real_max(Pmin * f.sin, Pmax * f.sin);
    const real outer = f.from + Pmax / f.cos, inner = f.from + Pmin / f.cos;
    const int exact = f.sin == 0;
    for (int i = 0; i < n; i++) {
        cone_ray l = cone_local_of(&f, x, i);
        spans k = cone_spans(&f, outer, lo, hi, l), core = cone_spans(&f, inner, lo, hi, l);
        real in = real_max(k.from, k.in), out = real_min(k.to, k.out), from = real_max(in, 0);
        /* Within the core the gap is below 0, so that a ray that has come in through the outer cone has met the
         * displaced side before it, unless its closest point was beyond an end. */
        int crossed = exact & (inner > 0) & (core.in <= core.out) & (core.in > from) & (from == k.in);
        out = crossed ? real_min(core.in, out) : out;
        t0[i] = from;
        t1[i] = in <= out ? real_min(out, end[i]) : R(-1);
    }
}

static void cone_bound(const surface *base, int part, int n, const rays *x, const real *end, real Pmin, real Pmax,
                       real *t0, real *t1)
{
    if (part == 0)
        cone_side_bound((const cone *)base, n, x, end, Pmin, Pmax, t0, t1);
    else
        cone_cap(base, part)->ops->bound(cone_cap(base, part), 0, n, x, end, Pmin, Pmax, t0, t1);
}

STAGE static void cone_side_closest(const cone *restrict base, int n, const rays *restrict x, const real *restrict t,
                                    closest_points *restrict p)
{
    const cone f = *base;
    for (int i = 0; i < n; i++) {
        cone_ray l = cone_local_of(&f, x, i);
        real px = l.ox + l.sx * t[i], py = l.oy + l.sy * t[i], pz = l.oz + l.sz * t[i];
        real d2 = px * px + pz * pz, d = real_sqrt(d2);
        real id2 = 1 / real_max(d2, R(1e-30)), id = 1 / real_max(d, R(1e-15)), ex = px * id, ez = pz * id;
        p->u[i] = (real)km_atan2((double)pz, (double)px);
        p->w[i] = (d - f.to) * f.sin + (f.length - py) * f.cos;
        p->h[i] = (d - f.to) * f.cos - (f.length - py) * f.sin;
        cone_vector(&f, &p->gu, i, -pz * id2, 0, px * id2);
        cone_vector(&f, &p->gw, i, ex * f.sin, -f.cos, ez * f.sin);
        cone_vector(&f, &p->gh, i, ex * f.cos, f.sin, ez * f.cos);
    }
}

static void cone_closest(const surface *base, int part, int n, const rays *x, const real *t, closest_points *p)
{
    if (part == 0)
        cone_side_closest((const cone *)base, n, x, t, p);
    else
        cone_cap(base, part)->ops->closest(cone_cap(base, part), 0, n, x, t, p);
}

/* w and the height are linear in the distance d to the axis and the way along it. Along a unit vector |d''| <= 1/d,
 * which is |grad u|. */
STAGE static void cone_side_bend(int n, const rays *restrict x, const closest_points *restrict p,
                                 path_bends *restrict out)
{
    for (int i = 0; i < n; i++) {
        real sx = x->s.x[i], sy = x->s.y[i], sz = x->s.z[i], s = real_sqrt(sx * sx + sy * sy + sz * sz);
        real gu = s * real_sqrt(p->gu.x[i] * p->gu.x[i] + p->gu.y[i] * p->gu.y[i] + p->gu.z[i] * p->gu.z[i]);
        real gw = s * real_sqrt(p->gw.x[i] * p->gw.x[i] + p->gw.y[i] * p->gw.y[i] + p->gw.z[i] * p->gw.z[i]);
        real u = R(BEND_MORE) * gu;
        out->u[i] = u * u;
        out->w[i] = u * gw;
        out->h[i] = u * s;
        out->reach[i] = R(BEND_REACH) / gu;
    }
}

static void cone_bend(const surface *base, int part, int n, const rays *x, const closest_points *p, path_bends *out)
{
    if (part == 0)
        cone_side_bend(n, x, p, out);
    else
        bend_flat(base, part, n, x, p, out);
}

/* The methods of a cone or a cylinder, open or capped. */
#define CONE_METHODS(name, is_cone, form, number)                                                                      \
    {                                                                                                                  \
        .kind = name, .hit = cone_##form##_hit, .hit_own = cone_##form##_hit_own, .locate = cone_locate,               \
        .foot = cone_foot, .eval = cone_eval, .occlude = cone_##form##_occlude,                                        \
        .occlude_own = cone_##form##_occlude_own, .extent = cone_extent, .box = cone_box, .parts = number,             \
        .bound = cone_bound, .closest = cone_closest, .bend = cone_bend, .around = AROUND_U, .unclamped = is_cone      \
    }

static const surface_ops cone_methods[2][2] = {
    {CONE_METHODS("cylinder", false, open, 1), CONE_METHODS("cylinder", false, capped, 3)},
    {CONE_METHODS("cone", true, open, 1), CONE_METHODS("cone", true, capped, 3)},
};

surface *cone_new(vec3 from, double from_radius, vec3 to, double to_radius, bool open)
{
    const vec3 axis = vec3_sub(to, from);
    const double length = vec3_length(axis), slope = from_radius - to_radius,
                 side = sqrt(length * length + slope * slope);
    const bool good =
        length > 0 && from_radius >= 0 && to_radius >= 0 && from_radius + to_radius > 0 && side < HUGE_VAL;
    cone *f = good ? calloc(1, sizeof *f) : NULL;
    if (!f)
        return NULL;
    const frame a = frame_about(axis);
    f->base.ops = &cone_methods[from_radius != to_radius][!open];
    vec3_round(f->F, from);
    vec3_round(f->X, a.x);
    vec3_round(f->Y, a.y);
    vec3_round(f->Z, a.z);
    f->from = (real)from_radius;
    f->to = (real)to_radius;
    f->length = (real)length;
    f->rise = (real)((to_radius - from_radius) / length);
    f->side = (real)side;
    f->sin = (real)((from_radius - to_radius) / side);
    f->cos = (real)(length / side);
    f->capped = !open;
    disc_set(&f->cap[0], to, a.x, vec3_scale(a.z, -1), to_radius);
    disc_set(&f->cap[1], from, a.x, a.z, from_radius);
    return &f->base;
}

/* ---- in the scene file ---- */

static const form_parameter cylinder_parameters[] = {
    {"from", FORM_PLACE, 0, "the middle of one end [x, y, z]"},
    {"to", FORM_PLACE, 1, "the middle of the other end [x, y, z]"},
    {"radius", FORM_POSITIVE, 0, NULL},
    {"open", FORM_OPEN, 0, NULL},
    {0},
};

static const form_parameter cone_parameters[] = {
    {"from", FORM_PLACE, 0, "the middle of one end [x, y, z]"},
    {"from_radius", FORM_LENGTH, 0, NULL},
    {"to", FORM_PLACE, 1, "the middle of the other end [x, y, z]"},
    {"to_radius", FORM_LENGTH, 1, NULL},
    {"open", FORM_OPEN, 0, NULL},
    {0},
};

static bool has_length(const shape_values *v) { return vec3_length(vec3_sub(v->v[1], v->v[0])) >= SHAPE_SMALL; }

static surface *make_cylinder(const shape_values *v, form_fault *fault)
{
    if (has_length(v))
        return cone_new(v->v[0], v->r[0], v->v[1], v->r[0], v->open);
    *fault = (form_fault){"to", "a cylinder without length, expected 'to' apart from 'from'"};
    return NULL;
}

static surface *make_cone(const shape_values *v, form_fault *fault)
{
    if (!has_length(v))
        *fault = (form_fault){"to", "a cone without length, expected 'to' apart from 'from'"};
    else if (v->r[0] < SHAPE_SMALL && v->r[1] < SHAPE_SMALL)
        *fault = (form_fault){NULL, "a cone without thickness, expected a radius of 1e-6 or more at one end"};
    else
        return cone_new(v->v[0], v->r[0], v->v[1], v->r[1], v->open);
    return NULL;
}

/* The side has no flat part; part 1 is the cap at `to`, where the axis is n. */
static bool flat_cap(const shape_values *v, int part, double to_radius, flat_part *out)
{
    const frame a = frame_about(vec3_sub(v->v[1], v->v[0]));
    if (part == 1)
        *out = (flat_part){v->v[1], a.x, vec3_scale(a.z, -1), to_radius};
    else
        *out = (flat_part){v->v[0], a.x, a.z, v->r[0]};
    return part > 0;
}

static bool cylinder_flat(const shape_values *v, int part, flat_part *out) { return flat_cap(v, part, v->r[0], out); }
static bool cone_flat(const shape_values *v, int part, flat_part *out) { return flat_cap(v, part, v->r[1], out); }

static bool side_formula(const shape_values *v, double to_radius, form_formula *out)
{
    const vec3 axis = vec3_sub(v->v[1], v->v[0]);
    const double length = vec3_length(axis), slope = v->r[0] - to_radius, side = sqrt(length * length + slope * slope);
    char rho[64], y[64];
    snprintf(rho, sizeof rho, "%.17g + %.17g*w", to_radius, slope / side);
    snprintf(y, sizeof y, "%.17g - %.17g*w", 0.5 * length, length / side);
    out->u[0] = -KM_PI;
    out->u[1] = KM_PI;
    out->w[0] = 0;
    out->w[1] = side;
    formula_revolve(out, frame_about(axis), rho, y);
    return v->open;
}

static bool cylinder_formula(const shape_values *v, form_formula *out) { return side_formula(v, v->r[0], out); }
static bool cone_formula(const shape_values *v, form_formula *out) { return side_formula(v, v->r[1], out); }

const closed_form form_cylinder = {
    .name = "cylinder",
    .parameters = cylinder_parameters,
    .make = make_cylinder,
    .flat = cylinder_flat,
    .formula = cylinder_formula,
    .solid = true,
    .povray = "cylinder {\n  $from, $to, $radius$open\n",
};

const closed_form form_cone = {
    .name = "cone",
    .parameters = cone_parameters,
    .make = make_cone,
    .flat = cone_flat,
    .formula = cone_formula,
    .solid = true,
    .povray = "cone {\n  $from, $from_radius, $to, $to_radius$open\n",
};
