/* Where a shadow ray starts, for a shadow map or ray tracing in which the receiver is present like all else: at
 * Q + s tau, but not below the receiver's own smooth surface. That must not shadow its own bumps, so a start below it
 * is moved along the ray to the light, up to the tangent plane. For all other objects it is the same ray.
 *
 * Q: the place on the smooth surface; s: the unit vector to it from the eye; n: its unit normal; to_light: of any
 * length. */
vec3 shadow_start(vec3 Q, vec3 s, float tau, vec3 n, vec3 to_light)
{
    vec3 start = Q + s * tau;
    float below = -dot(start - Q, n), rise = dot(to_light, n);
    return below > 0.0 && rise > 0.0 ? start + to_light * (below / rise) : start;
}
