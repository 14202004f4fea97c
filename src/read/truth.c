/* Surfaces that true displacement alone needs: transformed meshes and patches, and displaced ones. They are kept for
 * other scenes together with what they refer to.
 */
#include "displaced/displaced.h"
#include "mesh/mesh.h"
#include "patch/surface.h"
#include "read/parts.h"

#include <stdlib.h>

typedef struct made_surface {
    surface *f, *of;
    bump *P; /* NULL: not displaced */
} made_surface;

static void free_made(void *thing)
{
    made_surface *x = thing;
    surface_free(x->f);
    surface_free(x->of);
    bump_free(x->P);
    free(x);
}

static surface *found(reader *r, const char *key)
{
    const made_surface *x = reader_found(r, key);
    return x ? surface_share(x->f) : NULL;
}

/* Keep f, which was made of `of` and P. Returns f; NULL where it is, or with an error. */
static surface *keep(reader *r, const char *key, surface *f, surface *of, bump *P)
{
    made_surface *x = f ? reader_made(r, malloc(sizeof *x)) : NULL;
    if (!x) {
        surface_free(f);
        return NULL;
    }
    *x = (made_surface){surface_share(f), surface_share(of), P ? bump_share(P) : NULL};
    if (reader_keep(r, key, x, free_made))
        return f;
    surface_free(f);
    return NULL;
}

surface *reader_moved(reader *r, const object *o, const affine *m)
{
    char *key = reader_key(r, "moved %p %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g",
                           (const void *)o->own, m->x.x, m->x.y, m->x.z, m->y.x, m->y.y, m->y.z, m->z.x, m->z.y, m->z.z,
                           m->o.x, m->o.y, m->o.z);
    surface *f = found(r, key);
    if (!f && key)
        f = keep(r, key,
                 o->shape_spec.kind == SHAPE_MESH ? mesh_moved(o->own, m, r->from->threads, r->from->progress)
                                                  : patch_surface_affine(o->own, m, r->from->progress),
                 o->own, NULL);
    free(key);
    return f;
}

/* NULL: an error. */
static surface *make_displaced(reader *r, node *at, const object *o)
{
    bool bounded;
    surface *f = displaced_new(o->shape, o->bump, r->from->progress, &bounded);
    if (bounded)
        return reader_made(r, f);
    yaml_error(r->y, at, "the surface has no normal to displace it along, expected one with an area everywhere for %s",
               scene_truth_name(r->s));
    return NULL;
}

surface *reader_displaced(reader *r, node *at, const object *o)
{
    if (o->shape_spec.kind == SHAPE_CLOSED) /* takes no time */
        return make_displaced(r, at, o);
    char *key = reader_key(r, "displaced %p %p", (const void *)o->shape, (const void *)o->bump);
    surface *f = found(r, key);
    if (!f && key)
        f = keep(r, key, make_displaced(r, at, o), o->shape, o->bump);
    free(key);
    return f;
}
