/* Adding up counts. */
#include "render/stats.h"

const char *const stage_names[STAGES] = {
    "camera", "hit", "sort", "surface", "bump", "normal", "shift", "place", "shadow", "shade", "film",
};

STAGE static int count_order(int n, const int32_t *order, int wanted)
{
    int same = 0;
    for (int i = 0; i < n; i++)
        same += order[i] == wanted;
    return same;
}

void stats_orders(stats *s, int n, const int32_t *order, int asked)
{
    const int same = count_order(n, order, asked);
    s->bumped += n;
    s->fell_back += asked == ORDER_ANY ? 0 : n - same;
    if (same == n)
        s->orders[asked + 1] += n;
    else
        for (int i = 0; i < n; i++)
            s->orders[order[i] + 1]++;
}

void stats_undefined(stats *s, int32_t object, long n)
{
    s->undefined += n;
    if (n > 0 && (s->undefined_object == 0 || object + 1 < s->undefined_object))
        s->undefined_object = object + 1;
}

void stats_add(stats *sum, const stats *part)
{
    sum->rays += part->rays;
    sum->shadow_rays += part->shadow_rays;
    sum->secondary_rays += part->secondary_rays;
    sum->evaluations += part->evaluations;
    sum->displaced.evaluations += part->displaced.evaluations;
    sum->displaced.uncertain += part->displaced.uncertain;
    sum->patches.evaluations += part->patches.evaluations;
    sum->patches.unsure += part->patches.unsure;
    sum->bumped += part->bumped;
    sum->fell_back += part->fell_back;
    stats_undefined(sum, part->undefined_object - 1, part->undefined);
    for (int k = 0; k < ORDER_CODES; k++)
        sum->orders[k] += part->orders[k];
    for (int k = 0; k < STAGES; k++)
        sum->seconds[k] += part->seconds[k];
}
