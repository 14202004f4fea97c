/* What is known where a ray meets a surface. */
struct Group {
    int id;
    float t, tau, t0, t_shade; /* the smooth hit; the shift; the start of shadow rays; the place that is shaded */
    vec2 uw;
    Partials q;
    bs_bump bump;
    vec3 n_smooth, n_bump; /* n, and the unit vector along n' */
    bool regular;
    vec3 rough; /* Q + P n/|n| */
};

/* tau, the shift of the shadow rays' origin along the viewing ray: what the methods differ in. */
float tau_find(Ray x, Group g)
{
    bs_view v = bs_view_of(x.s, g.n_smooth, g.q.Qu, g.q.Qw);
    bs_slab slab = bs_slab_of(v, Pmin, Pmax);
    float curvature = bs_curvature(v, g.n_smooth, g.q.Quu, g.q.Quw, g.q.Qww);
#if METHOD == ORDER_0
    return bs_shift_of(0, true, v, 0.0, g.bump, slab).tau;
#elif METHOD == ORDER_1
    return bs_shift_of(1, true, v, 0.0, g.bump, slab).tau;
#elif METHOD == ORDER_2
    return bs_shift_of(2, true, v, 0.0, g.bump, slab).tau;
#elif METHOD == ORDER_2_PLUS
    return bs_shift_of(3, true, v, curvature, g.bump, slab).tau;
#elif METHOD == MARCH
    bs_march m = bs_march_start(slab);
    for (int i = 0; i <= MARCH_STEPS && !m.found; i++) {
        float tau = bs_march_tau(slab, i, MARCH_STEPS);
        m = bs_march_step(m, tau, bs_gap(v, curvature, tau, height(g.uw + vec2(v.a, v.b) * tau)), v);
    }
    return m.found ? m.tau : bs_tau0(v, g.bump.P);
#else
    return 0.0;
#endif
}
