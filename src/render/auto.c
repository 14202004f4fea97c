/* Each lane's true place is in a bracket on its viewing ray (method/bracket.h). Where each light sees the whole bracket
 * alike (sweep.h), the place within does not matter, and order 0's is kept. For the other lanes it is found.
 */
#include "render/auto.h"

#include "light/lighting.h"
#include "method/bracket.h"
#include "render/sweep.h"
#include "wave/lane.h"

/* ---- how large an error is on the screen ---- */

/* The size of a pixel is fixed + spread t, in scene units. Secondary rays have a pixel of their own length, which is
 * less than that of the whole way, so their places are better than they need be. */
typedef struct pixel_size {
    real fixed, spread;
} pixel_size;

static pixel_size pixel_of(const scene *s)
{
    const real size = (real)(2 * vec3_length(s->camera.right) / s->width);
    return s->camera.orthographic ? (pixel_size){size, 0} : (pixel_size){0, size};
}

/* pixels = the larger of itself and what an error of 1 in tau moves a shadow of this light. */
STAGE static void measure_shadow(int n, const rays *restrict x, const real *restrict t, const rays *restrict to_light,
                                 pixel_size size, real *restrict pixels)
{
    for (int i = 0; i < n; i++) {
        bs_vec3 s = lane_get(&x->s, i), d = lane_get(&to_light->s, i);
        pixels[i] = real_max(pixels[i], bs_pixels(s, d, size.fixed + size.spread * t[i], 1));
    }
}

/* pixels = what an error of 1 in tau moves the place itself: |s|. */
STAGE static void measure_place(int n, const rays *restrict x, const real *restrict t, pixel_size size,
                                real *restrict pixels)
{
    for (int i = 0; i < n; i++) {
        bs_vec3 s = lane_get(&x->s, i);
        pixels[i] = real_sqrt(bs_dot(s, s)) / (size.fixed + size.spread * t[i]);
    }
}

static void measure(const scene *s, bool everywhere, places *p)
{
    const int n = p->k.n;
    rays to_light;
    if (everywhere)
        measure_place(n, &p->x, p->t, pixel_of(s), p->pixels);
    for (int l = 0; !everywhere && l < s->lights; l++) {
        lighting_rays(&s->light[l], n, &p->x, p->t, &to_light);
        measure_shadow(n, &p->x, p->t, &to_light, pixel_of(s), p->pixels);
    }
}

/* ---- the method ---- */

/* Whether more than shadows of other objects depends on the place: what is shaded there, or the rays that leave from
 * it. */
static bool needs_place(const tracer *tr, int32_t id, const workspace *v)
{
    const scene *s = tr->scene;
    return tr->shifted || (v->left > 0 && material_sends(&s->material[s->object[id].material]));
}

/* Where only a shadow depends on the place, few lanes are searched, and all the better. The lengths are in errors. */
static search_steps steps_of(bool everywhere, real error)
{
    return everywhere ? (search_steps){48 * error, 1, 16} : (search_steps){16 * error, 6, 16};
}

static int all_lanes(int n, int32_t *lane)
{
    for (int i = 0; i < n; i++)
        lane[i] = i;
    return n;
}

void auto_shift(const tracer *tr, int32_t id, workspace *v)
{
    const bump *P = tr->scene->object[id].bump;
    const real error = (real)tr->shadow.n / METHOD_PIXEL;
    const bool everywhere = needs_place(tr, id, v);
    hit_group *g = &v->g;
    brackets k;
    places p;
    int32_t lane[LANES];
    bracket_begin(g, P, v->surface[id]->ops->flat, &k);
    if (!bump_is_bounded(P)) {
        v->stats->fell_back += g->n;
        return;
    }
    const int n = everywhere ? all_lanes(g->n, lane) : sweep_lights(tr, id, v, &k, lane);
    if (n == 0)
        return;
    places_pick(g, &k, n, lane, &p);
    measure(tr->scene, everywhere, &p);
    v->stats->evaluations += places_search(&p, P, error, steps_of(everywhere, error));
    places_put(&p, g);
}
