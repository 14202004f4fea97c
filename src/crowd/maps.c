/* Lanes under maps of their own: the maps are laid side by side, then each product is one loop over the lanes. */
#include "crowd/parts.h"
#include "wave/gather.h"

static void pick_back(const crowd *f, int n, const int32_t *at, crowd_maps *to)
{
    for (int i = 0; i < n; i++) {
        const crowd_copy *c = &f->copy[at[i]];
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                to->m[a][b][i] = c->back[a][b];
        for (int a = 0; a < 3; a++)
            to->o[a][i] = c->o[a];
    }
}

void crowd_maps_to(const crowd *f, int n, const int32_t *at, crowd_maps *to)
{
    for (int i = 0; i < n; i++) {
        const crowd_copy *c = &f->copy[at[i]];
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                to->m[a][b][i] = c->to[a][b];
        for (int a = 0; a < 3; a++)
            to->o[a][i] = c->o[a];
    }
}

/* v = M v, by the rows of M. */
static inline void by_rows(const crowd_maps *k, int i, real x, real y, real z, vec3s *v)
{
    v->x[i] = k->m[0][0][i] * x + k->m[0][1][i] * y + k->m[0][2][i] * z;
    v->y[i] = k->m[1][0][i] * x + k->m[1][1][i] * y + k->m[1][2][i] * z;
    v->z[i] = k->m[2][0][i] * x + k->m[2][1][i] * y + k->m[2][2][i] * z;
}

STAGE static void crowd_place_by(const crowd_maps *restrict k, int n, vec3s *restrict r)
{
    for (int i = 0; i < n; i++)
        by_rows(k, i, r->x[i] - k->o[0][i], r->y[i] - k->o[1][i], r->z[i] - k->o[2][i], r);
}

STAGE static void crowd_way_by(const crowd_maps *restrict k, int n, vec3s *restrict s)
{
    for (int i = 0; i < n; i++)
        by_rows(k, i, s->x[i], s->y[i], s->z[i], s);
}

/* v = k M v, by the columns of M. */
STAGE static void crowd_vector_by(const crowd_maps *restrict f, int n, real k, vec3s *restrict v)
{
    for (int i = 0; i < n; i++) {
        const real x = v->x[i], y = v->y[i], z = v->z[i];
        v->x[i] = x * (k * f->m[0][0][i]) + y * (k * f->m[1][0][i]) + z * (k * f->m[2][0][i]);
        v->y[i] = x * (k * f->m[0][1][i]) + y * (k * f->m[1][1][i]) + z * (k * f->m[2][1][i]);
        v->z[i] = x * (k * f->m[0][2][i]) + y * (k * f->m[1][2][i]) + z * (k * f->m[2][2][i]);
    }
}

STAGE static void crowd_move_by(const crowd_maps *restrict f, int n, vec3s *restrict v)
{
    for (int i = 0; i < n; i++) {
        v->x[i] += f->o[0][i];
        v->y[i] += f->o[1][i];
        v->z[i] += f->o[2][i];
    }
}

void crowd_rays_back(const crowd *f, int n, const int32_t *at, const int32_t *lane, const rays *x, rays *y)
{
    crowd_maps k;
    pick_back(f, n, at, &k);
    if (lane)
        gather_rays(n, lane, x, y);
    else
        *y = *x;
    crowd_place_by(&k, n, &y->r);
    crowd_way_by(&k, n, &y->s);
}

void crowd_places_back(const crowd *f, int n, const int32_t *at, vec3s *r)
{
    crowd_maps k;
    pick_back(f, n, at, &k);
    crowd_place_by(&k, n, r);
}

void crowd_vectors_to(const crowd_maps *f, int n, real k, vec3s *v) { crowd_vector_by(f, n, k, v); }

void crowd_places_to(const crowd_maps *f, int n, vec3s *v)
{
    crowd_vector_by(f, n, 1, v);
    crowd_move_by(f, n, v);
}

void crowd_split(const crowd *f, int n, const int32_t *part, int32_t *at, int32_t *its)
{
    for (int i = 0; i < n; i++) {
        at[i] = crowd_copy_of(f, part[i]);
        its[i] = part[i] - at[i] * f->parts;
    }
}

void crowd_join(const crowd *f, int n, const int32_t *at, const int32_t *its, int32_t *part)
{
    for (int i = 0; i < n; i++)
        part[i] = at[i] * f->parts + its[i];
}
