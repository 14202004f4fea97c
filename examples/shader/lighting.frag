#version 300 es
/* The pass that lights a G-buffer with one light that has a shadow map: looked up at the place where the rough surface
 * is, by 3 x 3 samples (PCF). The line of the method is marked (kage).
 *
 *     glslangValidator -l -I. lighting.frag
 */
#extension GL_GOOGLE_include_directive : enable
precision highp float;
#include "start.glsl" // (kage)

in vec2 uv; // of the picture, 0 to 1

uniform highp sampler2D color, rough, normal, depth; // what gbuffer.frag has written
uniform mat4 picture_to_world, world_to_map;    // of clip space, both
uniform vec3 eye, light, light_color, ambient;
uniform highp sampler2DShadow map;

layout(location = 0) out vec4 lit; // and, as alpha, how much of the light is seen

float seen_from(vec3 start)
{
    vec4 at = world_to_map * vec4(start, 1.0);
    vec3 x = at.xyz / at.w * 0.5 + 0.5, texel = vec3(1.0 / vec2(textureSize(map, 0)), 0.0);
    if (at.w <= 0.0 || any(lessThan(x, vec3(0.0))) || any(greaterThan(x, vec3(1.0))))
        return 1.0;
    float sum = 0.0;
    for (int i = -1; i <= 1; i++)
        for (int j = -1; j <= 1; j++)
            sum += texture(map, x + vec3(i, j, 0) * texel);
    return sum / 9.0;
}

void main()
{
    vec4 n_tau = texture(rough, uv), clip = vec4(vec3(uv, texture(depth, uv).r) * 2.0 - 1.0, 1.0);
    if (clip.z >= 1.0) { // nothing is there
        lit = vec4(texture(color, uv).rgb, 1.0);
        return;
    }
    vec4 world = picture_to_world * clip;
    vec3 Q = world.xyz / world.w, n = texture(normal, uv).xyz, to_light = light - Q;
    float seen = dot(n, to_light) <= 0.0 ? 0.0 : 1.0;
    if (seen > 0.0)
        seen = seen_from(shadow_start(Q, normalize(Q - eye), n_tau.w, n, to_light)); // (kage), before: seen_from(Q)
    float cosine = max(0.0, dot(n_tau.xyz, normalize(to_light)));
    lit = vec4(texture(color, uv).rgb * (ambient + light_color * cosine * seen), seen);
}
