/* Colour textures: checkers and images. */
#include "texture/color.h"

#include <stdlib.h>

#include "base/shared.h"

/* ---- checker ---- */

typedef struct checker {
    color_texture base;
    real even[3], odd[3];
    real ku, kw, ou, ow; /* fields per u and per w, and where (u,w) = 0 is, in fields */
} checker;

STAGE static void checker_eval(const color_texture *base, int n, const real *restrict u, const real *restrict w,
                               vec3s *restrict color)
{
    const checker c = *(const checker *)base;
    for (int i = 0; i < n; i++) {
        real pair = R(0.5) * (real_floor(u[i] * c.ku + c.ou) + real_floor(w[i] * c.kw + c.ow));
        real odd = real_max(2 * (pair - real_floor(pair)), 0); /* 0 or 1; 0, too, where pair is infinite */
        color->x[i] = c.even[0] + odd * (c.odd[0] - c.even[0]);
        color->y[i] = c.even[1] + odd * (c.odd[1] - c.even[1]);
        color->z[i] = c.even[2] + odd * (c.odd[2] - c.even[2]);
    }
}

static const color_texture_ops checker_methods = {.kind = "checker", .eval = checker_eval};

color_texture *color_checker_new(const vec3 color[2], const double size[2], const double offset[2])
{
    checker *c = calloc(1, sizeof *c);
    if (!c)
        return NULL;
    c->base.ops = &checker_methods;
    vec3_round(c->even, color[0]);
    vec3_round(c->odd, color[1]);
    c->ku = (real)(1 / size[0]);
    c->kw = (real)(1 / size[1]);
    c->ou = (real)(-offset[0] / size[0]);
    c->ow = (real)(-offset[1] / size[1]);
    return &c->base;
}

/* ---- image ---- */

struct texels {
    int others; /* base/shared.h */
    int width, height;
    real v[]; /* as table.h has it */
};

texels *texels_new(const image *m, const map_layout *l, const progress *w)
{
    table_grid g;
    if (!table_lay(&g, m->width, m->height, l))
        return NULL;
    const size_t columns = (size_t)g.columns + 1, rows = (size_t)g.rows + 1;
    texels *t = memory_new(progress_memory(w), sizeof *t + columns * rows * TABLE_VALUES * sizeof *t->v);
    if (!t)
        return NULL;
    t->others = 0;
    t->width = m->width;
    t->height = m->height;
    for (size_t j = 0; j < rows; j++)
        for (size_t i = 0; i < columns; i++) {
            const int y = table_sample((int)j, m->height, l), x = table_sample((int)i, m->width, l);
            const float *from = m->v + 4 * ((size_t)y * (size_t)m->width + (size_t)x);
            for (size_t k = 0; k < TABLE_VALUES; k++)
                t->v[(j * columns + i) * TABLE_VALUES + k] = (real)from[k];
        }
    return t;
}

texels *texels_share(texels *t)
{
    shared_add(&t->others);
    return t;
}

void texels_free(texels *t)
{
    if (t && shared_drop(&t->others))
        memory_free(t);
}

typedef struct image_texture {
    color_texture base;
    const texels *texels;
    table_grid grid;
    bool nearest;
} image_texture;

/* Each pixel is a cell, with the colour of the sample at its upper left corner. At the end of the table, 1 in the last
 * cell is the last sample. */
STAGE static void to_corner(int n, real *restrict a)
{
    for (int i = 0; i < n; i++)
        a[i] = a[i] < 1 ? 0 : R(1);
}

static void image_eval(const color_texture *base, int n, const real *u, const real *w, vec3s *color)
{
    const image_texture *p = (const image_texture *)base;
    int32_t at[LANES];
    real a[LANES], b[LANES];
    table_cells(&p->grid, p->grid.columns + 1, n, u, w, at, a, b);
    if (p->nearest) {
        to_corner(n, a);
        to_corner(n, b);
    }
    table_three(&p->grid, p->texels->v, n, at, a, b, color->x, color->y, color->z);
}

static const color_texture_ops image_methods = {.kind = "image", .eval = image_eval};

color_texture *color_image_new(const texels *t, const map_layout *l, bool nearest)
{
    image_texture *p = calloc(1, sizeof *p);
    if (!p)
        return NULL;
    p->base.ops = &image_methods;
    p->texels = t;
    p->nearest = nearest;
    table_lay(&p->grid, t->width, t->height, l);
    if (nearest) { /* half a pixel more, so that cells begin at the edges of pixels */
        p->grid.ou += R(0.5);
        p->grid.ow += R(0.5);
    }
    return &p->base;
}

void color_texture_free(color_texture *p)
{
    if (p && p->ops->free)
        p->ops->free(p);
    else
        free(p);
}
