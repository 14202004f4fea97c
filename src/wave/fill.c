/* Fills as stages: in other functions such a loop has the vectors of any x86-64, which are half as wide. */
#include "wave/fill.h"

STAGE static void fill_one(int n, real x, real *restrict to)
{
    for (int i = 0; i < n; i++)
        to[i] = x;
}

STAGE static void fill_integers(int n, int32_t id, int32_t *restrict to)
{
    for (int i = 0; i < n; i++)
        to[i] = id;
}

STAGE static void fill_three(int n, real x, real y, real z, vec3s *restrict to) { vec3s_fill(to, n, x, y, z); }

void fill(int n, real x, real *to) { fill_one(n, x, to); }
void fill_ids(int n, int32_t id, int32_t *to) { fill_integers(n, id, to); }
void fill_vec3s(int n, real x, real y, real z, vec3s *to) { fill_three(n, x, y, z, to); }
