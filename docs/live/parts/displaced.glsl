/* The ground truly displaced, Q + P n/|n|, met by many steps of half a sample each: for comparison. The closest point
 * has a closed form, so every place on a ray has its own height over the ground, and the gap is that less P.
 */
uniform float sample_width; /* in scene units */

float gap_at(vec3 x)
{
    vec3 p = ground_closest(x);
    return p.z - height(p.xy);
}

/* The part of a ray between 0 and `end` that is where the displaced ground can be; empty if x > y. */
vec2 ground_span(Ray x, float end)
{
#if GROUND == SPHERE
    vec2 t;
    bool met = sphere_roots(ground_centre, ground_radius + Pmax, x, t);
    return met ? vec2(max(t.x, 0.0), min(t.y, end)) : vec2(1, -1);
#else
    vec3 lo = vec3(0, 0, Pmin), hi = vec3(1, 1, Pmax), p = ground_closest(x.r);
    vec3 d = vec3(dot(x.s, ground_Du), dot(x.s, ground_Dw), dot(x.s, ground_N));
    vec3 a = (lo - p) / d, b = (hi - p) / d, near = min(a, b), far = max(a, b);
    vec2 span = vec2(max(near.z, 0.0), min(far.z, end));
    return GROUND == PLANE ? span : vec2(max(span.x, max(near.x, near.y)), min(span.y, min(far.x, far.y)));
#endif
}

/* The first hit of a ray that comes from above, or FAR. Of a ray that starts on the displaced ground (`own`) steps are
 * denser at its start, where the gap is 0 but for rounding. */
float displaced_hit(Ray x, float end, bool own)
{
    vec2 span = ground_span(x, end);
    if (span.x > span.y)
        return FAR;
    float way = (span.y - span.x) * length(x.s);
    int n = int(clamp(way / (0.5 * sample_width), 16.0, 400.0));
    float air = own ? 2e-6 * (length(x.r) + way) : 0.0, before = span.x, above = own ? 0.0 : gap_at(along(x, before));
    for (int i = 1; i <= n; i++) {
        float part = float(i) / float(n), t = span.x + (span.y - span.x) * (own ? part * part : part);
        float gap = gap_at(along(x, t));
        if (gap < -air || (gap <= 0.0 && i == n && !own)) {
            for (int k = 0; k < 8 && !own; k++) { /* regula falsi and halving in turn; a shadow ray needs no place */
                float share = k % 2 == 0 ? above / max(above - gap, 1e-20) : 0.5, c = mix(before, t, share);
                float g = gap_at(along(x, c));
                if (g > 0.0) {
                    before = c;
                    above = g;
                } else {
                    t = c;
                    gap = g;
                }
            }
            return own ? t : before;
        }
        before = t;
        above = max(gap, 0.0);
    }
    return FAR;
}

/* The normal of the displaced ground: the gradient of the gap. The gradients of u and w are those of the closest
 * point, so they are shorter the higher x is over a curved ground. */
vec3 displaced_normal(vec3 x, bs_bump b)
{
#if GROUND == SPHERE
    vec3 p = x - ground_centre;
    float d = max(length(p.xz), 1e-15), l = length(p);
    vec3 u = vec3(-p.z, 0, p.x) / (d * d), w = vec3(p.y * p.x / d, -d, p.y * p.z / d) / (l * l), h = p / l;
#else
    vec3 u = ground_Du, w = ground_Dw, h = ground_N;
#endif
    return h - b.Pu * u - b.Pw * w;
}
