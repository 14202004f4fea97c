/* The program's commands and their shared functions. They use the tracer only through kage.h. Results go to stdout,
 * errors and progress to stderr. Each command returns the exit status: 0, 1 where an output can't be written, 2 for bad
 * input.
 */
#ifndef KAGE_CLI_COMMAND_H
#define KAGE_CLI_COMMAND_H

#include <stdbool.h>
#include <stdio.h>

#include "kage.h"

enum { EXIT_OUTPUT = 1, EXIT_INPUT = 2, EXIT_TIME = 124, MAX_OUTPUTS = 16, MAX_SETS = 256, MAX_BUMPS = 256 };

#if defined(__GNUC__)
#define CLI_PRINTF(fmt, first) __attribute__((format(printf, fmt, first)))
#else
#define CLI_PRINTF(fmt, first)
#endif

/* The commands, as bits. */
enum {
    COMMAND_RENDER = 1,
    COMMAND_CHECK = 2,
    COMMAND_PIXEL = 4,
    COMMAND_POV = 8,
    COMMAND_IMPORT = 16,
    COMMAND_VIEW = 32,
    COMMAND_METHODS = 64,
    COMMAND_HELP = 128,
    COMMAND_COMPLETE = 256,
    COMMAND_TABLE = 512
};

/* The parsed command line. Zero: not given. */
struct command;

typedef struct arguments {
    const char *name; /* of the command */
    int command;
    const char *operand[2]; /* arguments that are not options */
    int operands;
    const char *output[MAX_OUTPUTS], *format[MAX_OUTPUTS]; /* format: as in kage_write_options */
    int outputs;
    char *set[MAX_SETS]; /* values of --set, and options that change the scene in the same form; owned */
    int sets;
    int crop[4];
    const char *layers; /* of an EXR, with commas; NULL: all */
    int threads, bits;
    const char *bump[MAX_BUMPS]; /* values of --bump */
    int bumps;
    const char *camera; /* of a model */
    double brightness;
    int frames;         /* of view, to measure */
    kage_limits limits; /* all but the seconds */
    double seconds;     /* that the command may take; 0: any */
    bool z_up;
    bool stats, quiet, no_cast, overwrite, resume, report, help;
    bool to_stdout; /* an output is -, standard output */
} arguments;

/* Parse a command's arguments. False: the mistake is on stderr. Call arguments_free in either case. */
bool arguments_read(arguments *a, int argc, char **argv, const struct command *c);
void arguments_free(arguments *a);

int command_render(const arguments *given);
int command_check(const arguments *a);
int command_pixel(const arguments *a);
int command_pov(const arguments *a);
int command_import(const arguments *a);
int command_view(const arguments *a); /* returns only where the window's program can't be started */
int command_view_help(void);          /* prints the window's keys, if its program is there */

/* What may follow these words; the last one is not finished, and may be "". A line for each:
 *
 *     =WORD<tab>TEXT      the whole word, and what it means
 *     +WORD<tab>TEXT      a beginning, which goes on without a space
 *     .BEFORE<tab>ENDINGS files that end so, after BEFORE in the word; any files without endings
 */
int command_complete(int count, char **word);

/* ---- help.c ---- */

int command_table(void); /* commands and options as JSON */

void print_help(FILE *to);
void print_command_help(const struct command *c);

/* ---- common.c ---- */

/* Load the scene. NULL: the errors are on stderr. Prints there what was left out of models, too, unless a->quiet. */
kage_scene *load_scene(const arguments *a);

/* The last part of a path: in pictures and exports, so that they do not depend on the folder. */
const char *base_name(const char *path);

/* Print a list of errors and free it. Returns `status`. */
int print_errors(kage_errors *e, int status);

/* Print `kage: ` and a message on stderr. Returns false. */
bool usage_error(const char *fmt, ...) CLI_PRINTF(1, 2);

/* The same of what is no mistake. */
void tell(const char *fmt, ...) CLI_PRINTF(1, 2);

/* Remove what killed processes have left in the folder of an output, and say so. */
void tidy(const arguments *a, const char *output);

/* Whether no output is one of the scene's input files. False: the error is on stderr. */
bool outputs_spare_inputs(const kage_scene *s, const char *const *output, int outputs);

/* Report an output that is named a second time, also by another path. */
bool outputs_differ(const char *const *output, int outputs);

bool has_ending(const char *path, const char *ending);

/* The built-in limit: "4096"; of bytes "64M". */
const char *limit_text(const kage_limit *l, char text[32]);

/* ---- wrap.c ---- */

enum { COLUMNS = 80 };

/* The width of a terminal. 0: it is none. */
int terminal_columns(FILE *to);

/* Print a text that begins in column `at`, and a newline. It is broken at spaces so that no line is longer than `width`
 * (0: not broken), and goes on in column `indent`. */
void print_wrapped(FILE *to, int at, int indent, int width, const char *text);

/* ---- stop.c ---- */

/* From now on Ctrl-C, SIGTERM, SIGHUP and SIGXCPU ask the command to end; name: of the scene. The callback
 * progress_bar_show hears it. What has not ended a tenth of a second later, or at a second signal, is ended as it
 * stands. Both say how far it was, unless quiet, and end by the signal. */
void stop_begin(const char *name, bool quiet);
bool stop_asked(void);

/* After stop_begin: the command is stopped in so many seconds, as if by Ctrl-C, and ends with EXIT_TIME. */
void stop_after(double seconds);

/* What is done now, and how much of it. */
void stop_note(const char *what, double share);

/* What there is if the command is stopped now: "nothing written". */
void stop_outcome(const char *fmt, ...) CLI_PRINTF(1, 2);

/* End, if that was asked for. */
void stop_end(void);

/* Print a message on stderr. On a terminal its first line is broken to the terminal's width; those below show a place
 * of a file, and stay. Elsewhere it is one line, for editors and scripts. */
void print_message(const char *message);

/* ---- progress_bar.c ---- */

/* Seconds since an arbitrary time. */
double clock_now(void);

/* A bar on stderr with the share done, the rate and the time left. Off where stderr is not a terminal. */
typedef struct progress_bar {
    bool on, drawn;
    double start, shown; /* when this step began, and when the bar was last drawn */
    long pixels;         /* of the picture; 0: loading */
    const char *name;    /* of the scene */
    char what[16];       /* the current step */
    double first;        /* share that was done when it began: not 0 where a picture is resumed */
} progress_bar;

void progress_bar_start(progress_bar *p, bool quiet, const char *name, long pixels);
void progress_bar_end(progress_bar *p);

/* The callback, a kage_progress. user: the bar. It ends the call where stop_asked. */
int progress_bar_show(void *user, const char *what, double share);

#endif
