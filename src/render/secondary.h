/* Secondary rays: mirrored, refracted, and straight through surfaces that do not refract. The rays of all groups of a
 * wave are queued in new waves, which trace.c traces like the camera's. So waves stay full where groups are small.
 */
#ifndef KAGE_RENDER_SECONDARY_H
#define KAGE_RENDER_SECONDARY_H

#include "wave/wave.h"

enum {
    MEDIA = 8,      /* nested objects that a ray remembers */
    STRAIGHTS = 256 /* surfaces in a row without refraction; light from beyond is lost */
};

/* The objects that each ray is inside of, the innermost last. inside: object.inside, or of copies the copy's. */
typedef struct media {
    int32_t n[LANES], id[MEDIA][LANES], inside[MEDIA][LANES];
} media;

/* A wave of secondary rays. */
typedef struct ray_queue {
    int n;
    int32_t lane[LANES]; /* of the wave they come from, which gets their light */
    vec3s weight;        /* of their light there */
    rays x;              /* from the shifted place r + s t0 */
    ray_origins from;
    media in;
} ray_queue;

/* The share of light that comes through. A colour above 1 adds light at each surface; so much is enough, and times any
 * other colour it is within float's range. */
static inline real secondary_weight(real x) { return real_min(x, R(1e12)); }

struct scene;
struct workspace;

/* Empty the workspace's queues. */
void secondary_begin(struct workspace *v);

/* Queue the secondary rays of the group v->g on object `id`. */
void secondary_send(const struct scene *s, int32_t id, struct workspace *v);

/* Add the light `from` of a queue's rays, times their weights, to the lanes they come from. */
void secondary_add(const ray_queue *q, const vec3s *from, vec3s *to);

/* Replace q by its continuations `on`, which go straight through a surface; weights multiply. */
void secondary_go_on(const ray_queue *on, ray_queue *q);

#endif
