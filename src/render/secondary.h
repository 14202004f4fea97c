/* Secondary rays: mirrored, refracted, and straight on through what does not refract. Those of all of a wave's groups
 * are queued in waves of their own, which trace.c traces as it does the camera's; so waves stay full where groups are
 * small. Depth and memory are bounded.
 */
#ifndef KAGE_RENDER_SECONDARY_H
#define KAGE_RENDER_SECONDARY_H

#include "wave/wave.h"

enum {
    MEDIA = 8,      /* nested things that a ray keeps count of */
    STRAIGHTS = 256 /* unrefracted crossings in a row; light from beyond is not seen */
};

/* The objects that each ray has entered and not left, the innermost last. */
typedef struct media {
    int32_t n[LANES], id[MEDIA][LANES];
} media;

/* A wave of secondary rays. */
typedef struct ray_queue {
    int n;
    int32_t lane[LANES]; /* of the wave they come from, to whose light they add */
    vec3s weight;
    rays x; /* from the shifted place r + s t0 */
    ray_origins from;
    media in;
} ray_queue;

struct scene;
struct workspace;

/* No rays yet in the workspace's queues. */
void secondary_begin(struct workspace *v);

/* Queue the rays that go on from the group v->g, which has met object `id`. */
void secondary_send(const struct scene *s, int32_t id, struct workspace *v);

/* to += what a queue's rays have found, by their weights. */
void secondary_add(const ray_queue *q, const vec3s *from, vec3s *to);

/* Replace q by its unrefracted continuations; weights multiply. */
void secondary_go_on(const ray_queue *on, ray_queue *q);

#endif
