/* A thread's memory: a workspace for the camera's waves, and a chain of others for secondary waves. */
#include "render/workspace.h"

#include <stdlib.h>

#include "scene/object_bvh.h"

static workspace *chain_new(int lights, int deeper, memory *m)
{
    workspace *v = memory_zeroed(m, sizeof *v);
    if (!v)
        return NULL;
    v->visibility = memory_new(m, (size_t)(lights ? lights : 1) * sizeof *v->visibility);
    v->deeper = v->visibility && deeper ? chain_new(0, deeper - 1, m) : NULL;
    if (v->visibility && (!deeper || v->deeper))
        return v;
    workspace_free(v);
    return NULL;
}

/* The surface of each object: smooth or displaced. */
static void choose_surfaces(const tracer *tr, workspace *v)
{
    for (int k = 0; k < tr->scene->objects; k++) {
        const object *o = &tr->scene->object[k];
        if (o->displaced)
            v->displaced[k] = displaced_counting(o->displaced, &v->stats->displaced);
        if (patch_surface_is(o->shape))
            v->patches[k] = patch_surface_counting(o->shape, &v->stats->patches);
        v->surface[k] = tr->displaced && o->displaced ? &v->displaced[k].base
                        : patch_surface_is(o->shape)  ? &v->patches[k].base
                                                      : o->shape;
    }
}

workspace *workspace_new(const tracer *tr, memory *m)
{
    const scene *s = tr->scene;
    const size_t objects = (size_t)(s->objects ? s->objects : 1);
    /* depth - 1 levels of secondary rays, and one for rays straight through from a camera's wave */
    workspace *v = chain_new(s->lights, s->sends && s->depth > 1 ? s->depth : 0, m);
    if (!v)
        return NULL;
    v->left = s->depth - 1;
    v->stats = calloc(1, sizeof *v->stats);
    v->surface = memory_new(m, objects * sizeof *v->surface);
    v->displaced = memory_new(m, objects * sizeof *v->displaced);
    v->patches = memory_new(m, objects * sizeof *v->patches);
    v->candidates = s->object_bvh ? candidates_new(s->object_bvh, m) : NULL;
    if (!v->stats || !v->surface || !v->displaced || !v->patches || (s->object_bvh && !v->candidates)) {
        workspace_free(v);
        return NULL;
    }
    choose_surfaces(tr, v);
    for (workspace *w = v->deeper; w; w = w->deeper) {
        w->stats = v->stats;
        w->surface = v->surface;
        w->displaced = v->displaced;
        w->patches = v->patches;
        w->candidates = v->candidates;
    }
    return v;
}

void workspace_ask(workspace *v, const pulse *p, int objects)
{
    for (int k = 0; k < objects; k++)
        v->displaced[k].pulse = p;
    for (; v; v = v->deeper)
        v->pulse = p;
}

void workspace_free(workspace *v)
{
    if (v) {
        candidates_free(v->candidates);
        memory_free(v->patches);
        memory_free(v->displaced);
        memory_free(v->surface);
        free(v->stats);
    }
    while (v) {
        workspace *next = v->deeper;
        memory_free(v->visibility);
        memory_free(v);
        v = next;
    }
}
