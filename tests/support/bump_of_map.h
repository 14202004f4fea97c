/* A bump from samples in memory. */
#ifndef KAGE_TESTS_BUMP_OF_MAP_H
#define KAGE_TESTS_BUMP_OF_MAP_H

#include "image/image.h"
#include "texture/bump.h"

/* m: one value a pixel. NULL as bump_map_new. */
static inline bump *bump_of_map(const image *m, const map_layout *l)
{
    bump *p = bump_map_new(m->width, m->height, l, NULL);
    for (int y = 0; p && y < m->height; y++)
        bump_map_put(p, 0, y, m->width, m->v + (size_t)y * (size_t)m->width);
    if (p)
        bump_map_end(p, 2);
    return p;
}

#endif
