/* The program kage: help, and the choice of the command. */
#include "cli/options.h"

#include <stdio.h>
#include <string.h>

#include "base/spelling.h"

/* Flush stdout. Returns the exit status. */
static int finish(int status)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return status;
    usage_error("standard output can't be written");
    return status ? status : EXIT_OUTPUT;
}

static int print_methods(void)
{
    for (int k = 0; k < kage_method_count(); k++)
        print_wrapped(stdout, printf("%-8s  ", kage_method_get(k).name), 10, COLUMNS, kage_method_get(k).text);
    return 0;
}

static int refuse_command(const char *name)
{
    char words[256] = "", near[32];
    size_t used = 0;
    for (int k = 0; k < command_count && used < sizeof words && !commands[k].hidden; k++)
        used += (size_t)snprintf(words + used, sizeof words - used, "%s%s", k ? " " : "", commands[k].name);
    spelling_nearest(name, words, near, sizeof near);
    if (*near)
        usage_error("no command '%s', did you mean '%s'? See kage --help", name, near);
    else
        usage_error("no command '%s', expected one of: %s; see kage --help", name, words);
    return EXIT_INPUT;
}

static int help_command(const arguments *a)
{
    const command *c = a->operands ? command_find(a->operand[0]) : NULL;
    if (a->operands && !c)
        return refuse_command(a->operand[0]);
    if (c)
        print_command_help(c);
    else
        print_help(stdout);
    /* The window's keys are known to its own program. */
    return c && c->bit == COMMAND_VIEW ? command_view_help() : 0;
}

static int run(const arguments *a)
{
    if (a->operands && a->command != COMMAND_VIEW && a->command != COMMAND_HELP) {
        stop_begin(base_name(a->operand[0]), a->quiet);
        stop_after(a->seconds);
    }
    switch (a->command) {
    case COMMAND_RENDER:
        return command_render(a);
    case COMMAND_CHECK:
        return command_check(a);
    case COMMAND_PIXEL:
        return command_pixel(a);
    case COMMAND_POV:
        return command_pov(a);
    case COMMAND_IMPORT:
        return command_import(a);
    case COMMAND_VIEW:
        return command_view(a);
    case COMMAND_METHODS:
        return print_methods();
    default:
        return help_command(a);
    }
}

/* Whether -h or --help is among the options. */
static bool asks_for_help(int argc, char **argv)
{
    for (int k = 2; k < argc && strcmp(argv[k], "--") != 0; k++)
        if (strcmp(argv[k], "--help") == 0 || strcmp(argv[k], "-h") == 0)
            return true;
    return false;
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        print_help(stderr);
        return EXIT_INPUT;
    }
    const char *name = argv[1];
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0)
        return finish(help_command(&(arguments){0}));
    if (strcmp(name, "--version") == 0) {
        printf("kage %s (%s)\n", kage_version(), kage_precision());
        return finish(0);
    }
    const command *c = command_find(name);
    if (!c)
        return refuse_command(name);
    if (c->bit == COMMAND_COMPLETE)
        return finish(command_complete(argc - 2, argv + 2));
    if (c->bit == COMMAND_TABLE)
        return finish(command_table());
    if (asks_for_help(argc, argv))
        return finish(help_command(&(arguments){.operands = 1, .operand = {name}}));
    arguments a;
    const int status = arguments_read(&a, argc, argv, c) ? run(&a) : EXIT_INPUT;
    arguments_free(&a);
    stop_end();
    return finish(status);
}
