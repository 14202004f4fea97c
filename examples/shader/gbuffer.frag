#version 300 es
/* The pass that fills a G-buffer, with a surface that has a height map. The method adds one number to it, tau: how far
 * along the ray to the eye a shadow ray has to start. It is small, so 16 bits are enough. The lines of the method are
 * marked (kage). Lighting is lighting.frag or raytraced.frag.
 *
 *     glslangValidator -l -I../../include gbuffer.frag
 *
 * Where the compiler knows no #include, as in WebGL, paste the file in its place.
 */
#extension GL_GOOGLE_include_directive : enable
precision highp float;
#include "bumpshadow.glsl" // (kage)

in vec3 Q;  // the place on the smooth surface, in the world
in vec3 N;  // its normal
in vec2 uv; // of the height map, 1 for its whole width

uniform vec3 eye;
uniform vec3 albedo;
uniform highp sampler2D heights;
uniform float zero, scale; // P = scale (height - zero), in the world's units

layout(location = 0) out vec4 color;  // of the surface
layout(location = 1) out vec4 rough;  // n', and tau
layout(location = 2) out vec4 normal; // n/|n|

float P_at(vec2 at) { return scale * (texture(heights, at).r - zero); }

/* dQ/du and dQ/dw from what the rasteriser knows, so that no tangents are needed; those of a vertex do as well. They
 * are laid into the plane across the interpolated normal, else a curved mesh would show its triangles. */
void partials(out vec3 Qu, out vec3 Qw)
{
    vec3 Qx = dFdx(Q), Qy = dFdy(Q);
    vec2 x = dFdx(uv), y = dFdy(uv);
    float i = 1.0 / (x.x * y.y - x.y * y.x);
    Qu = (Qx * y.y - Qy * x.y) * i;
    Qw = (Qy * x.x - Qx * y.x) * i;
    Qu -= N * (dot(N, Qu) / dot(N, N));
    Qw -= N * (dot(N, Qw) / dot(N, N));
}

void main()
{
    vec2 texel = 1.0 / vec2(textureSize(heights, 0));
    float P = P_at(uv);
    float Pu = (P_at(uv + vec2(texel.x, 0.0)) - P_at(uv - vec2(texel.x, 0.0))) / (2.0 * texel.x);
    float Pw = (P_at(uv + vec2(0.0, texel.y)) - P_at(uv - vec2(0.0, texel.y))) / (2.0 * texel.y);
    vec3 Qu, Qw, s = normalize(Q - eye);
    partials(Qu, Qw);
    if (dot(cross(Qu, Qw), N) < 0.0) { // n must point to the side of +P: exchange u and w
        vec3 q = Qu;
        Qu = Qw, Qw = q;
        float p = Pu;
        Pu = Pw, Pw = p;
    }
    vec3 n = bs_normal(Qu, Qw);                                                   // (kage)
    vec3 np = bs_perturbed_normal(n, Qu, Qw, Pu, Pw);                             // (kage)
    bs_view v = bs_view_of(s, n, Qu, Qw);                                         // (kage)
    bs_bump p = bs_bump(P, Pu, Pw, 0.0, 0.0, 0.0);                                // (kage)
    bs_slab slab = bs_slab_of(v, scale * (0.0 - zero), scale * (1.0 - zero));     // (kage)
    float tau = bs_shift_of(0, true, v, 0.0, p, slab).tau;                        // (kage)
    bool regular = bs_regular(n, Qu, Qw); // not where the texture is degenerate  // (kage)
    color = vec4(albedo, 1.0);
    normal = vec4(normalize(N), 0.0);
    rough = regular ? vec4(normalize(np), tau) : normal;                          // (kage)
}
