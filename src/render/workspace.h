/* What the waves of a picture have in common (tracer), and the memory that one thread traces them with (workspace). It
 * is allocated once; while tracing nothing is.
 */
#ifndef KAGE_RENDER_WORKSPACE_H
#define KAGE_RENDER_WORKSPACE_H

#include "displaced/displaced.h"
#include "render/samples.h"
#include "render/secondary.h"
#include "render/stats.h"
#include "scene/scene.h"
#include "wave/hit_group.h"

/* What is traced, and how. */
typedef struct tracer {
    const scene *scene;
    method shadow;
    bool guard;       /* orders fall back where their result is outside the slab */
    bool displaced;   /* rays meet the displaced surfaces of bumped objects, in place of the method */
    bool self_shadow; /* bumped objects cast shadows too, on themselves and on others */
    bool layers;      /* also the layers beside the picture */
} tracer;

typedef struct workspace workspace;
struct workspace {
    rays x;       /* the wave, */
    hits nearest; /* what its rays meet; the ids of groups that are taken out become -1 */
    hit_group g;  /* the group at hand */
    samples out;
    real (*visibility)[LANES]; /* for each light of the scene, where layers are asked for */

    /* secondary rays */
    const ray_queue *of; /* what the rays x are; NULL: the camera's */
    int left;            /* how many rays may still follow these */
    ray_queue reflected, refracted, straight;
    workspace *deeper; /* for the waves that follow this one; NULL: none does */

    /* Shared by the workspaces of a thread. */
    stats *stats;
    const surface **surface;       /* of each object, as rays meet it: smooth or displaced */
    displaced *displaced;          /* of each object that has one, with this thread's counts */
    struct candidates *candidates; /* of a scene with many objects (object_bvh.h); NULL: all are tried */
};

/* For tracers of this scene that are `displaced` or not as this one. NULL: out of memory. */
workspace *workspace_new(const tracer *tr);
void workspace_free(workspace *v);

#endif
