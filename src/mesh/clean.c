/* Checks and repairs the triangles of a file. Afterwards numbers are finite, each triangle has an area, and each corner
 * has a unit normal that does not face away. */
#include "mesh/mesh_data.h"

#include "base/threads.h"
#include "base/vec3.h"
#include "math/kmath.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FLAT 1e-10      /* a triangle that is lower than this share of its longest side has no direction */
#define FACING 0.05     /* the least cosine between a corner's normal and its triangle's: 87 degrees */
#define TEXTURE 1e6     /* the largest texture coordinate: float leaves it a digit after the point */
#define SHORTEST 1e-6   /* a normal, or a sum of unit normals, that is shorter has no direction in float */
#define LONGEST 1e6     /* a longer normal is ignored */
#define SAME_ANGLE 1e-6 /* of cosines: float's coordinates determine them no better */

/* Up to this many triangles about a vertex are compared with each other. With more, every corner gets the mean over
 * all, so that time stays linear. */
enum { FAN = 512 };

/* (b - a) x (c - a) */
static vec3 area_of(float at[3][3])
{
    const vec3 a = mesh_get(at[0]);
    return vec3_cross(vec3_sub(mesh_get(at[1]), a), vec3_sub(mesh_get(at[2]), a));
}

static bool is_flat(float at[3][3], vec3 area)
{
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        const vec3 side = vec3_sub(mesh_get(at[(k + 1) % 3]), mesh_get(at[k]));
        longest = greater(longest, vec3_dot(side, side));
    }
    return !(vec3_length(area) > FLAT * longest);
}

/* ---- numbers ---- */

static bool check_numbers(const mesh_data *d, double most, char why[MESH_WHY])
{
    for (int k = 0; k < d->n; k++)
        for (int i = 0; i < 9; i++) {
            const double x = (double)d->at[k][i / 3][i % 3];
            if (!(fabs(x) <= most)) {
                snprintf(why, MESH_WHY, "a vertex has the coordinate %g, expected -%g to %g", x, most, most);
                return false;
            }
        }
    for (int k = 0; k < d->n; k++)
        for (int i = 0; i < 6; i++) {
            const double x = (double)d->skin[k].uv[i / 2][i % 2];
            if (fabs(x) > TEXTURE) { /* false for NaN: none in the file */
                snprintf(why, MESH_WHY, "a texture coordinate is %g, expected -%g to %g", x, TEXTURE, TEXTURE);
                return false;
            }
        }
    return true;
}

static void drop_flat(mesh_data *d)
{
    int n = 0;
    for (int k = 0; k < d->n; k++) {
        if (is_flat(d->at[k], area_of(d->at[k])))
            continue;
        memmove(d->at[n], d->at[k], sizeof d->at[n]);
        d->skin[n++] = d->skin[k];
    }
    d->notes.flat = d->n - n;
    d->n = n;
}

static void count_bare(mesh_data *d)
{
    for (int k = 0; k < d->n; k++) {
        bool bare = false;
        for (int i = 0; i < 6; i++)
            bare |= !(d->skin[k].uv[i / 2][i % 2] < HUGE_VALF);
        d->notes.bare += bare;
    }
}

/* ---- normals ---- */

/* The corners by their place: corner[first[k]] to corner[first[k + 1] - 1] are at place k. All arrays are owned. */
typedef struct places {
    int32_t *of; /* the place of each corner */
    int32_t *first, *corner;
    int n;
} places;

static void free_places(places *p)
{
    memory_free(p->of);
    memory_free(p->first);
    memory_free(p->corner);
}

/* FNV-1a; -0 is 0. */
static uint32_t hash_of(const float at[3])
{
    uint32_t h = 2166136261u, word[3];
    memcpy(word, at, sizeof word);
    for (int k = 0; k < 3; k++)
        h = (h ^ (word[k] == 0x80000000u ? 0 : word[k])) * 16777619u, h ^= h >> 15;
    return h;
}

static bool same(const float a[3], const float b[3]) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

static bool find_places(const mesh_data *d, memory *m, places *p)
{
    const int corners = 3 * d->n;
    uint32_t size = 16;
    while (size < 2 * (uint32_t)corners)
        size *= 2;
    int32_t *table = memory_new(m, sizeof *table * size); /* open addressing: a corner of each place, -1: free */
    *p = (places){memory_new(m, sizeof(int32_t) * (size_t)corners), NULL,
                  memory_new(m, sizeof(int32_t) * (size_t)corners), 0};
    if (table && p->of)
        memset(table, 0xff, sizeof *table * size);
    for (int i = 0; table && p->of && i < corners; i++) {
        const float *at = d->at[i / 3][i % 3];
        uint32_t k = hash_of(at) & (size - 1);
        while (table[k] >= 0 && !same(d->at[table[k] / 3][table[k] % 3], at))
            k = (k + 1) & (size - 1);
        if (table[k] < 0) {
            table[k] = i;
            p->of[i] = p->n++;
        } else
            p->of[i] = p->of[table[k]];
    }
    memory_free(table);
    p->first = memory_zeroed(m, ((size_t)p->n + 2) * sizeof *p->first);
    if (!table || !p->of || !p->corner || !p->first)
        return false;
    for (int i = 0; i < corners; i++)
        p->first[p->of[i] + 2]++;
    for (int k = 0; k < p->n; k++)
        p->first[k + 2] += p->first[k + 1];
    for (int i = 0; i < corners; i++) /* each first[k + 1] ends as the first of place k + 1 */
        p->corner[p->first[p->of[i] + 1]++] = i;
    return true;
}

/* The triangle's unit normal times its angle at that corner: sums do not depend on how a flat face is triangulated. */
static vec3 weighted_normal(const mesh_data *d, int corner)
{
    float(*at)[3] = d->at[corner / 3];
    const vec3 a = mesh_get(at[corner % 3]);
    const vec3 b = vec3_sub(mesh_get(at[(corner + 1) % 3]), a), c = vec3_sub(mesh_get(at[(corner + 2) % 3]), a);
    const double cosine = vec3_dot(b, c) / (vec3_length(b) * vec3_length(c));
    return vec3_scale(vec3_unit(area_of(at)), km_acos(fmin(1, fmax(-1, cosine))));
}

/* Set the normals of those corners at one place that have none. least: the cosine of the crease angle. */
static void smooth_place(mesh_data *d, const int32_t *corner, int n, double least)
{
    vec3 all = {0, 0, 0}, one[FAN], weighted[FAN];
    for (int i = 0; n > FAN && i < n; i++)
        all = vec3_add(all, weighted_normal(d, corner[i]));
    for (int i = 0; n <= FAN && i < n; i++) {
        one[i] = vec3_unit(area_of(d->at[corner[i] / 3]));
        weighted[i] = weighted_normal(d, corner[i]);
    }
    for (int i = 0; i < n; i++) {
        const vec3 own = n <= FAN ? one[i] : vec3_unit(area_of(d->at[corner[i] / 3]));
        vec3 sum = all;
        float *to = d->skin[corner[i] / 3].normal[corner[i] % 3];
        if (to[0] != 0 || to[1] != 0 || to[2] != 0)
            continue;
        for (int j = 0; n <= FAN && j < n; j++)
            if (i == j || vec3_dot(own, one[j]) >= least)
                sum = vec3_add(sum, weighted[j]);
        const double length = vec3_length(sum);
        mesh_set(to, length > SHORTEST ? vec3_scale(sum, 1 / length) : own);
    }
}

static bool smooth(mesh_data *d, double crease, int threads, memory *m)
{
    places p;
    const bool good = find_places(d, m, &p);
    const double least = km_cos(crease * (KM_PI / 180)) - SAME_ANGLE;
    const int n = good ? p.n : 0;
    (void)threads; /* without OpenMP */
#pragma omp parallel for num_threads(threads) schedule(static)
    for (int k = 0; k < n; k++)
        smooth_place(d, p.corner + p.first[k], p.first[k + 1] - p.first[k], least);
    free_places(&p);
    return good;
}

/* Keep the normals of the file that have a direction, as unit vectors. Whether all have. */
static bool keep_given(mesh_data *d, mesh_normals normals)
{
    bool all = true;
    for (int k = 0; k < d->n; k++)
        for (int i = 0; i < 3; i++) {
            float *to = d->skin[k].normal[i];
            const vec3 n = mesh_get(to);
            const double length = vec3_length(n);
            const bool good = normals == MESH_NORMALS_FILE && length > SHORTEST && length < LONGEST;
            mesh_set(to, good ? vec3_scale(n, 1 / length) : (vec3){0, 0, 0});
            all &= good;
        }
    return all;
}

static void exchange(float *a, float *b, size_t bytes)
{
    float x[3];
    memcpy(x, a, bytes);
    memcpy(a, b, bytes);
    memcpy(b, x, bytes);
}

/* Where all three normals of a triangle are on its other side, the normals are right and the order of the corners is
 * wrong. */
static void flip_by_normals(mesh_data *d)
{
    for (int k = 0; k < d->n; k++) {
        const vec3 n = area_of(d->at[k]);
        mesh_skin *x = &d->skin[k];
        if (!(vec3_dot(n, mesh_get(x->normal[0])) < 0 && vec3_dot(n, mesh_get(x->normal[1])) < 0 &&
              vec3_dot(n, mesh_get(x->normal[2])) < 0))
            continue;
        exchange(d->at[k][1], d->at[k][2], sizeof d->at[k][1]);
        exchange(x->normal[1], x->normal[2], sizeof x->normal[1]);
        exchange(x->uv[1], x->uv[2], sizeof x->uv[1]);
        d->notes.turned++;
    }
}

/* No normal may face away from its triangle. Then those interpolated between them do not either. */
static void replace_averted(mesh_data *d)
{
    for (int k = 0; k < d->n; k++) {
        const vec3 n = vec3_unit(area_of(d->at[k]));
        for (int i = 0; i < 3; i++)
            if (!(vec3_dot(n, mesh_get(d->skin[k].normal[i])) >= FACING)) {
                mesh_set(d->skin[k].normal[i], n);
                d->notes.bent++;
            }
    }
}

bool mesh_clean(mesh_data *d, mesh_normals normals, double crease, double most, int threads, const progress *w,
                char why[MESH_WHY])
{
    if (!check_numbers(d, most, why))
        return false;
    d->notes = (mesh_notes){0};
    drop_flat(d);
    if (d->n == 0) {
        snprintf(why, MESH_WHY, "no triangles%s, expected at least one", d->notes.flat ? " with an area" : "");
        return false;
    }
    count_bare(d);
    const bool given = keep_given(d, normals);
    flip_by_normals(d);
    if (!given && normals != MESH_NORMALS_FLAT && !smooth(d, crease, threads_of(threads), progress_memory(w)))
        return mesh_refuse_memory(w, why);
    replace_averted(d);
    if (normals == MESH_NORMALS_FLAT) /* all were missing, not wrong */
        d->notes.bent = 0;
    return true;
}
