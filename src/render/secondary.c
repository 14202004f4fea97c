/* Directions, media and weights of a group's secondary rays, as in POV-Ray. */
#include "render/secondary.h"

#include <string.h>

#include "wave/lane.h"
#include "render/workspace.h"

void secondary_begin(workspace *v) { v->reflected.n = v->refracted.n = v->straight.n = 0; }

/* ---- directions ---- */

/* The directions and weights of a group's secondary rays. */
typedef struct ways {
    vec3s mirrored;       /* as long as s */
    vec3s bent;           /* refracted, unit */
    real ratio[LANES];    /* of the iors before and behind the surface; 1: no refraction */
    int32_t total[LANES]; /* total reflection */
    vec3s through;        /* the weight of refracted rays */
} ways;

/* d reflected at the plane across n. */
static inline bs_vec3 reflected(bs_vec3 d, bs_vec3 n)
{
    real k = 2 * bs_dot(d, n) / bs_dot(n, n);
    bs_vec3 x = {d.x - k * n.x, d.y - k * n.y, d.z - k * n.z};
    return x;
}

/* s mirrored at n'. A direction below the smooth surface is reflected at that; where n' faces away from the viewer, s
 * is mirrored at the smooth normal. Both as in POV-Ray. */
static inline bs_vec3 mirrored(bs_vec3 s, bs_vec3 smooth, bs_vec3 bumped)
{
    bs_vec3 d = reflected(s, bumped), again, plain = reflected(s, smooth);
    real side = bs_dot(s, smooth), below = side * bs_dot(d, smooth), away = side * bs_dot(s, bumped);
    again = reflected(d, smooth);
    again.x = away < 0 ? plain.x : again.x;
    again.y = away < 0 ? plain.y : again.y;
    again.z = away < 0 ? plain.z : again.z;
    d.x = below > 0 ? again.x : d.x;
    d.y = below > 0 ? again.y : d.y;
    d.z = below > 0 ? again.z : d.z;
    return d;
}

STAGE static void mirror(const hit_group *restrict g, ways *restrict y)
{
    for (int i = 0; i < g->n; i++)
        lane_set(&y->mirrored, i, mirrored(lane_get(&g->x->s, i), lane_get(&g->n_smooth, i), lane_get(&g->n_bump, i)));
}

/* Snell's law with n' on the viewer's side. A direction that stays on that side of the smooth surface is reflected at
 * it.
 */
STAGE static void bend(const hit_group *restrict g, ways *restrict y)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 s = lane_unit(lane_get(&g->x->s, i)), n = lane_get(&g->n_bump, i), smooth = lane_get(&g->n_smooth, i);
        real ratio = y->ratio[i], c = -bs_dot(s, n), k = 1 + ratio * ratio * (c * c - 1),
             root = real_sqrt(real_max(k, 0));
        real by = ratio * c - (c < 0 ? -root : root);
        bs_vec3 d = {ratio * s.x + by * n.x, ratio * s.y + by * n.y, ratio * s.z + by * n.z},
                over = reflected(d, smooth);
        int back = bs_dot(s, smooth) * bs_dot(d, smooth) < 0;
        y->bent.x[i] = back ? over.x : d.x;
        y->bent.y[i] = back ? over.y : d.y;
        y->bent.z[i] = back ? over.z : d.z;
        y->total[i] = k < 0;
    }
}

/* ---- the media that a ray is in ---- */

/* The number among all insides of what lane i of a group on object `id` meets. */
static int32_t inside_of(const scene *sc, int32_t id, const hit_group *g, int i)
{
    const object *o = &sc->object[id];
    return o->inside + (o->crowd ? crowd_copy_of(o->crowd, g->part[i]) : 0);
}

/* The place of an inside in lane i's list, or -1. */
static int find(const media *m, int i, int32_t inside)
{
    int at = m->n[i] - 1;
    while (at >= 0 && m->inside[at][i] != inside)
        at--;
    return at;
}

static double ior_of(const scene *sc, int id) { return sc->material[sc->object[id].material].ior; }

/* The ior of the innermost medium of lane i. */
static double ior_in(const scene *sc, const media *m, int i) { return m->n[i] ? ior_of(sc, m->id[m->n[i] - 1][i]) : 1; }

/* Lane i enters object `id`, whose inside has this number, or leaves it (out). Returns the ratio of the iors before and
 * behind. Where objects overlap, the ior is that of the one entered last, as in POV-Ray. */
static double cross(const scene *sc, int id, int32_t inside, bool out, media *in, int i)
{
    const double own = ior_of(sc, id), around = ior_in(sc, in, i);
    if (!shape_has_inside(&sc->object[id].shape_spec))
        return 1;
    if (!out) {
        if (in->n[i] < MEDIA) {
            in->inside[in->n[i]][i] = inside;
            in->id[in->n[i]++][i] = id;
        }
        return around / own;
    }
    int at = find(in, i, inside);
    if (at >= 0) {
        const int last = --in->n[i];
        if (at < last) {
            for (; at < last; at++) {
                in->id[at][i] = in->id[at + 1][i];
                in->inside[at][i] = in->inside[at + 1][i];
            }
            return 1;
        }
    }
    return own / ior_in(sc, in, i);
}

static void copy_media(const media *from, int j, media *to, int i)
{
    to->n[i] = from ? from->n[j] : 0;
    for (int k = 0; k < to->n[i]; k++) {
        to->id[k][i] = from->id[k][j];
        to->inside[k][i] = from->inside[k][j];
    }
}

/* ---- sending ---- */

static bs_vec3 weight_of(vec3 w)
{
    bs_vec3 x = {(real)w.x, (real)w.y, (real)w.z};
    return x;
}

static bool is_zero(bs_vec3 w) { return !(w.x > 0 || w.y > 0 || w.z > 0); }

/* Queue a ray from lane i in direction s, in the media of lane j of `in`. Other objects see it start at r + s t0, the
 * shifted place; its own surface at the smooth hit. */
static void send(const hit_group *g, int i, int id, real t0, bs_vec3 s, bs_vec3 weight, const media *in, int j,
                 ray_queue *b)
{
    const int to = b->n++;
    b->lane[to] = hit_group_place(g, i);
    lane_set(&b->weight, to, weight);
    lane_set(&b->x.r, to, lane_at(g->x, i, t0));
    lane_set(&b->x.s, to, s);
    b->from.id[to] = id;
    b->from.part[to] = g->part[i];
    lane_set(&b->from.at, to, lane_at(g->x, i, g->t[i]));
    copy_media(in, j, &b->in, to);
}

STAGE static void through_pattern(const hit_group *restrict g, real filter, real transmit, vec3s *restrict w)
{
    for (int i = 0; i < g->n; i++) {
        w->x[i] = g->color.x[i] * filter + transmit;
        w->y[i] = g->color.y[i] * filter + transmit;
        w->z[i] = g->color.z[i] * filter + transmit;
    }
}

static void send_clear(const scene *sc, int32_t id, workspace *v, ways *y)
{
    const material *m = &sc->material[sc->object[id].material];
    const hit_group *g = &v->g;
    const bs_vec3 mirror_weight = weight_of(m->reflection), one = {1, 1, 1};
    const media *before = v->of ? &v->of->in : NULL;
    media in;
    for (int i = 0; i < g->n; i++) {
        copy_media(before, hit_group_place(g, i), &in, i);
        /* an object that was entered is left, as in POV-Ray, also at a gap between displaced parts; an object that
         * contains the camera is left without having been entered */
        const int32_t inside = inside_of(sc, id, g, i);
        bool out = find(&in, i, inside) >= 0 || bs_dot(lane_get(&g->x->s, i), lane_get(&g->n_smooth, i)) > 0;
        y->ratio[i] = (real)cross(sc, id, inside, out, &in, i);
    }
    bend(g, y);
    if (m->pattern)
        through_pattern(g, (real)m->filter, (real)m->transmit, &y->through);
    else
        vec3s_fill(&y->through, g->n, (real)(m->color.x * m->filter + m->transmit),
                   (real)(m->color.y * m->filter + m->transmit), (real)(m->color.z * m->filter + m->transmit));
    for (int i = 0; i < g->n; i++) {
        bs_vec3 through = lane_get(&y->through, i);
        const bool total = y->ratio[i] != 1 && y->total[i] && !is_zero(through);
        if (total)
            send(g, i, id, g->t0[i], lane_get(&y->mirrored, i), one, before, hit_group_place(g, i), &v->refracted);
        else if (is_zero(through))
            ;
        else if (y->ratio[i] == 1) /* the same ray: from the smooth hit, as all before that was tested */
            send(g, i, id, g->t[i], lane_get(&g->x->s, i), through, &in, i, &v->straight);
        else
            send(g, i, id, g->t0[i], lane_get(&y->bent, i), through, &in, i, &v->refracted);
        if (!total && !is_zero(mirror_weight))
            send(g, i, id, g->t0[i], lane_get(&y->mirrored, i), mirror_weight, before, hit_group_place(g, i),
                 &v->reflected);
    }
}

void secondary_send(const scene *s, int32_t id, workspace *v)
{
    const material *m = &s->material[s->object[id].material];
    const hit_group *g = &v->g;
    ways y;
    if (v->left == 0 || !material_sends(m))
        return;
    mirror(g, &y);
    if (material_clear(m)) {
        send_clear(s, id, v, &y);
        return;
    }
    for (int i = 0; i < g->n; i++)
        send(g, i, id, g->t0[i], lane_get(&y.mirrored, i), weight_of(m->reflection), v->of ? &v->of->in : NULL,
             hit_group_place(g, i), &v->reflected);
}

void secondary_add(const ray_queue *q, const vec3s *from, vec3s *to)
{
    for (int i = 0; i < q->n; i++) {
        const int at = q->lane[i];
        to->x[at] += q->weight.x[i] * from->x[i];
        to->y[at] += q->weight.y[i] * from->y[i];
        to->z[at] += q->weight.z[i] * from->z[i];
    }
}

void secondary_go_on(const ray_queue *on, ray_queue *q)
{
    int32_t lane[LANES];
    vec3s weight;
    for (int i = 0; i < on->n; i++) {
        bs_vec3 w = lane_get(&on->weight, i), before = lane_get(&q->weight, on->lane[i]);
        bs_vec3 both = {secondary_weight(w.x * before.x), secondary_weight(w.y * before.y),
                        secondary_weight(w.z * before.z)};
        lane[i] = q->lane[on->lane[i]];
        lane_set(&weight, i, both);
    }
    *q = *on;
    memcpy(q->lane, lane, (size_t)on->n * sizeof *lane);
    memcpy(&q->weight, &weight, sizeof weight);
}
