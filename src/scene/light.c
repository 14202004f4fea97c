/* The samples and the corners of area lights. */
#include "scene/light.h"

/* The weight of sample i among `first` to `last`, as by POV-Ray's adaptive halving: a sample in the middle belongs to
 * both halves. The weights of 2, 4, 8 ... samples are equal. */
static double share_of(int i, int first, int last)
{
    if (i < first || i > last)
        return 0;
    if (first == last)
        return 1;
    int below = (first + last) / 2, above = (first + last + 1) / 2;
    return (share_of(i, first, below) + share_of(i, above, last)) / 2;
}

/* The place of sample i of n along a side, -1/2..1/2; the first and the last are on the edge. */
static double along_side(int i, int n) { return n > 1 ? (double)i / (n - 1) - 0.5 : 0; }

light light_sample(const light *l, int k, real *share)
{
    const int i = k % l->samples[0], j = k / l->samples[0];
    light one = *l;
    one.at = vec3_add(one.at, vec3_add(vec3_scale(l->u, along_side(i, l->samples[0])),
                                       vec3_scale(l->w, along_side(j, l->samples[1]))));
    *share = (real)(share_of(i, 0, l->samples[0] - 1) * share_of(j, 0, l->samples[1] - 1));
    return one;
}

int light_corners(const light *l) { return l->samples[0] * l->samples[1] > 1 ? 4 : 1; }

vec3 light_corner(const light *l, int k, vec3 p)
{
    if (l->kind == LIGHT_PARALLEL)
        return vec3_sub(p, vec3_scale(l->axis, 1e6));
    if (light_corners(l) == 1)
        return l->at;
    return vec3_add(l->at, vec3_add(vec3_scale(l->u, (k & 1) - 0.5), vec3_scale(l->w, (k >> 1) - 0.5)));
}
