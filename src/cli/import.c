/* kage import: writes a scene for a model. */
#include "cli/command.h"

#include <stdio.h>
#include <string.h>

static void print_report(const arguments *a, const kage_import_report *r)
{
    const kage_scene_info *s = kage_scene_get_info(r->scene);
    for (int k = 0; k < r->note_count; k++)
        fprintf(stderr, "kage: %s\n", r->notes[k]);
    if (a->quiet)
        return;
    for (int k = 0; k < r->file_count; k++)
        printf("%s\n", r->files[k]);
    printf("%s: %d object%s, %d light%s\n", a->output[0], s->object_count, s->object_count == 1 ? "" : "s",
           s->light_count, s->light_count == 1 ? "" : "s");
}

int command_import(const arguments *a)
{
    kage_import_report *r;
    kage_errors *e;
    progress_bar p;
    if (!a->outputs) {
        usage_error("'kage import' lacks -o SCENE.yaml; see kage --help");
        return EXIT_INPUT;
    }
    progress_bar_start(&p, a->quiet, base_name(a->operand[0]), 0);
    const kage_import_options o = {.bumps = (const char *const *)a->bump,
                                   .bump_count = a->bumps,
                                   .camera = a->camera,
                                   .z_up = a->z_up,
                                   .brightness = a->brightness,
                                   .overwrite = a->overwrite,
                                   .threads = a->threads,
                                   .progress = progress_bar_show,
                                   .user = &p};
    const kage_status status = kage_model_import(a->operand[0], a->output[0], &o, &r, &e);
    progress_bar_end(&p);
    if (status != KAGE_OK)
        return print_errors(e, status == KAGE_NOT_WRITTEN ? EXIT_OUTPUT : EXIT_INPUT);
    print_report(a, r);
    kage_import_report_free(r);
    return 0;
}
