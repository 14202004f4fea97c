/* One table of commands and one of options. The parser, `--help`, the manual pages and the completions of shells come
 * from these, so that they can't differ.
 */
#ifndef KAGE_CLI_OPTIONS_H
#define KAGE_CLI_OPTIONS_H

#include <stddef.h>

#include "cli/command.h"

/* A command and its operands. Texts: `text` is a line of --help; `more`, in the manual only, has paragraphs with \n\n
 * between them, in which names stand between backquotes. */
typedef struct command {
    const char *name;
    int bit;
    const char *operand[2]; /* NULL: none */
    int needed;             /* how many of these must be given */
    const char *values[2];  /* of the operands, as below */
    bool hidden;            /* for scripts: not in --help */
    const char *text, *more;
    const char *example[2 * 4]; /* a line to type, and what it does */
} command;

/* What an option is about. The table is in this order, and --help has a heading for each. */
typedef enum option_group {
    ABOUT_SHADOWS,
    ABOUT_PICTURE,
    ABOUT_FILES,
    ABOUT_MODEL,
    ABOUT_RUN,
    OPTION_GROUPS
} option_group;

/* Values that a shell may offer: words with spaces between them; endings of files, if they begin with a dot; or one of
 * these. A word that ends in ':' goes on. NULL: none. */
#define VALUES_METHODS "@methods"
#define VALUES_PATHS "@paths"
#define VALUES_LAYERS "@layers"
#define VALUES_COMMANDS "@commands"
#define VALUES_LIMITS "@limits" /* --help lists them behind the text */

typedef struct option {
    const char *name, *letter; /* "--output", "-o"; letter: NULL: none */
    const char *argument;      /* "FILE"; NULL: it has no value */
    int commands;              /* that have it, as bits */
    option_group about;
    /* One of three: what reads the value; changes of the scene; the offset of a bool in `arguments`. `name`: as typed.
     */
    bool (*read)(arguments *a, const char *name, const char *value);
    const char *change[3];
    size_t flag;
    const char *values, *text, *more;
} option;

extern const command commands[];
extern const int command_count;
extern const option options[];
extern const int option_count;
extern const char *const option_headings[OPTION_GROUPS];

/* Numbers and what they mean. */
typedef struct exit_meaning {
    int status;
    const char *text;
} exit_meaning;
extern const exit_meaning exit_meanings[];
extern const int exit_meaning_count;

/* The planes' names for --layers, with spaces between them. */
extern const char layer_names[];

const command *command_find(const char *name); /* NULL: no such command */

/* By its name or letter, of `size` letters. NULL: the command has no such option. */
const option *option_find(int bits, const char *name, size_t size);

/* ---- values.c: reads values. False: the mistake is on stderr ---- */

/* Add a change of the scene. */
bool add_set(arguments *a, const char *fmt, ...) CLI_PRINTF(2, 3);

bool read_picture(arguments *a, const char *name, const char *v);
bool read_pov(arguments *a, const char *name, const char *v);
bool read_scene(arguments *a, const char *name, const char *v);
bool read_shadow(arguments *a, const char *name, const char *v);
bool read_surface(arguments *a, const char *name, const char *v);
bool read_shade(arguments *a, const char *name, const char *v);
bool read_bump_shadow(arguments *a, const char *name, const char *v);
bool read_size(arguments *a, const char *name, const char *v);
bool read_aa(arguments *a, const char *name, const char *v);
bool read_threshold(arguments *a, const char *name, const char *v);
bool read_crop(arguments *a, const char *name, const char *v);
bool read_threads(arguments *a, const char *name, const char *v);
bool read_memory(arguments *a, const char *name, const char *v);
bool read_limit(arguments *a, const char *name, const char *v);
bool read_seconds(arguments *a, const char *name, const char *v);
bool read_frames(arguments *a, const char *name, const char *v);
bool read_layers(arguments *a, const char *name, const char *v);
bool read_bits(arguments *a, const char *name, const char *v);
bool read_set(arguments *a, const char *name, const char *v);
bool read_bump(arguments *a, const char *name, const char *v);
bool read_camera(arguments *a, const char *name, const char *v);
bool read_up(arguments *a, const char *name, const char *v);
bool read_brightness(arguments *a, const char *name, const char *v);

#endif
