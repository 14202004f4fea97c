/* Reads the command line, by the table of options. */
#include "cli/options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/spelling.h"

/* Name the option that was perhaps meant. */
static bool refuse_option(const arguments *a, const char *arg, size_t size)
{
    char words[1024] = "", near[32] = "";
    size_t used = 0;
    for (int k = 0; k < option_count; k++)
        if ((options[k].commands & a->command) && used < sizeof words)
            used += (size_t)snprintf(words + used, sizeof words - used, "%s%s", used ? " " : "", options[k].name);
    char name[SPELLING_LONGEST + 2];
    snprintf(name, sizeof name, "%.*s", (int)size, arg);
    if (size > 2)
        spelling_nearest(name, words, near, sizeof near);
    return usage_error("%.*s: no option of 'kage %s'%s%s%s kage %s --help", (int)size, arg, a->name,
                       *near ? ", did you mean '" : "", near, *near ? "'? See" : "; see", a->name);
}

/* An option without a value. */
static bool raise_flag(arguments *a, const option *o)
{
    for (int c = 0; c < 3 && o->change[c]; c++)
        if (!add_set(a, "%s", o->change[c]))
            return false;
    if (!o->change[0])
        *(bool *)((char *)a + o->flag) = true;
    return true;
}

/* Read the option at argv[*k] (--name, --name=value, -n, -nVALUE), and its value, which may be the next argument. */
static bool read_option(arguments *a, int argc, char **argv, int *k)
{
    const char *arg = argv[*k], *value = NULL;
    const bool is_long = strncmp(arg, "--", 2) == 0;
    const size_t size = is_long ? strcspn(arg, "=") : 2;
    const option *o = option_find(a->command, arg, size);
    if (!o)
        return refuse_option(a, arg, is_long ? size : strlen(arg));
    if (arg[size])
        value = arg + size + is_long;
    if (!o->read)
        return value ? usage_error("%.*s takes no value; see kage %s --help", (int)size, arg, a->name)
                     : raise_flag(a, o);
    if (!value && *k + 1 == argc)
        return usage_error("%s lacks its value; see kage %s --help", arg, a->name);
    char name[SPELLING_LONGEST + 1];
    snprintf(name, sizeof name, "%.*s", (int)size, arg);
    return o->read(a, name, value ? value : argv[++*k]);
}

bool arguments_read(arguments *a, int argc, char **argv, const struct command *c)
{
    bool ended = false; /* by --: what follows are operands */
    *a = (arguments){.name = c->name, .command = c->bit, .bits = 8};
    for (int k = 2; k < argc; k++) {
        char *arg = argv[k];
        if (!ended && strcmp(arg, "--") == 0)
            ended = true;
        else if (!ended && arg[0] == '-' && arg[1]) {
            if (!read_option(a, argc, argv, &k))
                return false;
        } else {
            if (a->operands == 2 || !c->operand[a->operands])
                return usage_error("%s: one argument too many; see kage %s --help", arg, a->name);
            a->operand[a->operands++] = arg;
        }
    }
    return a->operands >= c->needed ||
           usage_error("'kage %s' lacks its %s; see kage %s --help", a->name, c->operand[a->operands], a->name);
}

void arguments_free(arguments *a)
{
    for (int k = 0; k < a->sets; k++)
        free(a->set[k]);
}
