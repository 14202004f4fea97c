/* Secondary rays: mirrored, refracted, and straight on through what does not refract. Those of a wave's lanes are
 * gathered, side by side, in waves of their own, that are traced as the camera's are, in the next workspace; so waves
 * are full where their parents' groups are not. How far this goes is bounded, and so is the memory, which each thread
 * has from the start.
 */
#ifndef KAGE_RENDER_SECONDARY_H
#define KAGE_RENDER_SECONDARY_H

#include "wave/wave.h"

enum {
    MEDIA = 8,      /* things within one another, of which a ray knows */
    STRAIGHTS = 256 /* surfaces in a row that a ray passes straight on */
};

/* What each ray is in: the objects that it has entered and not left, the innermost last. */
typedef struct media {
    int32_t n[LANES], id[MEDIA][LANES];
} media;

/* A wave of secondary rays. */
typedef struct ray_queue {
    int n;
    int32_t lane[LANES]; /* in the wave to whose light they add, */
    vec3s weight;        /* with this weight */
    rays x;              /* from the shifted place r + s t0 */
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
