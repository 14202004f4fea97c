/* The program's commands and what they share. Only these files talk: results go to stdout, errors and progress to
 * stderr. Each command returns the exit status: 0, 1 where an output can't be written, 2 for bad input.
 */
#ifndef KAGE_CLI_COMMAND_H
#define KAGE_CLI_COMMAND_H

#include "render/film.h"
#include "scene/scene.h"

enum { EXIT_OUTPUT = 1, EXIT_INPUT = 2, MAX_OUTPUTS = 16, MAX_SETS = 256 };

/* How pictures tell in their text Software that they are kage's, with the version behind it. */
#define OUTPUT_SOFTWARE "kage"

/* What may stand on the command line, read. Zero: not given. */
typedef struct arguments {
    const char *command;
    const char *operand[2]; /* what is no option */
    int operands;
    const char *output[MAX_OUTPUTS];
    int outputs;
    char *set[MAX_SETS]; /* --set's, and those options that are changes of the scene; owned */
    int sets;
    window crop;        /* x1 == 0: none */
    const char *layers; /* of an EXR; NULL: all */
    int threads, bits;
    bool stats, quiet, no_cast, overwrite;
} arguments;

/* Read the options of a command; tells what is wrong and returns false. arguments_free in either case. */
bool arguments_read(arguments *a, int argc, char **argv);
void arguments_free(arguments *a);

int command_render(const arguments *a);
int command_check(const arguments *a);
int command_pixel(const arguments *a);
int command_pov(const arguments *a);

/* The scene of a command line, or NULL with the errors told. What was left out of models is told, too, unless it is to
 * be quiet. */
scene *command_scene(const arguments *a);

/* A path's last name: what pictures and exports tell of it, so that they do not depend on the folder. */
const char *base_name(const char *path);

/* No output is a file that the scene is made from. False: it is told. (command_output.c) */
bool outputs_spare_inputs(const scene *s, const char *const *output, int outputs);

/* Whether a name that nobody gave is free, or a picture of kage's. False: it is told. (command_output.c) */
bool output_is_replaceable(const char *path);

/* Print a list of errors. Returns `status`. */
int command_fail(errors *e, int status);

/* One line on stderr for a mistake on the command line. Always false. */
bool usage_error(const char *fmt, ...) KAGE_PRINTF(1, 2);

/* A bar on the terminal behind stderr: what is done, the rate, the time left. Nothing where that is no terminal. */
typedef struct progress_bar {
    bool on;
    double start, shown;
    long pixels;
    const char *name, *what; /* what: is done with a file */
} progress_bar;

/* The same for a scene's files, which have no pixels: what is done with the file, and its share. */
void progress_bar_load(void *p, const char *what, double share);

void progress_bar_start(progress_bar *p, bool quiet, const char *name, long pixels);
void progress_bar_show(void *p, long done, long all);
void progress_bar_end(progress_bar *p);

#endif
