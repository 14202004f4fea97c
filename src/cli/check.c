/* kage check: what is in a scene, and how steep its bumps are where the camera sees them. */
#include "cli/command.h"
#include "wave/lane.h"
#include "render/intersect.h"
#include "render/trace.h"
#include "wave/gather.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SAMPLES = 200 }; /* SAMPLES x SAMPLES rays over the picture */

/* Above this slope (95th percentile) the orders 0, 1 and 2 put more than about 1 % of a cast shadow's pixels wrong: the
 * table of docs/method.md, "How far the orders go". */
#define SLOPE_BOUND 0.35

/* What the rays have found on one object. */
typedef struct seen {
    float *slope;
    int n;
    long back1, back2; /* samples where the orders 1 and 2 fell back */
} seen;

static int ascending(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* tan of the angle between the smooth and the perturbed normal: the slope of the bump in scene units. */
static float slope(const hit_group *g, int i)
{
    bs_vec3 n = lane_unit(lane_get(&g->n_smooth, i)), np = lane_get(&g->n_bump, i), c = bs_cross(n, np);
    return (float)(real_sqrt(bs_dot(c, c)) / bs_dot(n, np));
}

static void look(const scene *s, int order, workspace *v, seen *all)
{
    tracer k = {.scene = s, .shadow = {METHOD_ORDER, order}, .guard = true};
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
                if (order == 2) {
                    o->slope[o->n++] = slope(g, i);
                    o->back2 += g->order[i] != 2;
                } else
                    o->back1 += g->order[i] != 1;
            }
        }
    }
}

static int print_bump(const object *o, const seen *x)
{
    const bump *p = o->bump;
    int warnings = 0;
    if (o->map.file)
        printf("    map       %s: %d x %d samples from %.7g to %.7g\n", o->map.file, o->map.width, o->map.height,
               o->map.low, o->map.high);
    printf("    P         from %.6g to %.6g scene units%s\n", (double)p->Pmin, (double)p->Pmax,
           o->map.file ? "" : " (bounds)");
    if (!(p->Pmax - p->Pmin < REAL_FAR)) {
        printf("    warning: P has no bounds here, so the guard has no slab and march:N falls back to order 0; "
               "expected a\n"
               "             function that is bounded over the whole surface\n");
        warnings++;
    }
    if (!x->n) {
        printf("    slope     unknown: the camera does not see it\n");
        return warnings;
    }
    qsort(x->slope, (size_t)x->n, sizeof *x->slope, ascending);
    double median = (double)x->slope[x->n / 2], p95 = (double)x->slope[(int)(0.95 * x->n)],
           top = (double)x->slope[x->n - 1];
    double back1 = 100.0 * (double)x->back1 / x->n, back2 = 100.0 * (double)x->back2 / x->n;
    printf("    slope     median %.3f, 95 %% below %.3f, steepest %.3f (where the camera sees it)\n", median, p95, top);
    printf("    fall back order 1 in %.2f %%, order 2 in %.2f %% of what is seen\n", back1, back2);
    if (p95 > SLOPE_BOUND) {
        printf(
            "    warning: slopes above %.2f are more than the orders 0, 1 and 2 can bear: expect 1 %% and more of a\n"
            "             shadow's pixels wrong; march:4 bears them\n",
            SLOPE_BOUND);
        warnings++;
    }
    if (back1 > 1 || back2 > 1) {
        printf("    warning: %s back often: the view is flat against the bumps; order 0 or march:4 serve\n",
               back1 > 1 && back2 > 1 ? "orders 1 and 2 fall"
               : back1 > 1            ? "order 1 falls"
                                      : "order 2 falls");
        warnings++;
    }
    return warnings;
}

static void print_some(int n, const char *what)
{
    if (n)
        printf("              %d %s\n", n, what);
}

static int print_mesh(const shape_spec *f)
{
    const mesh_notes *n = &f->found;
    printf("    model     %s: %d triangles, %s\n", f->file, f->triangles,
           n->bare == 0              ? "texture coordinates on all"
           : n->bare == f->triangles ? "no texture coordinates"
                                     : "texture coordinates on some");
    print_some(n->turned, "turned round, as all of their normals are on the other side");
    print_some(n->bent, "corners' normals turned away from their triangle, replaced by its own");
    print_some(n->folded, "with the texture mirrored: u beyond its range");
    print_some(n->spread, "with no area on the texture: spread over 1/4096 of it");
    if (n->flat)
        printf("    warning: %d triangles without an area are left out\n", n->flat);
    return n->flat > 0;
}

static void print_scene(const scene *s, const seen *all)
{
    char name[METHOD_NAME_SIZE];
    int warnings = 0;
    method_name(s->shadow, name);
    printf("%s: %d x %d pixels, %d x %d samples each", s->path, s->width, s->height, s->aa, s->aa);
    if (s->aa > 1 && s->aa_threshold >= 0)
        printf(" that differs from a neighbour by more than %g", s->aa_threshold);
    printf(", shadow %s%s", name, s->guard ? "" : ", no guard");
    if (s->sends)
        printf(", depth %d", s->depth);
    printf("\n");
    for (int i = 0; i < s->lights; i++) {
        static const char *const kinds[] = {"", ", spot", ", parallel"};
        const light *l = &s->light[i];
        printf("light %s at %g, %g, %g%s%s", l->name, l->at.x, l->at.y, l->at.z, kinds[l->kind],
               l->fade_distance > 0 ? ", fading" : "");
        if (l->samples[0] * l->samples[1] > 1)
            printf(", area of %d x %d samples", l->samples[0], l->samples[1]);
        printf("\n");
    }
    for (int i = 0; i < s->objects; i++) {
        const object *o = &s->object[i];
        const material *m = &s->material[o->material];
        printf("object %s: %s%s%s%s, material %s%s%s%s%s%s%s\n", o->name, o->shape->ops->kind,
               o->copy_of ? ", copy of " : "", o->copy_of ? o->copy_of : "", o->moved ? ", transformed" : "", m->name,
               o->color ? ", color by " : "", o->color ? o->color->ops->kind : "", o->bump ? ", bump by " : "",
               o->bump ? o->bump->ops->kind : "", material_mirrors(m) ? ", mirrors" : "",
               material_clear(m) ? ", transparent" : "");
        if (o->shape_spec.kind == SHAPE_MESH && !o->copy_of)
            warnings += print_mesh(&o->shape_spec);
        if (o->bump)
            warnings += print_bump(o, &all[i]);
    }
    printf("%d warning%s\n", warnings, warnings == 1 ? "" : "s");
}

static int check(const scene *s)
{
    workspace *v = workspace_new(&(tracer){.scene = s});
    seen *all = calloc((size_t)(s->objects ? s->objects : 1), sizeof *all);
    bool good = v && all;
    for (int i = 0; good && i < s->objects; i++)
        if (s->object[i].bump)
            good = (all[i].slope = malloc(sizeof(float) * SAMPLES * SAMPLES)) != NULL;
    if (good) {
        look(s, 1, v, all);
        look(s, 2, v, all);
        print_scene(s, all);
    } else
        usage_error("out of memory");
    for (int i = 0; all && i < s->objects; i++)
        free(all[i].slope);
    free(all);
    workspace_free(v);
    return good ? 0 : EXIT_OUTPUT;
}

int command_check(const arguments *a)
{
    scene *s = command_scene(a);
    if (!s)
        return EXIT_INPUT;
    int status = check(s);
    scene_free(s);
    return status;
}
