/* POV-Ray's diffuse light and Phong's highlight, with n'. front: a light behind the smooth surface is not seen. */
vec3 shade_light(Ray x, Group g, Material m, float lit, bool front)
{
    float side = dot(g.n_smooth, x.s) < 0.0 ? 1.0 : -1.0;
    vec3 d = light_at - along(x, g.t_shade), L = normalize(d), n = side * g.n_bump, s = normalize(x.s);
    if (front && side * dot(g.n_smooth, d) <= 0.0)
        return vec3(0);
    float mirrored = max(dot(s, L) - 2.0 * dot(s, n) * dot(n, L), 0.0);
    float shine = m.phong > 0.0 && mirrored > 0.0 ? m.phong * pow(mirrored, m.phong_size) : 0.0;
    return lit * (m.diffuse * max(dot(n, L), 0.0) * m.color + shine) * light_color;
}

/* From linear light to the screen. */
vec3 srgb(vec3 x)
{
    x = clamp(x, 0.0, 1.0);
    return mix(12.92 * x, 1.055 * pow(max(x, 1e-6), vec3(1.0 / 2.4)) - 0.055, vec3(greaterThan(x, vec3(0.0031308))));
}
