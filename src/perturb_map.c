/* P from discrete data, section 4.1 of the paper: "the data of the points next to the intersection ... their
 * differences as approximate derivatives ... where the coordinates are real numbers, the derivatives at the neighbouring
 * points are interpolated bilinearly".
 *
 * The central differences are made once, at the samples, and already carry scale and chain rule.
 */
#include "perturb.h"

#include <stdlib.h>

enum { P_PU_PW, PUU_PUW_PWW, TABLES };

typedef struct map {
    perturb base;
    table_grid grid;
    real *table[TABLES]; /* row 0 at the lowest w, as in the image */
} map;

static void map_eval(const perturb *base, int n, const real *u, const real *w, int order, heights *h)
{
    const map *m = (const map *)base;
    int32_t at[LANES];
    real a[LANES], b[LANES];
    table_cells(&m->grid, n, u, w, at, a, b);
    if (order == 0)
        table_one(&m->grid, m->table[P_PU_PW], n, at, a, b, h->P);
    else
        table_three(&m->grid, m->table[P_PU_PW], n, at, a, b, h->P, h->Pu, h->Pw);
    if (order == 2)
        table_three(&m->grid, m->table[PUU_PUW_PWW], n, at, a, b, h->Puu, h->Puw, h->Pww);
}

static void map_free(perturb *base)
{
    map *m = (map *)base;
    for (int k = 0; k < TABLES; k++)
        free(m->table[k]);
    free(m);
}

static const perturb_methods map_methods = {"map", map_eval, map_free};

/* The tables. ku, kw: samples per u and per w, for the chain rule. */
static void map_differences(map *m, const image *s, const map_layout *l, double ku, double kw)
{
    m->base.Pmin = REAL_FAR;
    m->base.Pmax = -REAL_FAR;
    for (int j = 0; j <= m->grid.rows; j++)
        for (int i = 0; i <= m->grid.columns; i++) {
            double z[3][3];
            for (int y = 0; y < 3; y++)
                for (int x = 0; x < 3; x++) {
                    int row = table_sample(j + y - 1, s->height, l), column = table_sample(i + x - 1, s->width, l);
                    double v = (double)s->v[(size_t)row * (size_t)s->width + (size_t)column];
                    z[y][x] = l->scale * (v - l->zero);
                }
            const double d[TABLES][TABLE_VALUES] = {
                {z[1][1], (z[1][2] - z[1][0]) / 2 * ku, (z[2][1] - z[0][1]) / 2 * kw},
                {(z[1][2] - 2 * z[1][1] + z[1][0]) * ku * ku, (z[2][2] - z[2][0] - z[0][2] + z[0][0]) / 4 * ku * kw,
                 (z[2][1] - 2 * z[1][1] + z[0][1]) * kw * kw},
            };
            for (int t = 0; t < TABLES; t++)
                for (int k = 0; k < TABLE_VALUES; k++)
                    m->table[t][((size_t)j * (size_t)(m->grid.columns + 1) + (size_t)i) * TABLE_VALUES + (size_t)k] = (real)d[t][k];
            m->base.Pmin = real_min((real)z[1][1], m->base.Pmin);
            m->base.Pmax = real_max((real)z[1][1], m->base.Pmax);
        }
}

static double steepest(const real *from, const real *to, double so_far)
{
    double d = fabs((double)*to - (double)*from);
    return d <= so_far ? so_far : d == d ? d : HUGE_VAL; /* NaN: a sample is, or is infinite */
}

/* Bilinear between the samples, P is steepest along the edge of a cell: by the difference of two neighbours, not by the
 * central ones, which are means of two such. The extra column and row hold the neighbours across the wrap. */
static void map_slopes(map *m)
{
    double du = 0, dw = 0;
    const size_t next = TABLE_VALUES, below = (size_t)(m->grid.columns + 1) * TABLE_VALUES;
    const real *v = m->table[P_PU_PW];
    for (int j = 0; j <= m->grid.rows; j++)
        for (int i = 0; i <= m->grid.columns; i++, v += TABLE_VALUES) {
            du = i < m->grid.columns ? steepest(v, v + next, du) : du;
            dw = j < m->grid.rows ? steepest(v, v + below, dw) : dw;
        }
    m->base.Pu_max = perturb_slope(du, (double)m->grid.ku); /* as the stages have it */
    m->base.Pw_max = perturb_slope(dw, (double)m->grid.kw);
}

perturb *perturb_map(const image *samples, const map_layout *l)
{
    table_grid grid;
    map *m = table_lay(&grid, samples->width, samples->height, l) ? calloc(1, sizeof *m) : NULL;
    if (!m)
        return NULL;
    m->base.is = &map_methods;
    m->grid = grid;
    for (int k = 0; k < TABLES; k++) {
        m->table[k] = malloc(sizeof(real) * TABLE_VALUES * (size_t)(m->grid.columns + 1) * (size_t)(m->grid.rows + 1));
        if (!m->table[k]) {
            map_free(&m->base);
            return NULL;
        }
    }
    map_differences(m, samples, l, (double)(samples->width - l->corners) / l->size[0],
                    (double)(samples->height - l->corners) / l->size[1]);
    map_slopes(m);
    return &m->base;
}

void perturb_free(perturb *p)
{
    if (p)
        p->is->free(p);
}
