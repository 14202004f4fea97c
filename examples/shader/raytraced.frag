#version 460
/* As lighting.frag, with a shadow ray in place of a shadow map (Vulkan's ray queries). The line of the method is marked
 * (kage).
 *
 *     glslangValidator -V --target-env vulkan1.2 -I. raytraced.frag
 */
#extension GL_GOOGLE_include_directive : enable
#extension GL_EXT_ray_query : require
#include "start.glsl" // (kage)

layout(location = 0) in vec2 uv; // of the picture, 0 to 1

layout(set = 0, binding = 0) uniform sampler2D color;
layout(set = 0, binding = 1) uniform sampler2D rough; // what gbuffer.frag has written
layout(set = 0, binding = 2) uniform sampler2D normal;
layout(set = 0, binding = 3) uniform sampler2D depth;
layout(set = 0, binding = 4) uniform accelerationStructureEXT scene;
layout(set = 0, binding = 5) uniform Frame
{
    mat4 picture_to_world; // from clip space
    vec4 eye, light, light_color, ambient;
};

layout(location = 0) out vec4 lit;

/* Nothing is between start and start + d. `least`: the distance below which a hit is the start itself, as in any ray
 * tracer of rounded numbers. */
float seen_from(vec3 start, vec3 d, float least)
{
    rayQueryEXT query;
    rayQueryInitializeEXT(query, scene, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsOpaqueEXT, 0xFF, start,
                          least / length(d), d, 1.0);
    while (rayQueryProceedEXT(query))
        ;
    bool hit = rayQueryGetIntersectionTypeEXT(query, true) != gl_RayQueryCommittedIntersectionNoneEXT;
    return hit ? 0.0 : 1.0;
}

void main()
{
    vec4 n_tau = texture(rough, uv);
    vec4 world = picture_to_world * vec4(uv * 2.0 - 1.0, texture(depth, uv).r, 1.0);
    vec3 Q = world.xyz / world.w, n = texture(normal, uv).xyz;
    vec3 start = shadow_start(Q, normalize(Q - eye.xyz), n_tau.w, n, light.xyz - Q); // (kage), before: start = Q
    float seen = dot(n, light.xyz - Q) <= 0.0 ? 0.0 : seen_from(start, light.xyz - start, 1e-3);
    float cosine = max(0.0, dot(n_tau.xyz, normalize(light.xyz - Q)));
    lit = vec4(texture(color, uv).rgb * (ambient.rgb + light_color.rgb * cosine * seen), 1.0);
}
