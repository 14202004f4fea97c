/* Whether a file in colour is a grey one, or a normal map. */
#include "image/grey.h"

#include <math.h>

#include "image/format.h"

void grey_take(int n, float *v, grey_colours *c)
{
    for (int i = 0; i < n; i++) {
        const float *p = v + 3 * i;
        double square = 0;
        for (int k = 0; k < 3; k++) {
            c->sum[k] += (double)p[k];
            square += (2 * (double)p[k] - 1) * (2 * (double)p[k] - 1);
        }
        c->unequal += p[0] != p[1] || p[1] != p[2];
        c->units += square > 0.85 && square < 1.15;
        v[i] = p[0];
    }
    c->pixels += n;
}

/* A normal map in tangent space: unit vectors that point up, in blue, on the whole. */
static bool is_normal_map(const grey_colours *c)
{
    const double n = (double)c->pixels;
    return (double)c->units > 0.9 * n && fabs(c->sum[0] / n - 0.5) < 0.15 && fabs(c->sum[1] / n - 0.5) < 0.15 &&
           c->sum[2] / n > 0.7;
}

bool grey_found(const grey_colours *c, char *why)
{
    if (!c->unequal)
        return true;
    return is_normal_map(c)
               ? image_refuse(why, "the PNG is a normal map, which has slopes but no heights; a grey height map is "
                                   "expected, and docs/models.md tells how to make one")
               : image_refuse(why, "the PNG is in colour; a grey one is expected, of 8 or 16 bits: save it in grey, if "
                                   "bright means high");
}
