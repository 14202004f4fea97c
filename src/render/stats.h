/* Counts and times of a render. */
#ifndef KAGE_RENDER_STATS_H
#define KAGE_RENDER_STATS_H

#include "base/clock.h"
#include "displaced/displaced.h"
#include "method/method.h"
#include "patch/surface.h"

#include <stdbool.h>
#include <stdint.h>

enum stage {
    STAGE_CAMERA,
    STAGE_HIT,
    STAGE_SORT,
    STAGE_SURFACE,
    STAGE_BUMP,
    STAGE_NORMAL,
    STAGE_SHIFT,
    STAGE_PLACE,
    STAGE_SHADOW,
    STAGE_SHADE,
    STAGE_FILM,
    STAGES
};
extern const char *const stage_names[STAGES];

/* One for each thread; added up at the end. */
typedef struct stats {
    long rays, shadow_rays;     /* camera rays, shadow rays */
    long evaluations;           /* of P, without those in searches on displaced surfaces */
    long secondary_rays;        /* mirrored, refracted and straight through */
    long orders[ORDER_CODES];   /* bumped samples by the order really used: method_code + 1 */
    displaced_counts displaced; /* hits of displaced surfaces */
    patch_counts patches;       /* hits of smooth patches */
    long bumped, fell_back;     /* bumped samples; those with another order than asked for */
    long undefined;             /* samples where P, n', the shift or the light had no value */
    int32_t undefined_object;   /* the lowest object with such a sample, plus 1; 0: none */
    double seconds[STAGES];     /* in the tiles that are timed */
    bool timing;                /* this tile is timed */
    double clock;               /* when the last stage ended */
} stats;

/* Stage k has ended: add the time since the last call. */
static inline void stats_stage(stats *s, enum stage k)
{
    if (s->timing) {
        double now = clock_seconds();
        s->seconds[k] += now - s->clock;
        s->clock = now;
    }
}

/* Count n bumped samples by order; asked: the code of the method, or ORDER_ANY where no order is a fall back. */
enum { ORDER_ANY = -2 };
void stats_orders(stats *s, int n, const int32_t *order, int asked);

/* Count n samples without a value on an object. */
void stats_undefined(stats *s, int32_t object, long n);

void stats_add(stats *sum, const stats *part);

#endif
