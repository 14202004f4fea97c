/* kage pixel: the way of one ray, every value by the same stages as in a picture. */
#include "cli/command.h"
#include "wave/lane.h"
#include "render/intersect.h"
#include "render/trace.h"
#include "wave/gather.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void scalar(const char *name, real x) { printf("%-10s %.9g\n", name, (double)x); }

static void vector(const char *name, const vec3s *v)
{
    printf("%-10s %.9g %.9g %.9g\n", name, (double)v->x[0], (double)v->y[0], (double)v->z[0]);
}

static void shape(const hit_group *g, const object *o)
{
    vector("Q", &g->q.Q);
    vector("Qu", &g->q.Qu);
    vector("Qw", &g->q.Qw);
    vector("Quu", &g->q.Quu);
    vector("Quw", &g->q.Quw);
    vector("Qww", &g->q.Qww);
    vector("n", &g->n_smooth);
    if (!o->bump)
        return;
    scalar("P", g->bump.P[0]);
    scalar("Pu", g->bump.Pu[0]);
    scalar("Pw", g->bump.Pw[0]);
    scalar("Puu", g->bump.Puu[0]);
    scalar("Puw", g->bump.Puw[0]);
    scalar("Pww", g->bump.Pww[0]);
    scalar("Pmin", o->bump->Pmin);
    scalar("Pmax", o->bump->Pmax);
    bs_vec3 s = lane_get(&g->x.s, 0), n = lane_get(&g->n_smooth, 0), Qu = lane_get(&g->q.Qu, 0),
            Qw = lane_get(&g->q.Qw, 0);
    bs_vec3 np = bs_perturbed_normal(n, Qu, Qw, g->bump.Pu[0], g->bump.Pw[0]);
    printf("%-10s %.9g %.9g %.9g\n", "n'", (double)np.x, (double)np.y, (double)np.z);
    if (!bs_regular(n, Qu, Qw)) {
        printf("|n| is 0 against the edges here: the smooth normal and order none are used\n");
        return;
    }
    bs_view v = bs_view_of(s, n, Qu, Qw);
    bs_slab slab = bs_slab_of(v, o->bump->Pmin, o->bump->Pmax);
    scalar("s.n/|n|", v.sn);
    scalar("a", v.a);
    scalar("b", v.b);
    printf("%-10s %.9g to %.9g in tau\n", "slab", (double)slab.front, (double)slab.back);
}

/* One method's row: tau, t0, the origin of the shadow rays, the order, and what each light gives. */
static void row(const tracer *k, int id, workspace *v, const char *label)
{
    trace_group(k, id, v);
    const hit_group *g = &v->g;
    const int asked = k->scene->object[id].bump ? method_code(k->shadow) : -1;
    bs_vec3 o = lane_at(&g->x, 0, g->t0[0]);
    printf("%-10s %13.6g %13.6g  %11.6g %11.6g %11.6g  %-6s", label, (double)g->tau[0], (double)g->t0[0], (double)o.x,
           (double)o.y, (double)o.z, g->order[0] == asked ? "" : method_code_name(g->order[0]));
    for (int l = 0; l < k->scene->lights; l++) {
        const double share = (double)v->visibility[l][0]; /* of an area's samples */
        if (share > 0 && share < 1)
            printf(" %-9.4g", share);
        else
            printf(" %-9s", share > 0 ? "lit" : "shadow");
    }
    printf("  %.4f %.4f %.4f\n", (double)g->rgb.x[0], (double)g->rgb.y[0], (double)g->rgb.z[0]);
}

static void table(const scene *s, int id, workspace *v)
{
    static const char *const names[] = {"none",   "0",       "1",       "2",       "2+",      "iter:2",
                                        "iter:4", "march:2", "march:4", "march:8", "march:16"};
    printf("\n%-10s %13s %13s  %11s %11s %11s  %-6s", "method", "tau", "t0", "r + s t0: x", "y", "z", "fell");
    for (int l = 0; l < s->lights; l++)
        printf(" %-9.9s", s->light[l].name);
    printf("  red    green  blue\n");
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        tracer x = {.scene = s, .guard = true, .layers = true};
        char label[32];
        method_parse(names[k], &x.shadow);
        row(&x, id, v, names[k]);
        if (x.shadow.kind == METHOD_ORDER && x.shadow.n > 0) {
            x.guard = false;
            snprintf(label, sizeof label, "%s bare", names[k]);
            row(&x, id, v, label);
        }
    }
}

static bool pixel(const char *text, const scene *s, int *x, int *y)
{
    char end;
    if (sscanf(text, "%5d,%5d%c", x, y, &end) != 2 || text[0] == '+' || strpbrk(text, " +-"))
        return usage_error("%s: expected a pixel X,Y, from the top left", text);
    if (*x >= s->width || *y >= s->height)
        return usage_error("%s: the picture is %d x %d pixels, expected 0,0 to %d,%d", text, s->width, s->height,
                           s->width - 1, s->height - 1);
    return true;
}

static int print_pixel(const scene *s, int x, int y)
{
    workspace *v = workspace_new(&(tracer){.scene = s});
    if (!v) {
        usage_error("out of memory");
        return EXIT_OUTPUT;
    }
    /* 2+ asks every surface and bump for all of its partials */
    tracer k = {.scene = s, .shadow = {METHOD_ORDER, 3}, .guard = true, .layers = true};
    camera_ray(&s->camera, s->width, s->height, x + 0.5, y + 0.5, &v->x, 0);
    intersect_nearest(s, 1, v);
    const int32_t id = gather_next_group(1, &v->x, &v->nearest, &v->g);
    printf("pixel      %d,%d\n", x, y);
    vector("r", &v->x.r);
    vector("s", &v->x.s);
    if (id >= 0) {
        const object *o = &s->object[id];
        trace_group(&k, id, v);
        printf("object     %s: %s, %s%s\n", o->name, o->shape->ops->kind, o->bump ? "bump by " : "no bump",
               o->bump ? o->bump->ops->kind : "");
        scalar("t_hit", v->g.t[0]);
        scalar("u", v->g.u[0]);
        scalar("w", v->g.w[0]);
        shape(&v->g, o);
        table(s, id, v);
        if (material_sends(&s->material[o->material]))
            printf("without the light that it mirrors or lets through; such rays start at r + s t0, too\n");
    } else
        printf("meets nothing\n");
    workspace_free(v);
    return 0;
}

int command_pixel(const arguments *a)
{
    scene *s = command_scene(a);
    int x = 0, y = 0, status = EXIT_INPUT;
    if (s && pixel(a->operand[1], s, &x, &y))
        status = print_pixel(s, x, y);
    scene_free(s);
    return status;
}
