/* kage pov: writes a scene for POV-Ray. */
#include "cli/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The command line for the file's header, without paths. NULL: out of memory. */
static char *command_text(const arguments *a)
{
    const char *name = base_name(a->operand[0]);
    size_t size = strlen(name) + 64;
    for (int k = 0; k < a->sets; k++)
        size += strlen(a->set[k]) + 16;
    char *text = malloc(size), *at = text;
    if (!text)
        return NULL;
    at += sprintf(at, "kage pov %s", name);
    for (int k = 0; k < a->sets; k++)
        at += sprintf(at, " --set '%s'", a->set[k]);
    if (a->no_cast)
        sprintf(at, " --no-cast");
    for (char *c = text; *c; c++)
        *c = (unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c; /* a comment ends with its line */
    return text;
}

static int write_scene(kage_scene *s, const arguments *a)
{
    char *text = command_text(a);
    if (!text) {
        usage_error("out of memory");
        return EXIT_OUTPUT;
    }
    progress_bar p;
    progress_bar_start(&p, a->quiet, base_name(a->operand[0]), 0);
    const kage_povray_options how = {.command = text, .no_cast = a->no_cast, .progress = progress_bar_show, .user = &p};
    kage_povray_report r;
    kage_errors *e;
    const kage_status status = kage_scene_write_povray(s, a->output[0], &how, &r, &e);
    free(text);
    progress_bar_end(&p);
    if (status != KAGE_OK)
        return print_errors(e, status == KAGE_BAD_INPUT ? EXIT_INPUT : EXIT_OUTPUT);
    if (r.coarse)
        tell("object %s: coarse mesh: heights are off by up to %.3g, %.3g pixels; a finer one has too many triangles",
             r.coarse, r.height, r.pixels);
    return 0;
}

int command_pov(const arguments *a)
{
    if (!a->outputs) {
        usage_error("'kage pov' lacks -o FILE.pov; see kage pov --help");
        return EXIT_INPUT;
    }
    stop_outcome("nothing written");
    tidy(a, a->output[0]);
    kage_scene *s = load_scene(a);
    const int status = s && outputs_spare_inputs(s, a->output, 1) ? write_scene(s, a) : EXIT_INPUT;
    kage_scene_free(s);
    return status;
}
