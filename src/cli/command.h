/* The program's commands and what they share. They know the tracer through kage.h alone. Results go to stdout, errors
 * and progress to stderr. Each command returns the exit status: 0, 1 where an output can't be written, 2 for bad input.
 */
#ifndef KAGE_CLI_COMMAND_H
#define KAGE_CLI_COMMAND_H

#include <stdbool.h>

#include "kage.h"

enum { EXIT_OUTPUT = 1, EXIT_INPUT = 2, MAX_OUTPUTS = 16, MAX_SETS = 256 };

#if defined(__GNUC__)
#define CLI_PRINTF(fmt, first) __attribute__((format(printf, fmt, first)))
#else
#define CLI_PRINTF(fmt, first)
#endif

/* The commands that take a scene, as bits. */
enum { COMMAND_RENDER = 1, COMMAND_CHECK = 2, COMMAND_PIXEL = 4, COMMAND_POV = 8 };

/* The command line, read. Zero: not given. */
typedef struct arguments {
    const char *name; /* of the command */
    int command;
    const char *operand[2]; /* what is no option */
    int operands;
    const char *output[MAX_OUTPUTS];
    int outputs;
    char *set[MAX_SETS]; /* --set's, and those options that are changes of the scene; owned */
    int sets;
    int crop[4];
    const char *layers; /* of an EXR; NULL: all */
    int threads, bits;
    bool stats, quiet, no_cast, overwrite;
} arguments;

/* Read the options of a command. False: what is wrong is on stderr. arguments_free in either case. */
bool arguments_read(arguments *a, int argc, char **argv, int command);
void arguments_free(arguments *a);

int command_render(const arguments *a);
int command_check(const arguments *a);
int command_pixel(const arguments *a);
int command_pov(const arguments *a);

/* ---- common.c ---- */

/* The scene of a command line, or NULL with the errors on stderr. There, too, is what was left out of models, unless it
 * is to be quiet. */
kage_scene *load_scene(const arguments *a);

/* A path's last name: what pictures and exports say of it, so that they do not depend on the folder. */
const char *base_name(const char *path);

/* Print a list of errors and free it. Returns `status`. */
int print_errors(kage_errors *e, int status);

/* One line on stderr for a mistake on the command line. Always false. */
bool usage_error(const char *fmt, ...) CLI_PRINTF(1, 2);

/* ---- output.c ---- */

/* Whether no output is a file that the scene is made from. False: why is on stderr. */
bool outputs_spare_inputs(const kage_scene *s, const char *const *output, int outputs);

/* Whether a name that nobody gave is free, or a picture of kage's. False: why is on stderr. */
bool output_is_replaceable(const char *path);

bool has_ending(const char *path, const char *ending);

/* ---- progress_bar.c ---- */

/* Seconds by a clock that only goes forward. */
double clock_now(void);

/* A bar on the terminal behind stderr: what is done, the rate, the time left. Nothing where that is no terminal. */
typedef struct progress_bar {
    bool on;
    double start, shown;
    long pixels;
    const char *name;
    char what[16]; /* is done with a file */
} progress_bar;

void progress_bar_start(progress_bar *p, bool quiet, const char *name, long pixels);
void progress_bar_end(progress_bar *p);

/* For kage_progress: a render; and a scene's files, which have no pixels. */
int progress_bar_render(void *user, const char *what, double share);
int progress_bar_load(void *user, const char *what, double share);

#endif
