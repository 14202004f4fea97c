/* kage check: prints what is in a scene, how steep its visible bumps are, and warnings. */
#include "cli/command.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* An object's warning of this kind, or NULL. */
static const kage_warning *find_warning(const kage_survey *v, int object, kage_warning_code code)
{
    for (int k = 0; k < v->warning_count; k++)
        if (v->warnings[k].object == object && v->warnings[k].code == code)
            return &v->warnings[k];
    return NULL;
}

/* In lines of a terminal's width. */
static void print_warning(const char *fmt, ...) CLI_PRINTF(1, 2);
static void print_warning(const char *fmt, ...)
{
    enum { AT = 13 };
    char text[512];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    printf("    warning: ");
    print_wrapped(stdout, AT, AT, COLUMNS, text);
}

/* What the method can't do, and which one can. March needs bounds of P. */
static void print_method(const kage_scene_info *s, const kage_survey *v, int id)
{
    const bool bounded = s->objects[id].bounded;
    const kage_warning *w = find_warning(v, id, KAGE_WARN_STEEP);
    if (w)
        print_warning("slopes above %.2g are too steep for order %s: expect 1.5 %% and more of a shadow's pixels "
                      "wrong; %s",
                      w->bound, s->method, bounded ? "use auto or march:8" : "lower the bump's scale");
    if ((w = find_warning(v, id, KAGE_WARN_FALLS_BACK)))
        print_warning("order %s falls back often, in %.3g %%: the view is flat against the bumps; use %s", s->method,
                      w->value, bounded ? "auto or march:8" : "order 0");
}

/* Heights that are hardly meant. */
static void print_heights(const kage_object_info *o, const kage_survey *v, int id)
{
    const kage_warning *w = find_warning(v, id, KAGE_WARN_SCALE);
    const bool above = o->height[0] > 0;
    if (w)
        print_warning("%s; try scale: %.2g, not %.6g",
                      v->objects[id].slope_95 > w->bound ? "the bumps are steeper than anything that is only shaded"
                                                         : "the bumps are too flat to be seen",
                      w->value, o->bump_scale);
    if ((w = find_warning(v, id, KAGE_WARN_ZERO)))
        print_warning("all of P is far %s the surface, where shadows then fall; %s %.4g", above ? "above" : "below",
                      o->map ? "try zero:" : "take from the function about", w->value);
}

static void print_steps(const kage_object_info *o, const kage_survey *v, int id)
{
    const kage_warning *w = find_warning(v, id, KAGE_WARN_STEPS);
    if (w)
        print_warning("the map has %d bits: where it rises slowly its steps of %.3g are seen as stairs, slopes of "
                      "%.3f beside its own of %.3f; use a map of 16 bits, or bump.smooth: 2",
                      o->map_bits, v->objects[id].step, w->value, v->objects[id].slope_median);
}

static void print_map(const kage_object_info *o, const kage_bump_survey *b)
{
    printf("    map       %s: %d x %d samples from %.7g to %.7g\n", o->map, o->map_size[0], o->map_size[1],
           o->map_range[0], o->map_range[1]);
    if (b->step > 0)
        printf("    step      %d bits: %.4g scene units, a slope of %.4f; %s\n", o->map_bits, b->step, b->step_slope,
               o->map_smooth > 0 ? "smoothed" : "not smoothed");
}

static void print_bump(const kage_scene_info *s, const kage_survey *v, int id)
{
    const kage_object_info *o = &s->objects[id];
    const kage_bump_survey *b = &v->objects[id];
    if (o->map)
        print_map(o, b);
    printf("    P         from %.6g to %.6g scene units%s", o->height[0], o->height[1], o->map ? "" : " (bounds)");
    if (b->distance > 0 && o->bounded)
        printf("\n    height    %.2g %% of the eye's distance", 100 * (o->height[1] - o->height[0]) / b->distance);
    printf("\n");
    if (find_warning(v, id, KAGE_WARN_UNBOUNDED))
        print_warning("P has no bounds here, so the guard has no slab and march:N falls back to order 0; expected a "
                      "function that is bounded over the whole surface");
    if (b->undefined > 0)
        print_warning("P has no value at %.3g %% of the surface that the camera sees: it is smooth there; expected a "
                      "function with a value over the whole surface",
                      b->undefined);
    if (!b->samples)
        printf("    slope     unknown: the camera does not see it\n");
    else if (b->undefined < 100) {
        printf("    slope     median %.3f, 95 %% below %.3f, steepest %.3f, where it is seen\n", b->slope_median,
               b->slope_95, b->slope_max);
        printf("    fall back order 1 in %.2f %%, order 2 in %.2f %% of what is seen\n", b->fell_back[1],
               b->fell_back[2]);
    }
    print_heights(o, v, id);
    print_method(s, v, id);
    print_steps(o, v, id);
}

static void print_some(int n, const char *what)
{
    if (n)
        printf("              %d %s\n", n, what);
}

static void print_model(const kage_model_info *m)
{
    printf("    model     %s: %d triangles, %s\n", m->file, m->triangles,
           m->untextured == 0              ? "texture coordinates on all"
           : m->untextured == m->triangles ? "no texture coordinates"
                                           : "texture coordinates on some");
    print_some(m->flipped, "flipped, as all of their normals are on the other side");
    print_some(m->normals, "corner normals on the wrong side of their triangle, replaced by the triangle's");
    print_some(m->mirrored, "with the texture mirrored: u beyond its range");
    print_some(m->texture_points, "with no area on the texture: spread over 1/4096 of it");
    if (m->flat)
        printf("    warning: %d triangles without an area are left out\n", m->flat);
}

static void print_light(const kage_light_info *l)
{
    const bool point = strcmp(l->kind, "point") == 0;
    printf("light %s at %g, %g, %g%s%s%s", l->name, l->at[0], l->at[1], l->at[2], point ? "" : ", ",
           point ? "" : l->kind, l->fades ? ", fading" : "");
    if (l->samples[0] * l->samples[1] > 1)
        printf(", area of %d x %d samples", l->samples[0], l->samples[1]);
    printf("\n");
}

static void print_object(const kage_object_info *o)
{
    printf("object %s: ", o->name);
    if (o->copies)
        printf("%d copies of %s", o->copies, o->copy_of);
    else
        printf("%s%s%s", o->shape, o->copy_of ? ", copy of " : "", o->copy_of ? o->copy_of : "");
    printf("%s, material %s%s%s%s%s%s%s\n", o->transformed ? ", transformed" : "", o->material,
           o->color ? ", color by " : "", o->color ? o->color : "", o->bump ? ", bump by " : "", o->bump ? o->bump : "",
           o->mirrors ? ", mirrors" : "", o->transparent ? ", transparent" : "");
}

static void print_survey(const kage_scene_info *s, const kage_survey *v)
{
    printf("%s: %d x %d pixels, %d x %d samples each", s->path, s->width, s->height, s->aa, s->aa);
    if (s->aa > 1 && s->aa_threshold >= 0)
        printf(" that differs from a neighbour by more than %g", s->aa_threshold);
    printf(", shadow %s%s", s->method, s->guard ? "" : ", no guard");
    if (s->shifted)
        printf(", shade shifted");
    if (strcmp(s->bump_shadow, "none") != 0)
        printf(", bump shadow %s", s->bump_shadow);
    if (s->depth)
        printf(", depth %d", s->depth);
    printf("\n");
    for (int k = 0; k < s->light_count; k++)
        print_light(&s->lights[k]);
    for (int k = 0; k < s->object_count; k++) {
        const kage_object_info *o = &s->objects[k];
        print_object(o);
        if (o->model)
            print_model(o->model);
        if (o->bump)
            print_bump(s, v, k);
    }
    printf("%d warning%s\n", v->warning_count, v->warning_count == 1 ? "" : "s");
}

int command_check(const arguments *a)
{
    kage_scene *s = load_scene(a);
    kage_survey *v;
    kage_errors *e;
    if (!s)
        return EXIT_INPUT;
    const int status = kage_scene_survey(s, &v, &e) == KAGE_OK ? 0 : print_errors(e, EXIT_OUTPUT);
    if (v)
        print_survey(kage_scene_get_info(s), v);
    kage_survey_free(v);
    kage_scene_free(s);
    return status;
}
