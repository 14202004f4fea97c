/* Surfaces with formulas. The ground has (u,w), Q and its partials; the caster only a normal. Both are convex, so
 * each is dark where it is turned away from the light, and needs no shadow test of itself.
 */
struct Partials {
    vec3 Q, Qu, Qw, Quu, Quw, Qww;
};

/* ---- sphere ---- */

/* Both roots, in order; false: none. From the foot of the perpendicular to the ray, which keeps digits. */
bool sphere_roots(vec3 centre, float radius, Ray x, out vec2 t)
{
    vec3 o = x.r - centre;
    float a = dot(x.s, x.s), tc = -dot(o, x.s) / a;
    vec3 foot = o + tc * x.s;
    float d = radius * radius - dot(foot, foot), h = sqrt(max(d, 0.0) / a);
    t = vec2(tc - h, tc + h);
    return d >= 0.0;
}

float sphere_hit(vec3 centre, float radius, Ray x)
{
    vec2 t;
    bool met = sphere_roots(centre, radius, x, t);
    float first = t.x > 0.0 ? t.x : t.y;
    return met && first > 0.0 ? first : FAR;
}

bool sphere_occludes(vec3 centre, float radius, Ray x)
{
    vec2 t;
    return sphere_roots(centre, radius, x, t) && ((t.x > 0.0 && t.x < 1.0) || (t.y > 0.0 && t.y < 1.0));
}

/* ---- the ground ---- */

#if GROUND == SPHERE

uniform vec3 ground_centre;
uniform float ground_radius;

float ground_hit(Ray x) { return sphere_hit(ground_centre, ground_radius, x); }
bool ground_occludes(Ray x) { return sphere_occludes(ground_centre, ground_radius, x); }

/* (u,w) of the closest point, and the height above it. */
vec3 ground_closest(vec3 x)
{
    vec3 p = x - ground_centre;
    return vec3(atan(p.z, p.x), atan(length(p.xz), p.y), length(p) - ground_radius);
}

/* Q = C + R (sin w cos u, cos w, sin w sin u) and its partials, at the point closest to x. */
Partials ground_partials(vec3 x)
{
    vec3 p = normalize(x - ground_centre) * ground_radius;
    float r = length(p.xz);
    vec2 e = p.xz / max(r, 1e-20); /* cos u, sin u */
    float rim = max(r, 1e-12 * ground_radius); /* at a pole this keeps the direction of n */
    return Partials(ground_centre + p, rim * vec3(-e.y, 0, e.x), vec3(p.y * e.x, -r, p.y * e.y),
                    vec3(-p.x, 0, -p.z), p.y * vec3(-e.y, 0, e.x), -p);
}

float way_to_edges(vec2 uw, vec2 d) { return FAR; }

#else

/* Q = O + u U + w W; D: the dual basis; N: the unit normal. */
uniform vec3 ground_O, ground_U, ground_W, ground_Du, ground_Dw, ground_N;

vec3 ground_closest(vec3 x)
{
    vec3 p = x - ground_O;
    return vec3(dot(p, ground_Du), dot(p, ground_Dw), dot(p, ground_N));
}

bool ground_has(vec2 uw)
{
    return GROUND == PLANE || (uw.x >= 0.0 && uw.x <= 1.0 && uw.y >= 0.0 && uw.y <= 1.0);
}

float ground_hit(Ray x)
{
    float t = dot(ground_O - x.r, ground_N) / dot(x.s, ground_N);
    return t > 0.0 && t < FAR && ground_has(ground_closest(along(x, t)).xy) ? t : FAR;
}

bool ground_occludes(Ray x) { return ground_hit(x) < 1.0; }

Partials ground_partials(vec3 x)
{
    vec2 uw = ground_closest(x).xy;
    return Partials(ground_O + uw.x * ground_U + uw.y * ground_W, ground_U, ground_W, vec3(0), vec3(0), vec3(0));
}

/* The t at which x + a t is at an end of 0..1. */
float reach(float x, float a)
{
    return a != 0.0 ? max(((a > 0.0 ? 1.0 : 0.0) - x) / a, 0.0) : FAR;
}

/* The t at which a way over the ground is at its edge. */
float way_to_edges(vec2 uw, vec2 d) { return GROUND == PLANE ? FAR : min(reach(uw.x, d.x), reach(uw.y, d.y)); }

#endif

/* ---- the caster ---- */

#if CASTER == BOX

uniform vec3 caster_lo, caster_hi;

/* Where the line enters and leaves: the first is less where it meets the box. */
vec2 box_crossing(Ray x)
{
    vec3 a = (caster_lo - x.r) / x.s, b = (caster_hi - x.r) / x.s, near = min(a, b), far = max(a, b);
    return vec2(max(max(near.x, near.y), near.z), min(min(far.x, far.y), far.z));
}

float caster_hit(Ray x)
{
    vec2 t = box_crossing(x);
    float first = t.x > 0.0 ? t.x : t.y;
    return t.x <= t.y && first > 0.0 ? first : FAR;
}

bool caster_occludes(Ray x)
{
    vec2 t = box_crossing(x);
    return t.x <= t.y && ((t.x > 0.0 && t.x < 1.0) || (t.y > 0.0 && t.y < 1.0));
}

/* Of the face across the axis along which x is farthest from the middle. */
vec3 caster_normal(vec3 x)
{
    vec3 p = (x - caster_lo) / (caster_hi - caster_lo) - 0.5, o = abs(p);
    vec3 face = o.x >= o.y && o.x >= o.z ? vec3(1, 0, 0) : o.y >= o.z ? vec3(0, 1, 0) : vec3(0, 0, 1);
    return face * sign(p);
}

#else

uniform vec3 caster_centre;
uniform float caster_radius;

float caster_hit(Ray x) { return sphere_hit(caster_centre, caster_radius, x); }
bool caster_occludes(Ray x) { return sphere_occludes(caster_centre, caster_radius, x); }
vec3 caster_normal(vec3 x) { return (x - caster_centre) / caster_radius; }

#endif
