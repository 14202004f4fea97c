/* What a render counts and times. */
#ifndef KAGE_RENDER_STATS_H
#define KAGE_RENDER_STATS_H

#include "displaced/displaced.h"
#include "method/method.h"

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
    STAGE_SHADOW,
    STAGE_SHADE,
    STAGE_FILM,
    STAGES
};
extern const char *const stage_names[STAGES];

/* The parts of one thread are added up in the end. */
typedef struct stats {
    long rays, shadow_rays, evaluations; /* camera rays, shadow rays, evaluations of P outside searches */
    long secondary_rays;                 /* reflected, refracted, straight through */
    long orders[ORDER_CODES];            /* bumped samples by the order really used, from none on */
    displaced_counts displaced;          /* hits of displaced surfaces */
    long bumped, fell_back;              /* bumped samples, and those among them with another order than asked for */
    double seconds[STAGES];              /* in the tiles that were timed */
    bool timing;                         /* this tile is */
    double clock;                        /* when the last stage ended */
} stats;

/* A stage has ended: what has passed since the last call is its time. */
double stats_clock(void);
static inline void stats_stage(stats *s, enum stage k)
{
    if (s->timing) {
        double now = stats_clock();
        s->seconds[k] += now - s->clock;
        s->clock = now;
    }
}

void stats_orders(stats *s, int n, const int32_t *order, int asked);

void stats_add(stats *sum, const stats *part);

#endif
