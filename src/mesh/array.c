/* A model in memory as triangles. As in files (import/assimp.c), z changes its sign and corners their order, since kage
 * is left-handed, and w = 1 - v.
 */
#include "mesh/mesh_data.h"

#include <stdio.h>
#include <stdlib.h>

static void put_vector(float to[3], const double from[3])
{
    to[0] = (float)from[0];
    to[1] = (float)from[1];
    to[2] = -(float)from[2];
}

static void put_corner(const mesh_array *a, size_t from, float at[3], float normal[3], float uv[2])
{
    static const double none[3] = {0, 0, 0};
    put_vector(at, a->positions + 3 * from);
    put_vector(normal, a->normals ? a->normals + 3 * from : none);
    uv[0] = a->uvs ? (float)a->uvs[2 * from] : NAN;
    uv[1] = a->uvs ? 1 - (float)a->uvs[2 * from + 1] : NAN;
}

bool mesh_refuse_memory(const progress *w, char why[MESH_WHY])
{
    char words[MEMORY_WORDS];
    snprintf(why, MESH_WHY, "%s", memory_words(progress_memory(w), words));
    return false;
}

bool mesh_count_is_good(int triangles, const progress *w, char why[MESH_WHY])
{
    const cap most = progress_limit(w, LIMIT_TRIANGLES, MESH_MOST);
    if (triangles >= 1 && triangles <= most.most)
        return true;
    snprintf(why, MESH_WHY, "%d triangles, expected 1 to %d%s", triangles, (int)most.most, most.by);
    return false;
}

bool mesh_array_read(const mesh_array *a, const progress *w, mesh_data *out, char why[MESH_WHY])
{
    const size_t n = (size_t)a->triangles;
    if (!mesh_count_is_good(a->triangles, w, why))
        return false;
    for (size_t k = 0; k < 3 * n; k++)
        if (a->corners[k] >= (uint32_t)a->vertices) {
            snprintf(why, MESH_WHY, "triangle %zu (from 0) has the vertex %lu, expected 0 to %d", k / 3,
                     (unsigned long)a->corners[k], a->vertices - 1);
            return false;
        }
    memory *m = progress_memory(w);
    *out = (mesh_data){
        .n = a->triangles, .at = memory_new(m, sizeof *out->at * n), .skin = memory_new(m, sizeof *out->skin * n)};
    if (!out->at || !out->skin) {
        mesh_data_free(out);
        return mesh_refuse_memory(w, why);
    }
    for (size_t k = 0; k < n; k++)
        for (size_t c = 0; c < 3; c++) {
            const size_t to = c ? 3 - c : 0;
            put_corner(a, a->corners[3 * k + c], out->at[k][to], out->skin[k].normal[to], out->skin[k].uv[to]);
        }
    return true;
}
