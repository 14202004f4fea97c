/* The scene, by the numbers of its file: a bumped surface, the ground, and a plain object over it, the caster.
 * GROUND and CASTER say what they are.
 */
const int ON_GROUND = 0, ON_CASTER = 1;
const float FAR = 1e30;

struct Ray {
    vec3 r, s; /* r + s t */
};

struct Material {
    vec3 color;
    float ambient, diffuse, phong, phong_size;
};

uniform Material material[2]; /* of the ground and of the caster */
uniform vec3 background;
uniform vec3 light_at, light_color;
uniform vec3 eye_from, eye_forward, eye_right, eye_up;

/* The place on a ray. */
vec3 along(Ray x, float t) { return x.r + x.s * t; }

/* The way from a place to the light, which is at t = 1. */
Ray aim(vec3 from) { return Ray(from, light_at - from); }
