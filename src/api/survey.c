/* kage_scene_survey: how steep the bumps are where the camera sees them, and warnings. */
#include "api/api.h"

#include "render/intersect.h"
#include "render/trace.h"
#include "wave/gather.h"
#include "wave/lane.h"

#include <stdlib.h>

#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION /* as all fuzzers define it: instrumented code is many times slower */
enum { SAMPLES = 8 };
#else
enum { SAMPLES = 200 }; /* SAMPLES x SAMPLES rays over the picture */
#endif
enum { MOST_WARNINGS = 8 }; /* of one object */

/* Above this slope (95th percentile) the orders get more than about 1.5 % of a cast shadow's pixels wrong
 * (docs/method.md, "Accuracy of the orders": 1.4 % at 0.58, 7 % and more at 1.14). */
#define SLOPE_BOUND 0.6

/* Warn where more samples than this fall back, in per cent: there an order loses to order 0. */
#define FALL_BACK_BOUND 10.0

/* Slopes (95th percentile) of bumps that are meant are between these; advised is SLOPE_MEANT. */
#define SLOPE_LEAST 0.01
#define SLOPE_MOST 4.0
#define SLOPE_MEANT 0.5

/* Warn of steps whose slope is more than this share of the map's own, in the median, and more than this slope, which
 * changes a shade by some 1/255. */
#define STEP_SHARE 0.25
#define STEP_SLOPE 0.004

/* What the rays have found on one object. */
typedef struct seen {
    /* Of each sample: the bump's slope, the shorter side of a map's cell in scene units, the distance from the eye. */
    float *slope, *cell, *distance;
    int n, room;
    long back[3]; /* samples where the orders 1 and 2 fell back */
    int none;     /* further samples, where P has no value */
} seen;

static int ascending(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* tan of the angle between the smooth and the perturbed normal: the slope of the bump in scene units. */
static float slope(const hit_group *g, int i)
{
    const bs_vec3 n = lane_unit(lane_get(&g->n_smooth, i)), np = lane_get(&g->n_bump, i), c = bs_cross(n, np);
    return (float)(real_sqrt(bs_dot(c, c)) / real_max(bs_dot(n, np), R(1e-30)));
}

/* The shorter side of the cell of the object's map that sample i is in, in scene units. 0: no map. */
static float cell(const object *o, const hit_group *g, int i)
{
    const map_layout *l = &o->bump_spec.layout;
    const bs_vec3 u = lane_get(&g->q.Qu, i), w = lane_get(&g->q.Qw, i);
    const double along = sqrt((double)bs_dot(u, u)) * l->size[0] / (o->map.width - l->corners),
                 down = sqrt((double)bs_dot(w, w)) * l->size[1] / (o->map.height - l->corners);
    return o->map.file ? (float)fmin(fabs(along), fabs(down)) : 0;
}

static bool make_room(float **list, int room)
{
    float *more = realloc(*list, sizeof *more * (size_t)room);
    *list = more ? more : *list;
    return more;
}

/* False: out of memory. */
static bool note_sample(seen *s, const object *o, const hit_group *g, int i)
{
    if (s->n == s->room) {
        const int room = s->room ? 2 * s->room : 64;
        if (!make_room(&s->slope, room) || !make_room(&s->cell, room) || !make_room(&s->distance, room))
            return false;
        s->room = room;
    }
    s->slope[s->n] = slope(g, i);
    s->distance[s->n] = (float)g->t[i];
    s->cell[s->n++] = cell(o, g, i);
    return true;
}

/* Trace the survey's rays by one order and count where it fell back. With order 2 also note the slopes. False: out of
 * memory. */
static bool look(const scene *s, int order, workspace *v, seen *all)
{
    const tracer k = {.scene = s, .shadow = {METHOD_ORDER, order}, .guard = true};
    for (int first = 0; first < SAMPLES * SAMPLES; first += LANES) {
        const int n = SAMPLES * SAMPLES - first < LANES ? SAMPLES * SAMPLES - first : LANES;
        for (int i = 0; i < n; i++)
            camera_ray(&s->camera, SAMPLES, SAMPLES, (first + i) % SAMPLES + 0.5, (double)((first + i) / SAMPLES) + 0.5,
                       &v->x, i);
        intersect_nearest(s, n, v);
        for (int32_t id; (id = gather_next_group(n, &v->x, &v->nearest, &v->g)) >= 0;) {
            const hit_group *g = &v->g;
            seen *o = &all[id];
            if (!s->object[id].bump)
                continue;
            trace_group(&k, id, v);
            for (int i = 0; i < g->n; i++) {
                if (g->bump.undefined && g->bump.none[i]) {
                    o->none += order == 2;
                    continue;
                }
                o->back[order] += g->order[i] != order;
                if (order == 2 && !note_sample(o, &s->object[id], g, i))
                    return false;
            }
        }
    }
    return true;
}

/* The step of a map, and its slope over two cells, as the differences are taken. */
static void find_step(const object *o, seen *x, kage_bump_survey *b)
{
    if (!o->map.file || o->map.bits == 0)
        return;
    qsort(x->cell, (size_t)x->n, sizeof *x->cell, ascending);
    const double side = (double)x->cell[x->n / 2];
    b->step = fabs(o->bump_spec.layout.scale) / (double)((1 << o->map.bits) - 1);
    b->step_slope = side > 0 ? b->step / (2 * side) : 0;
}

static kage_bump_survey summary(const object *o, seen *x)
{
    kage_bump_survey b = {.samples = x->n + x->none};
    if (x->none)
        b.undefined = 100.0 * x->none / b.samples;
    if (!x->n)
        return b;
    find_step(o, x, &b);
    qsort(x->slope, (size_t)x->n, sizeof *x->slope, ascending);
    qsort(x->distance, (size_t)x->n, sizeof *x->distance, ascending);
    b.distance = (double)x->distance[x->n / 2];
    b.slope_median = (double)x->slope[x->n / 2];
    b.slope_95 = (double)x->slope[(int)(0.95 * x->n)];
    b.slope_max = (double)x->slope[x->n - 1];
    for (int k = 1; k <= 2; k++)
        b.fell_back[k] = 100.0 * (double)x->back[k] / x->n;
    return b;
}

static void warn(kage_warning *w, int *n, kage_warning_code code, int id, double value, double bound)
{
    w[(*n)++] = (kage_warning){code, id, value, bound};
}

/* Whether the scale, and what lies at height 0, can be meant. */
static void warn_of_heights(const kage_object_info *o, const kage_bump_survey *b, int id, kage_warning *w, int *n)
{
    const double low = o->height[0], high = o->height[1], half = (high - low) / 2;
    const double off = low > 0 ? low : high < 0 ? -high : 0; /* all of P is so far above the surface, or below it */
    if (b->slope_95 > SLOPE_MOST || (b->slope_95 > 0 && b->slope_95 < SLOPE_LEAST))
        warn(w, n, KAGE_WARN_SCALE, id, o->bump_scale * SLOPE_MEANT / b->slope_95,
             b->slope_95 > SLOPE_MOST ? SLOPE_MOST : SLOPE_LEAST);
    if (o->bounded && off > half)
        warn(w, n, KAGE_WARN_ZERO, id, o->map ? (o->map_range[0] + o->map_range[1]) / 2 : (low + high) / 2, half);
}

/* Of orders 1, 2 and 2+ the share that falls back is known. */
static void warn_of_method(const scene *s, const kage_bump_survey *b, int id, kage_warning *w, int *n)
{
    if (s->shadow.kind != METHOD_ORDER || s->displaced)
        return;
    const double back = b->fell_back[s->shadow.n < 2 ? s->shadow.n : 2];
    if (b->slope_95 > SLOPE_BOUND)
        warn(w, n, KAGE_WARN_STEEP, id, b->slope_95, SLOPE_BOUND);
    if (back > FALL_BACK_BOUND)
        warn(w, n, KAGE_WARN_FALLS_BACK, id, back, FALL_BACK_BOUND);
}

static void warn_of(const kage_scene *k, const kage_bump_survey *b, int id, kage_warning *w, int *n)
{
    const kage_object_info *o = &k->info.objects[id];
    const double least = fmax(STEP_SLOPE, STEP_SHARE * b->slope_median);
    if (o->model && o->model->flat)
        warn(w, n, KAGE_WARN_FLAT_TRIANGLES, id, o->model->flat, 0);
    if (o->bump && !o->bounded)
        warn(w, n, KAGE_WARN_UNBOUNDED, id, 0, 0);
    if (b->undefined > 0)
        warn(w, n, KAGE_WARN_UNDEFINED, id, b->undefined, 0);
    if (o->bump)
        warn_of_heights(o, b, id, w, n);
    warn_of_method(k->first, b, id, w, n);
    if (b->step_slope > least && o->map_smooth <= 0)
        warn(w, n, KAGE_WARN_STEPS, id, b->step_slope, least);
}

/* The survey and what it points to, in one piece of memory: the survey, one bump survey an object, the warnings. */
static kage_survey *report(const kage_scene *k, seen *all)
{
    const size_t objects = (size_t)k->info.object_count;
    kage_survey *v =
        malloc(sizeof *v + (objects + 1) * (sizeof(kage_bump_survey) + MOST_WARNINGS * sizeof(kage_warning)));
    if (!v)
        return NULL;
    kage_bump_survey *b = (kage_bump_survey *)(void *)(v + 1);
    kage_warning *w = (kage_warning *)(void *)(b + objects + 1);
    *v = (kage_survey){.objects = b, .warnings = w};
    for (int i = 0; i < k->info.object_count; i++) {
        b[i] = summary(&k->first->object[i], &all[i]);
        warn_of(k, &b[i], i, w, &v->warning_count);
    }
    return v;
}

kage_status kage_scene_survey(kage_scene *k, kage_survey **out, kage_errors **to)
{
    const scene *s = k->first;
    memory m = {.from = k->allowed.budget, .limit = k->allowed.most};
    char words[MEMORY_WORDS];
    workspace *v = workspace_new(&(tracer){.scene = s}, &m);
    seen *all = calloc((size_t)s->objects + 1, sizeof *all);
    *out = NULL;
    if (to)
        *to = NULL;
    if (v && all && look(s, 1, v, all) && look(s, 2, v, all))
        *out = report(k, all);
    for (int i = 0; all && i < s->objects; i++) {
        free(all[i].slope);
        free(all[i].cell);
        free(all[i].distance);
    }
    free(all);
    workspace_free(v);
    return *out ? KAGE_OK : error_give(KAGE_NO_MEMORY, to, "%s", memory_words(&m, words));
}

void kage_survey_free(kage_survey *v) { free(v); }
