/* Frees a scene. */
#include "scene/scene.h"

#include "scene/horizons.h"
#include "scene/object_bvh.h"

#include <stdlib.h>

void scene_free(scene *s)
{
    if (!s)
        return;
    horizons_free(s->horizons);
    object_bvh_free(s->object_bvh);
    for (int i = 0; i < s->lights; i++)
        free(s->light[i].name);
    for (int i = 0; i < s->materials; i++) {
        free(s->material[i].name);
        free(s->material[i].file);
        texels_free(s->material[i].texels);
    }
    for (int i = 0; i < s->kept; i++) {
        object *o = &s->object[i];
        free(o->name);
        surface_free(o->displaced);
        if (o->shape != o->own && o->first == i)
            surface_free(o->shape);
        surface_free(o->centred);
        if (!o->copy_of) {
            surface_free(o->own);
            free(o->shape_spec.file);
        }
        color_texture_free(o->color);
        if (o->shares_bump)
            continue;
        bump_free(o->bump);
        free(o->bump_spec.function);
        free(o->map.file);
    }
    free(s->light);
    free(s->material);
    free(s->object);
    files_free(&s->made_from);
    shelf_free(&s->shelf);
    free(s->path);
    free(s->source);
    free(s);
}
