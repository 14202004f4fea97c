/* The way of a ray, in the paper's steps and by the names of src/render/trace.c:
 *
 *     eye -> nearest hit with the smooth surfaces -> Q and its partials -> P and its partials -> n'
 *     -> the shift tau -> the place that is shaded -> shadow ray from r + s t0 -> light there with n'
 */
vec3 unit_normal(Group g)
{
    return normalize(g.regular ? bs_perturbed_normal(g.n_smooth, g.q.Qu, g.q.Qw, g.bump.Pu, g.bump.Pw) : g.n_smooth);
}

/* Q, P and n' at the point of the smooth ground that is closest to a place. */
void shape_at(vec3 place, inout Group g)
{
    g.uw = ground_closest(place).xy;
    g.q = ground_partials(place);
    g.bump = bump_at(g.uw);
    g.n_smooth = bs_normal(g.q.Qu, g.q.Qw);
    g.regular = bs_regular(g.n_smooth, g.q.Qu, g.q.Qw);
    g.n_bump = unit_normal(g);
}

void shape_and_shift(Ray x, inout Group g)
{
    shape_at(along(x, g.t), g);
    g.tau = g.regular ? tau_find(x, g) : 0.0;
}

/* The ground truly displaced needs no shift. */
void shape_displaced(Ray x, inout Group g)
{
    vec3 place = along(x, g.t);
    g.uw = ground_closest(place).xy;
    g.n_smooth = g.n_bump = normalize(displaced_normal(place, bump_at(g.uw)));
}

/* n' of the rough surface itself, with the smooth surface's curvature in it. */
void bend_normal(inout Group g)
{
    bs_offset o = bs_offset_of(g.n_smooth, g.q.Qu, g.q.Qw, g.q.Quu, g.q.Quw, g.q.Qww, g.bump.P);
    vec3 N = bs_normal(o.Qu, o.Qw);
    if (g.regular && dot(g.n_smooth, N) > 0.0) /* not beyond the centre of curvature */
        g.n_bump = normalize(bs_perturbed_normal(N, o.Qu, o.Qw, g.bump.Pu, g.bump.Pw));
}

/* The place that is shaded: the smooth hit, as in the paper, or where the shadow ray starts. */
void place_find(Ray x, inout Group g)
{
#if SHIFTED
    g.t_shade = g.t0 > 0.0 && g.t0 < FAR ? g.t0 : g.t;
    shape_at(along(x, g.t_shade), g);
    bend_normal(g);
#endif
    g.rough = g.q.Q + g.bump.P * g.n_smooth * inversesqrt(max(dot(g.n_smooth, g.n_smooth), 1e-30));
}

/* 1 where the light is seen. */
float shadow_light(Ray x, Group g)
{
    Ray to = aim(along(x, g.t0)); /* from r + s t0 */
    if (g.id == ON_GROUND) {
#if METHOD == DISPLACED
        if (dot(g.n_smooth, to.s) * dot(g.n_smooth, x.s) >= 0.0 || displaced_hit(to, 1.0, true) < 1.0)
            return 0.0;
#elif OWN_STEPS > 0
        if (bumps_shadow(x, g) == 0.0)
            return 0.0;
#endif
        return caster_occludes(to) ? 0.0 : 1.0;
    }
#if METHOD == DISPLACED
    return displaced_hit(to, 1.0, false) < 1.0 ? 0.0 : 1.0;
#else
    return ground_occludes(to) ? 0.0 : 1.0;
#endif
}

vec3 light_group(Ray x, Group g)
{
    Material m = material[g.id];
    bool own = g.id == ON_GROUND && OWN_STEPS > 0 && METHOD != DISPLACED && Pmin < Pmax;
    return m.ambient * m.color + shade_light(x, g, m, shadow_light(x, g), !own);
}

/* The light that a ray brings to the eye. */
vec3 trace(Ray x)
{
    Group g;
    float on_caster = caster_hit(x);
#if METHOD == DISPLACED
    float on_ground = displaced_hit(x, FAR, false);
#else
    float on_ground = ground_hit(x);
#endif
    g.t = min(on_ground, on_caster);
    if (g.t >= FAR)
        return background;
    g.id = on_ground < on_caster ? ON_GROUND : ON_CASTER;
    g.tau = 0.0;
    if (g.id == ON_CASTER)
        g.n_smooth = g.n_bump = caster_normal(along(x, g.t));
    else
#if METHOD == DISPLACED
        shape_displaced(x, g);
#else
        shape_and_shift(x, g);
#endif
    g.t0 = g.t + g.tau; /* where shadow rays start: all of the method */
    g.t_shade = g.t;
#if METHOD != DISPLACED
    if (g.id == ON_GROUND)
        place_find(x, g);
#endif
    return light_group(x, g);
}
