#version 450
/* The shift of many pixels as a pass of its own, for engines whose G-buffer pass can't be changed; and a file from
 * which spirv-cross makes the functions in HLSL and Metal:
 *
 *     glslangValidator -V -I../../include shift.comp -o shift.spv
 *     spirv-cross shift.spv --hlsl --shader-model 60 --output shift.hlsl
 *     spirv-cross shift.spv --msl --output shift.metal
 */
#extension GL_GOOGLE_include_directive : enable
#include "bumpshadow.glsl"

layout(local_size_x = 64) in;

struct Pixel
{
    vec4 s, Qu, Qw;                 // the ray, and dQ/du and dQ/dw at the smooth hit
    float P, Pu, Pw, Puu, Puw, Pww; // the height there, and its partials
};

layout(std430, set = 0, binding = 0) readonly buffer Pixels { Pixel pixel[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Taus { float tau[]; };
layout(set = 0, binding = 2) uniform Heights { float Pmin, Pmax; };
layout(constant_id = 0) const int ORDER = 0; // a constant, so that the other orders are compiled away

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(pixel.length()))
        return;
    vec3 s = pixel[i].s.xyz, Qu = pixel[i].Qu.xyz, Qw = pixel[i].Qw.xyz, n = bs_normal(Qu, Qw);
    bs_view v = bs_view_of(s, n, Qu, Qw);
    bs_bump p = bs_bump(pixel[i].P, pixel[i].Pu, pixel[i].Pw, pixel[i].Puu, pixel[i].Puw, pixel[i].Pww);
    float shift = bs_shift_of(ORDER, true, v, 0.0, p, bs_slab_of(v, Pmin, Pmax)).tau;
    tau[i] = bs_regular(n, Qu, Qw) ? shift : 0.0;
}
