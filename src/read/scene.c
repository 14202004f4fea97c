/* Reads a YAML file (docs/scene.md) into a scene. The reader checks every value, so the tracer need not; every error
 * has its place in the file.
 */
#include "read/parts.h"
#include "scene/horizons.h"
#include "scene/object_bvh.h"

#include <stdlib.h>

/* Note whether any object mirrors or refracts, or is transparent. Then the depth counts, also where the scene does not
 * say it. False with an error. */
static bool note_secondary(reader *r)
{
    scene *s = r->s;
    const cap most = reader_limit(r, LIMIT_DEPTH, SCENE_MAX_DEPTH);
    node *root = yaml_root(r->y), *render = yaml_get(root, "render");
    for (int k = 0; k < s->objects; k++) {
        const material *m = &s->material[s->object[k].material];
        s->sends |= material_sends(m);
        s->clear |= material_clear(m);
    }
    return !(s->sends || s->clear) || s->depth <= most.most ||
           yaml_error(r->y, render ? render : root, "no depth, which is then %d rays in a row, expected at most %d%s",
                      s->depth, (int)most.most, most.by);
}

scene *scene_read(const scene_source *from, errors *e)
{
    reader r = {.e = e, .from = from, .s = calloc(1, sizeof *r.s)};
    int before = e->count;
    r.y = r.s ? yaml_open(from->path, from->text, from->size, from->sets, from->set, "image render",
                          progress_limits(from->progress), e)
              : NULL;
    if (r.y) {
        r.s->path = reader_copy(&r, from->path);
        if (!from->text && !files_add_path(&r.s->made_from, from->path))
            reader_made(&r, NULL);
        r.s->source = reader_copy(&r, yaml_source(r.y));
        if (r.s->path) {
            yaml_map(r.y, yaml_root(r.y), "the scene", "camera image render lights materials objects");
            reader_view(&r);
            reader_lights(&r);
            reader_materials(&r);
            reader_objects(&r);
            if (e->count == before && note_secondary(&r)) {
                bool good = true;
                r.s->object_bvh = object_bvh_new(r.s, from->threads, from->progress, &good);
                if (scene_wants_horizons(r.s) && !from->survey)
                    good = (r.s->horizons = horizons_new(r.s, from->threads, from->progress)) && good;
                if (!good)
                    reader_made(&r, NULL);
            }
        }
        yaml_close(r.y);
    }
    free(r.model_path);
    mesh_data_free(&r.model);
    if (!r.y && e->count == before)
        errors_add(e, "%s: out of memory", from->path);
    if (e->count == before)
        return r.s;
    scene_free(r.s);
    return NULL;
}
