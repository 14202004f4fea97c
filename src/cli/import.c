/* kage import: writes a scene for a model. */
#include "cli/command.h"

#include <stdio.h>
#include <string.h>

static void print_report(const arguments *a, const kage_import_report *r)
{
    const kage_scene_info *s = kage_scene_get_info(r->scene);
    for (int k = 0; k < r->note_count; k++)
        tell("%s", r->notes[k]);
    if (a->quiet)
        return;
    for (int k = 0; k < r->file_count; k++)
        printf("%s\n", r->files[k]);
    printf("%s: %d object%s, %d light%s\n", a->output[0], s->object_count, s->object_count == 1 ? "" : "s",
           s->light_count, s->light_count == 1 ? "" : "s");
}

/* Maps whose few bits are seen. */
static void print_steps(const kage_scene *scene, const kage_survey *v)
{
    const kage_object_info *o = kage_scene_get_info(scene)->objects;
    for (int k = 0; k < v->warning_count; k++) {
        const kage_warning *w = &v->warnings[k];
        if (w->code == KAGE_WARN_STEPS)
            tell("object %s: the map %s has %d bits: its steps of %.3g scene units are seen as stairs, slopes of %.3f "
                 "beside its own of %.3f; use a map of 16 bits, or smooth=2",
                 o[w->object].name, o[w->object].map, o[w->object].map_bits, v->objects[w->object].step, w->value,
                 v->objects[w->object].slope_median);
    }
}

/* Whether the bumps are any good where the camera sees them. */
static int look_at_bumps(kage_scene *scene)
{
    kage_survey *v;
    kage_errors *e;
    if (kage_scene_survey(scene, &v, &e) != KAGE_OK)
        return print_errors(e, EXIT_OUTPUT);
    print_steps(scene, v);
    kage_survey_free(v);
    return 0;
}

int command_import(const arguments *a)
{
    kage_import_report *r;
    kage_errors *e;
    progress_bar p;
    if (!a->outputs) {
        usage_error("'kage import' lacks -o SCENE.yaml; see kage import --help");
        return EXIT_INPUT;
    }
    stop_outcome("no scene written");
    tidy(a, a->output[0]);
    progress_bar_start(&p, a->quiet, base_name(a->operand[0]), 0);
    const kage_import_options o = {.bumps = (const char *const *)a->bump,
                                   .bump_count = a->bumps,
                                   .camera = a->camera,
                                   .z_up = a->z_up,
                                   .brightness = a->brightness,
                                   .overwrite = a->overwrite,
                                   .threads = a->threads,
                                   .progress = progress_bar_show,
                                   .user = &p,
                                   .limits = &a->limits};
    const kage_status status = kage_model_import(a->operand[0], a->output[0], &o, &r, &e);
    progress_bar_end(&p);
    if (status != KAGE_OK)
        return print_errors(e, status == KAGE_NOT_WRITTEN ? EXIT_OUTPUT : EXIT_INPUT);
    print_report(a, r);
    stop_outcome("written: %s", a->output[0]);
    const int bumps = a->bumps ? look_at_bumps(r->scene) : 0;
    kage_import_report_free(r);
    return bumps;
}
