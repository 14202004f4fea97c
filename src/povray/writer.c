/* The POV-Ray file as a whole: camera, lights, materials, and each object by the file that can write it. */
#include "pov_text/flat.h"
#include "povray/parts.h"

#include <stdio.h>
#include <string.h>

/* Only the scene's base name: an export does not show the folders of the machine that made it. */
static void put_head(pov_text *t, const scene *s, const pov_options *o)
{
    const char *slash = strrchr(s->path, '/');
    char name[256];
    snprintf(name, sizeof name, "%s", slash ? slash + 1 : s->path);
    for (char *c = name; *c; c++)
        *c = (unsigned char)*c < 0x20 ? '?' : *c;
    pov_print(t, "// %s, %s, for POV-Ray 3.7\n", name,
              s->displaced ? "with its bumps truly displaced" : "without bumps");
    pov_print(t, "// made by: %s\n", o->command);
    bool images = false;
    for (int k = 0; k < s->materials; k++)
        images |= s->material[k].pattern == PATTERN_IMAGE;
    pov_print(t, "// render:  povray +I<this file> +O<picture>.exr +FE +W%d +H%d", s->width, s->height);
    if (s->aa > 1 && s->aa_threshold >= 0)
        pov_print(t, " +A%g +AM1 +R%d -J", s->aa_threshold, s->aa < 9 ? s->aa : 9);
    else
        pov_print(t, " -A");
    pov_print(t, " -D%s\n\n", images ? " +L<the scene's folder>" : "");
    pov_print(t, "#version 3.7;\n"
                 "global_settings { assumed_gamma 1 ambient_light rgb 1");
    if (s->sends)
        pov_print(t, " max_trace_level %d adc_bailout 0", s->depth);
    pov_print(t, " }\n\n");
}

static void put_camera(pov_text *t, const scene *s)
{
    const camera_view *v = &s->view;
    if (s->camera.orthographic)
        pov_print(
            t,
            "camera {\n  orthographic\n  location %v\n  sky %v\n  right x*%g\n  up y*%g*image_height/image_width\n"
            "  look_at %v\n}\n\n",
            s->camera.from, v->up, v->width, v->width, v->at);
    else
        pov_print(t,
                  "camera {\n  perspective\n  location %v\n  sky %v\n  right x*image_width/image_height\n  up y\n"
                  "  angle %g // horizontal\n  look_at %v\n}\n\n",
                  s->camera.from, v->up, v->fov, v->at);
    pov_print(t, "background { color rgb %v }\n\n", s->background);
}

/* `adaptive 16` makes POV-Ray use every sample of an area, as kage does. */
static void put_light(pov_text *t, const light *l)
{
    pov_print(t, "light_source { %v color rgb %v", l->at, l->color);
    if (l->kind == LIGHT_SPOT)
        pov_print(t, "\n  spotlight point_at %v radius %g falloff %g tightness %g", l->to, l->radius, l->falloff,
                  l->tightness);
    if (l->kind == LIGHT_PARALLEL)
        pov_print(t, "\n  parallel point_at %v", l->to);
    if (l->fade_distance > 0)
        pov_print(t, "\n  fade_distance %g fade_power %g", l->fade_distance, l->fade_power);
    if (l->samples[0] * l->samples[1] > 1)
        pov_print(t, "\n  area_light %v, %v, %d, %d adaptive 16", l->u, l->w, l->samples[0], l->samples[1]);
    pov_print(t, " } // %s\n", l->name);
}

static void put_object_end(pov_text *t, const scene *s, const pov_options *how, const object *o)
{
    const material *m = &s->material[o->material];
    if (!pov_by_parts(s, o))
        pov_texture(t, s, o, 0);
    if (material_clear(m) && shape_has_inside(&o->shape_spec))
        pov_print(t, "  interior { ior %g }\n", m->ior);
    if ((o->bump && !s->self_shadow) || (!o->bump && how->no_cast))
        pov_print(t, "  no_shadow\n");
    pov_print(t, "}\n\n");
}

static bool put_displaced(pov_text *t, const scene *s, const pov_options *how, int k, pov_report *report)
{
    const object *o = &s->object[k];
    pov_identifier P = pov_identify("P", o->name, k);
    double gradient = 0;
    for (int part = 0; part < o->shape->ops->parts; part++)
        gradient = fmax(gradient, pov_isosurface_gradient(o, part));
    /* toward a horizon POV-Ray's isosurface lets light through */
    if (gradient < HUGE_VAL && !pov_has_horizon(s, o) && pov_function(t, o, P.text)) {
        pov_isosurface(t, s, o, P.text);
        return true;
    }
    return pov_mesh(t, s, how, o, report);
}

/* One object, or the declared original of copies. False: out of memory. */
static bool put_object(pov_text *t, const scene *s, const pov_options *how, int k, pov_report *report)
{
    const object *const of = &s->object[k];
    const object one = of->crowd ? pov_original(of) : *of, *const o = &one;
    bool good = true;
    pov_identifier name = pov_identify("Copies", of->name, k);
    pov_print(t, "// object %s: %s%s%s\n", o->name, of->shape->ops->kind, o->bump ? ", bump by " : "",
              o->bump ? o->bump->ops->kind : "");
    if (of->crowd)
        pov_print(t, "#declare %s =\n", name.text);
    if (pov_is_patch(s, o))
        good = pov_patch(t, s, how, o);
    else if (o->shape_spec.kind == SHAPE_MESH)
        good = pov_triangle_mesh(t, s, how, o);
    else if (s->displaced && o->bump)
        good = put_displaced(t, s, how, k, report);
    else
        pov_smooth(t, s, o);
    put_object_end(t, s, how, o);
    if (of->crowd)
        pov_copies(t, of, k - of->first, name.text);
    return good;
}

bool pov_write(const scene *s, const pov_options *given, const char *path, pov_report *report, errors *e)
{
    pov_options how = *given;
    pov_text t;
    bool good = true, stopped = false;
    *report = (pov_report){0};
    if (!pov_begin(&t, path, e))
        return false;
    put_head(&t, s, &how);
    put_camera(&t, s);
    for (int k = 0; k < s->lights; k++)
        put_light(&t, &s->light[k]);
    pov_print(&t, "\n");
    pov_materials(&t, s);
    for (int k = 0; good && !stopped && k <= s->objects; k++) {
        how.share = (double)k / (s->objects + 1);
        stopped = !progress_show(how.progress, "writing", how.share);
        if (!stopped && k < s->objects)
            good = put_object(&t, s, &how, k, report);
    }
    char words[MEMORY_WORDS];
    return pov_end(&t, stopped ? "stopped" : good ? NULL : memory_words(progress_memory(how.progress), words), e);
}
