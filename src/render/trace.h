/* The algorithm: one wave of rays from the eye to the light. */
#ifndef KAGE_RENDER_TRACE_H
#define KAGE_RENDER_TRACE_H

#include "wave/hit_group.h"
#include "scene/scene.h"
#include "render/secondary.h"
#include "render/stats.h"

/* What the waves of a picture have in common. */
typedef struct tracer {
    const scene *scene;
    method shadow;
    bool guard;
    bool displaced;   /* bumped objects are met, and shaded, where their displaced surface is; the method is not used */
    bool self_shadow; /* bumped objects cast shadows too, on themselves and on others */
    bool layers;      /* also the layers beside the picture */
} tracer;

/* What a wave finds out for each of its lanes. The layers are those of film.h. */
typedef struct samples {
    vec3s rgb;
    real depth[LANES]; /* t of the hit, infinite where there is none; all that follows is 0 there, order -1 */
    vec3s position, normal;
    real u[LANES], w[LANES], height[LANES], tau[LANES];
    int32_t order[LANES];
} samples;

/* The memory that one thread traces with. */
typedef struct workspace {
    rays x; /* the wave */
    hits h;
    hit_group g;
    samples out;
    real (*visibility)[LANES]; /* for each light of the scene */
    stats stats;
    struct candidates
        *candidates; /* of a scene with many objects (crowd.h); else NULL; shared by the chain of workspaces */

    /* secondary rays (secondary.h) */
    const ray_queue *of; /* what the rays x are; NULL: the camera's */
    int left;            /* how many rays may still follow these */
    ray_queue reflected, refracted, straight;
    struct workspace *deeper; /* for the waves that follow this one; NULL: none does */
} workspace;

/* Trace the rays v->x of n lanes into v->out and, where asked for, v->visibility. */
void trace(const tracer *k, int n, workspace *v);

/* The first part: find where the rays v->x of n lanes meet the surfaces, and take the first group of lanes out.
 * Returns the object that they have met, -1: none. */
int32_t trace_nearest(const tracer *k, int n, workspace *v);

/* The second part, for one group: the group v->g, whose lanes have met the object `id`, from its x
 * and t to its rgb, without secondary rays. visibility: as above, by lanes of the group. The parts are
 * for those who look at the steps (kage pixel, kage check). */
void trace_group(const tracer *k, int id, workspace *v);

/* The nearest hits with object `id`, smooth or rough as it is taken, into h. from: of rays that have left a surface, or
 * NULL. */
void trace_hit(const tracer *k, int32_t id, int n, const rays *x, const ray_origins *from, hits *h, stats *st);

#endif
