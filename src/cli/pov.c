/* kage pov: the scene for POV-Ray. */
#include "cli/command.h"
#include "povray/povray.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The command as the file tells it: the scene's base name, the options, no other path. NULL: out of memory. */
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

int command_pov(const arguments *a)
{
    if (!a->outputs) {
        usage_error("'kage pov' lacks -o FILE.pov; see kage --help");
        return EXIT_INPUT;
    }
    scene *s = command_scene(a);
    errors e = {0};
    if (!s)
        return EXIT_INPUT;
    if (!outputs_spare_inputs(s, a->output, 1) || !pov_possible(s, &e)) {
        scene_free(s);
        return e.count ? command_fail(&e, EXIT_INPUT) : EXIT_INPUT;
    }
    char *text = command_text(a);
    pov_options how = {text, a->no_cast};
    pov_report r;
    bool good = text ? pov_write(s, &how, a->output[0], &r, &e) : usage_error("out of memory");
    if (good && r.coarse)
        fprintf(stderr,
                "kage: object %s: coarse mesh: heights are off by up to %.3g, %.3g pixels; a finer one has too many "
                "triangles\n",
                r.coarse, r.height, r.pixels);
    free(text);
    scene_free(s);
    return good ? 0 : e.count ? command_fail(&e, EXIT_OUTPUT) : EXIT_OUTPUT;
}
