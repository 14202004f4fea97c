/* Prisms over triangles. N is the linear mean of the corners' normals, made a unit vector. */
#include "displaced/prism.h"

#include <math.h>

enum { STEPS = 4 }; /* of Newton's iteration: normals mostly turn by far less than a right angle over a triangle */

#define CONVERGED 1e-16 /* squared distance over the triangle's area: the step before was off by 1e-8 of its size */
#define STEEPEST 1e-6   /* least volume of the prism over its area, where normals meet: bounds gradients */

/* The mean of the normals, and by how much N may differ from what lies in a straight line between them. */
static vec3 mean_normal(const mesh_triangle *x, double *bulge)
{
    const vec3 n = vec3_unit(vec3_add(x->normal[0], vec3_add(x->normal[1], x->normal[2])));
    const double least = fmin(vec3_dot(n, x->normal[0]), fmin(vec3_dot(n, x->normal[1]), vec3_dot(n, x->normal[2])));
    *bulge = 1 - fmax(least, 0);
    return n;
}

void prism_box(const mesh_triangle *x, double lo, double hi, double box[2][3])
{
    double bulge;
    mean_normal(x, &bulge);
    const double more = bulge * fmax(fabs(lo), fabs(hi));
    for (int a = 0; a < 3; a++) {
        box[0][a] = HUGE_VAL;
        box[1][a] = -HUGE_VAL;
        for (int k = 0; k < 6; k++) {
            const vec3 p = vec3_add(x->at[k % 3], vec3_scale(x->normal[k % 3], k < 3 ? lo : hi));
            const double c = a == 0 ? p.x : a == 1 ? p.y : p.z;
            box[0][a] = fmin(box[0][a], c - more);
            box[1][a] = fmax(box[1][a], c + more);
        }
    }
}

/* Narrow t0..t1 to where a + b t is in lo..hi. */
static void narrow(double a, double b, double lo, double hi, double *t0, double *t1)
{
    const double x = (lo - a) / b, y = (hi - a) / b;
    if (b == 0) {
        *t1 = a < lo || a > hi ? -HUGE_VAL : *t1;
        return;
    }
    *t0 = fmax(*t0, fmin(x, y));
    *t1 = fmin(*t1, fmax(x, y));
}

/* A slab across the mean normal, and for each side of the triangle a plane, moved out as far as the normals there lean.
 */
bool prism_stretch(const mesh_triangle *x, double air, vec3 r, vec3 s, double lo, double hi, double *from, double *to)
{
    double bulge, low = HUGE_VAL, high = -HUGE_VAL;
    const vec3 n = mean_normal(x, &bulge);
    const double most = fmax(fabs(lo), fabs(hi)), more = bulge * most + air;
    for (int k = 0; k < 3; k++) {
        const double at = vec3_dot(n, vec3_sub(x->at[k], x->at[0])), up = vec3_dot(n, x->normal[k]);
        low = fmin(low, at + fmin(lo * up, hi * up));
        high = fmax(high, at + fmax(lo * up, hi * up));
    }
    narrow(vec3_dot(n, vec3_sub(r, x->at[0])), vec3_dot(n, s), low - more, high + more, from, to);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3;
        const vec3 side = vec3_sub(x->at[l], x->at[k]), out = vec3_unit(vec3_cross(side, n));
        const double lean = most * fmax(fabs(vec3_dot(out, x->normal[k])), fabs(vec3_dot(out, x->normal[l])));
        const double wide = PRISM_OVERLAP * vec3_length(side);
        narrow(vec3_dot(out, vec3_sub(r, x->at[k])), vec3_dot(out, s), -HUGE_VAL, lean + more + wide, from, to);
    }
    return *from <= *to;
}

prism_point prism_at(const mesh_triangle *x, double b, double c, double h)
{
    const vec3 M = mesh_mix(x->normal, b, c), Mb = vec3_sub(x->normal[1], x->normal[0]),
               Mc = vec3_sub(x->normal[2], x->normal[0]);
    const double length = vec3_length(M), k = h / length;
    prism_point p;
    p.N = vec3_scale(M, 1 / length);
    p.Xb = vec3_add(vec3_sub(x->at[1], x->at[0]), vec3_scale(vec3_sub(Mb, vec3_scale(p.N, vec3_dot(Mb, p.N))), k));
    p.Xc = vec3_add(vec3_sub(x->at[2], x->at[0]), vec3_scale(vec3_sub(Mc, vec3_scale(p.N, vec3_dot(Mc, p.N))), k));
    p.place = vec3_add(mesh_mix(x->at, b, c), vec3_scale(p.N, h));
    return p;
}

void prism_gradients(const mesh_triangle *x, const prism_point *p, double det, vec3 *gu, vec3 *gw)
{
    const vec3 gb = vec3_scale(vec3_cross(p->Xc, p->N), 1 / det), gc = vec3_scale(vec3_cross(p->N, p->Xb), 1 / det);
    *gu = vec3_add(vec3_scale(gb, x->u[1] - x->u[0]), vec3_scale(gc, x->u[2] - x->u[0]));
    *gw = vec3_add(vec3_scale(gb, x->w[1] - x->w[0]), vec3_scale(gc, x->w[2] - x->w[0]));
}

/* Not farther beyond a triangle than it is wide: what lies there is another's. */
static double near_triangle(double b) { return b < -1 ? -1 : b > 2 ? 2 : b; }

void prism_closest(const mesh_triangle *x, vec3 at, closest_points *out, int lane)
{
    const vec3 n = vec3_cross(vec3_sub(x->at[1], x->at[0]), vec3_sub(x->at[2], x->at[0]));
    double b = 1.0 / 3, c = 1.0 / 3, h = vec3_dot(vec3_sub(at, x->at[0]), n) / vec3_length(n);
    double off = HUGE_VAL, area = vec3_length(n);
    for (int step = 0; step < STEPS && off > CONVERGED * area; step++) {
        const prism_point p = prism_at(x, b, c, h);
        const vec3 d = vec3_sub(at, p.place), up = vec3_cross(p.Xb, p.Xc);
        const double det = vec3_dot(up, p.N), k = det > 0 ? 1 / det : 0; /* beyond where normals meet: stay */
        b = near_triangle(b + k * vec3_dot(d, vec3_cross(p.Xc, p.N)));
        c = near_triangle(c + k * vec3_dot(d, vec3_cross(p.N, p.Xb)));
        h += k * vec3_dot(d, up);
        off = vec3_dot(d, d);
    }
    const prism_point p = prism_at(x, b, c, h);
    const vec3 up = vec3_cross(p.Xb, p.Xc);
    const double det = fmax(vec3_dot(up, p.N), STEEPEST * area);
    vec3 gu, gw;
    prism_gradients(x, &p, det, &gu, &gw);
    out->u[lane] = (real)(x->u[0] + b * (x->u[1] - x->u[0]) + c * (x->u[2] - x->u[0]));
    out->w[lane] = (real)(x->w[0] + b * (x->w[1] - x->w[0]) + c * (x->w[2] - x->w[0]));
    out->h[lane] = (real)h;
    vec3s_set(&out->gu, lane, gu);
    vec3s_set(&out->gw, lane, gw);
    vec3s_set(&out->gh, lane, vec3_scale(up, 1 / det));
}
