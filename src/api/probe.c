/* kage_scene_probe: every value that the stages compute for one ray, by each method. */
#include "api/api.h"

#include "render/intersect.h"
#include "render/trace.h"
#include "wave/gather.h"
#include "wave/lane.h"

#include <stdlib.h>
#include <string.h>

/* The methods that are compared; those of order 1 and above also without the guard. */
static const char *const names[] = {"none",   "0",       "1",       "2",       "2+",      "iter:2",
                                    "iter:4", "march:2", "march:4", "march:8", "march:16"};
enum { NAMES = sizeof names / sizeof *names, ROWS = 2 * NAMES };

/* The probe and what it points to, in one piece of memory. */
typedef struct block {
    kage_probe probe;
    kage_probe_row row[ROWS];
    double visible[];
} block;

static void set3(double to[3], bs_vec3 v)
{
    to[0] = (double)v.x;
    to[1] = (double)v.y;
    to[2] = (double)v.z;
}

static void set_surface(kage_probe *p, const hit_group *g)
{
    p->t = (double)g->t[0];
    p->u = (double)g->u[0];
    p->w = (double)g->w[0];
    set3(p->Q, lane_get(&g->q.Q, 0));
    set3(p->Qu, lane_get(&g->q.Qu, 0));
    set3(p->Qw, lane_get(&g->q.Qw, 0));
    set3(p->Quu, lane_get(&g->q.Quu, 0));
    set3(p->Quw, lane_get(&g->q.Quw, 0));
    set3(p->Qww, lane_get(&g->q.Qww, 0));
    set3(p->n, lane_get(&g->n_smooth, 0));
}

static void set_bump(kage_probe *p, const hit_group *g, const bump *P)
{
    const bs_vec3 s = lane_get(&g->x->s, 0), n = lane_get(&g->n_smooth, 0), Qu = lane_get(&g->q.Qu, 0),
                  Qw = lane_get(&g->q.Qw, 0);
    p->bumped = 1;
    p->P = (double)g->bump.P[0];
    p->Pu = (double)g->bump.Pu[0];
    p->Pw = (double)g->bump.Pw[0];
    p->Puu = (double)g->bump.Puu[0];
    p->Puw = (double)g->bump.Puw[0];
    p->Pww = (double)g->bump.Pww[0];
    p->Pmin = (double)P->Pmin;
    p->Pmax = (double)P->Pmax;
    set3(p->n_bump, bs_perturbed_normal(n, Qu, Qw, g->bump.Pu[0], g->bump.Pw[0]));
    p->regular = bs_regular(n, Qu, Qw);
    if (!p->regular)
        return;
    const bs_view v = bs_view_of(s, n, Qu, Qw);
    const bs_slab slab = bs_slab_of(v, P->Pmin, P->Pmax);
    p->sn = (double)v.sn;
    p->a = (double)v.a;
    p->b = (double)v.b;
    p->slab[0] = (double)slab.front;
    p->slab[1] = (double)slab.back;
}

static kage_probe_row row_of(const tracer *k, int id, workspace *v, const char *name, double *visible)
{
    trace_group(k, id, v);
    const hit_group *g = &v->g;
    const int code = k->shadow.kind == METHOD_AUTO ? g->order[0] : method_code(k->shadow); /* auto never falls back */
    const int asked = k->scene->object[id].bump ? code : -1;
    kage_probe_row x = {.method = name,
                        .guard = k->guard,
                        .tau = (double)g->tau[0],
                        .t0 = (double)g->t0[0],
                        .fell_back = g->order[0] == asked ? NULL : method_code_name(g->order[0]),
                        .visible = visible};
    set3(x.origin, lane_at(g->x, 0, g->t0[0]));
    set3(x.color, lane_get(&g->rgb, 0));
    for (int l = 0; l < k->scene->lights; l++)
        visible[l] = (double)v->visibility[l][0];
    return x;
}

static void set_rows(const scene *s, int id, workspace *v, block *b)
{
    int n = 0;
    for (int k = 0; k < NAMES; k++) {
        tracer x = {.scene = s, .layers = true};
        method_parse(names[k], &x.shadow);
        const int variants = x.shadow.kind == METHOD_ORDER && x.shadow.n > 0 ? 2 : 1;
        for (int bare = 0; bare < variants; bare++, n++) {
            x.guard = !bare;
            b->row[n] = row_of(&x, id, v, names[k], b->visible + n * s->lights);
        }
    }
    b->probe.rows = b->row;
    b->probe.row_count = n;
}

static void follow(const scene *s, int x, int y, workspace *v, block *b)
{
    /* 2+ asks every surface and bump for all of its partials */
    const tracer k = {.scene = s, .shadow = {METHOD_ORDER, 3}, .guard = true, .layers = true};
    kage_probe *p = &b->probe;
    camera_ray(&s->camera, s->width, s->height, x + 0.5, y + 0.5, &v->x, 0);
    intersect_nearest(s, 1, v);
    set3(p->r, lane_get(&v->x.r, 0));
    set3(p->s, lane_get(&v->x.s, 0));
    p->object = gather_next_group(1, &v->x, &v->nearest, &v->g);
    if (p->object < 0)
        return;
    const object *o = &s->object[p->object];
    trace_group(&k, p->object, v);
    set_surface(p, &v->g);
    if (o->bump)
        set_bump(p, &v->g, o->bump);
    p->undefined = v->g.undefined > 0;
    set_rows(s, p->object, v, b);
    p->sends = material_sends(&s->material[o->material]);
}

kage_status kage_scene_probe(kage_scene *k, int x, int y, kage_probe **out, kage_errors **to)
{
    const scene *s = k->first;
    *out = NULL;
    if (to)
        *to = NULL;
    if (x < 0 || y < 0 || x >= s->width || y >= s->height)
        return error_give(KAGE_BAD_OPTION, to, "pixel %d,%d: the picture is %d x %d pixels, expected 0,0 to %d,%d", x,
                          y, s->width, s->height, s->width - 1, s->height - 1);
    memory m = {.from = k->allowed.budget, .limit = k->allowed.most};
    char words[MEMORY_WORDS];
    block *b = calloc(1, sizeof *b + (size_t)(s->lights * ROWS) * sizeof *b->visible);
    workspace *v = b ? workspace_new(&(tracer){.scene = s}, &m) : NULL;
    if (!v) {
        free(b);
        return error_give(KAGE_NO_MEMORY, to, "%s", memory_words(&m, words));
    }
    follow(s, x, y, v, b);
    workspace_free(v);
    *out = &b->probe;
    return KAGE_OK;
}

void kage_probe_free(kage_probe *p) { free(p); }
