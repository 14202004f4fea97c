/* The bumps' own shadows (Max 1986; the march is kage's): 1 where the light reaches the rough surface at X. */
float bumps_shadow(Ray x, Group g)
{
    Partials q = g.q;
    vec3 n = g.n_smooth, X = g.rough, to = light_at - X;
    float P = g.bump.P, side = dot(n, x.s) < 0.0 ? 1.0 : -1.0;
    if (side * dot(g.n_bump, to) <= 0.0)
        return 0.0;
    bs_offset o = bs_offset_of(n, q.Qu, q.Qw, q.Quu, q.Quw, q.Qww, P);
    bs_view d = bs_view_of(to, bs_normal(o.Qu, o.Qw), o.Qu, o.Qw);
    bs_turn turn = bs_turn_of(d, n, q.Qu, q.Qw, q.Quu, q.Quw, q.Qww);
    bs_way y = bs_way_of(side, d, bs_curvature(d, n, q.Quu, q.Quw, q.Qww), P, Pmin, Pmax);
    float end = g.regular ? min(y.end, way_to_edges(g.uw, vec2(d.a, d.b))) : 0.0;
    for (int i = 1; i <= OWN_STEPS && end > 0.0; i++) {
        float t = bs_way_step(end, i, OWN_STEPS);
        if (bs_way_below(y, t, height(g.uw + vec2(d.a + turn.A * t, d.b + turn.B * t) * t)))
            return 0.0;
    }
#if GROUND == SPHERE
    /* The smooth shape's own shadow, from where the way has left the slab by as much as P's range. */
    float top = 2.0 * max(Pmax, 0.0) - min(Pmin, 0.0), bottom = max(Pmax, 0.0) - 2.0 * min(Pmin, 0.0);
    float leave = bs_way_to(y.d, y.curvature, (side > 0.0 ? top - P : bottom + P) + 1.5e-5 * length(X));
    leave = g.regular ? leave : 0.0;
    if (ground_occludes(Ray(X + to * leave, to * (1.0 - leave))))
        return 0.0;
#endif
    return 1.0;
}
