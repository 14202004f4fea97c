/* The settings of a render (tracer), and the memory of one of its threads (workspace). It is allocated once, never
 * while tracing.
 */
#ifndef KAGE_RENDER_WORKSPACE_H
#define KAGE_RENDER_WORKSPACE_H

#include "base/pulse.h"
#include "displaced/displaced.h"
#include "patch/surface.h"
#include "render/samples.h"
#include "render/secondary.h"
#include "render/stats.h"
#include "scene/scene.h"
#include "wave/hit_group.h"

/* Shared by all threads; nothing changes it. */
typedef struct tracer {
    const scene *scene;
    method shadow;
    bool guard;   /* orders fall back where their result is outside the slab */
    bool shifted; /* shade at r + s t0 */
    bump_shadow bump_shadow;
    bool displaced;   /* rays meet the displaced surfaces of bumped objects; no method is used */
    bool self_shadow; /* bumped objects cast shadows, on themselves and on others */
    bool layers;      /* compute the layers, too */
} tracer;

typedef struct workspace workspace;
struct workspace {
    rays x;       /* the wave */
    hits nearest; /* its hits; -1 where a group has been taken out */
    hit_group g;  /* the current group */
    bool alone;   /* no other object can shadow it (auto.h) */
    samples out;
    real (*visibility)[LANES]; /* for each light of the scene; with layers only */

    /* secondary rays */
    const ray_queue *of; /* the queue that the rays x are from; NULL: camera rays */
    int left;            /* how many rays in a row may still follow */
    ray_queue reflected, refracted, straight;
    workspace *deeper; /* for this wave's secondary waves; NULL: none */

    /* shared by the workspaces of a thread */
    stats *stats;
    const surface **surface;       /* of each object: the smooth or the displaced one */
    displaced *displaced;          /* of each object that has one, with this thread's counts */
    patch_surface *patches;        /* of each object that is one, with this thread's counts */
    const pulse *pulse;            /* asked between the parts of a wave; NULL: none */
    struct candidates *candidates; /* with many objects (object_bvh.h); NULL: all objects are tested */
};

/* For tracers with the same scene and `displaced` as this one. NULL: out of memory. */
workspace *workspace_new(const tracer *tr, memory *m);
void workspace_free(workspace *v);

/* Ask p, which must outlive v, between the parts of a wave. Where it says stop, results are left as they are. */
void workspace_ask(workspace *v, const pulse *p, int objects);

#endif
