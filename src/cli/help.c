/* What --help prints, from the tables. */
#include "cli/options.h"

#include <stdio.h>
#include <string.h>

enum { TEXT_AT = 26, NAME_AT = 6 };

/* Names in columns of their own, then the text. */
static void print_entry(const char *names, int text_at, const char *text)
{
    const int n = (int)strlen(names);
    printf("%s", names);
    if (n + 2 > text_at)
        printf("\n%*s", text_at, "");
    else
        printf("%*s", text_at - n, "");
    print_wrapped(stdout, text_at, text_at, COLUMNS, text);
}

static void print_option(const option *o)
{
    char names[128], text[1024];
    snprintf(names, sizeof names, "  %s%s%s%s%s", o->letter ? o->letter : "  ", o->letter ? ", " : "  ", o->name,
             o->argument ? " " : "", o->argument ? o->argument : "");
    int used = snprintf(text, sizeof text, "%s", o->text);
    for (int k = 0; o->values && strcmp(o->values, VALUES_LIMITS) == 0 && k < kage_limit_count(); k++) {
        const kage_limit l = kage_limit_get(k);
        char most[32];
        used += snprintf(text + used, sizeof text - (size_t)used, "%s %s %s",
                         k ? "," : ". WHAT, and the most without the option:", l.name, limit_text(&l, most));
    }
    print_entry(names, TEXT_AT, text);
}

static void print_options(int bits)
{
    for (int g = 0; g < OPTION_GROUPS; g++) {
        bool any = false;
        for (int k = 0; k < option_count; k++)
            if ((options[k].commands & bits) && options[k].about == (option_group)g) {
                if (!any)
                    printf("\n%s:\n", option_headings[g]);
                any = true;
                print_option(&options[k]);
            }
    }
}

static void print_synopsis(const command *c, const char *before)
{
    printf("%skage %s", before, c->name);
    for (int k = 0; k < 2 && c->operand[k]; k++)
        printf(k < c->needed ? " %s" : " [%s]", c->operand[k]);
    printf(" [OPTIONS]\n");
}

void print_command_help(const command *c)
{
    print_synopsis(c, "Usage: ");
    printf("\n%c", c->text[0] - 'a' + 'A');
    print_wrapped(stdout, 1, 0, COLUMNS, c->text + 1);
    print_options(c->bit);
    for (int k = 0; k < 8 && c->example[k]; k += 2) {
        if (k == 0)
            printf("\nExamples:\n");
        printf("  %s\n", c->example[k]);
        print_wrapped(stdout, printf("%*s", NAME_AT, ""), NAME_AT, COLUMNS, c->example[k + 1]);
    }
}

void print_help(FILE *to)
{
    fputs("kage renders shadows of other objects on bump-mapped surfaces, by Sumi and\nNoma's method.\n\n"
          "Usage: kage COMMAND [OPTIONS]\n\nCommands:\n",
          to);
    for (int k = 0; k < command_count; k++) {
        char names[64];
        const command *c = &commands[k];
        if (c->hidden)
            continue;
        snprintf(names, sizeof names, "%s%s%s%s%s", c->name, c->operand[0] ? " " : "",
                 c->operand[0] ? c->operand[0] : "", c->operand[1] ? " " : "", c->operand[1] ? c->operand[1] : "");
        fprintf(to, "  %-16s  ", names);
        print_wrapped(to, 20, 20, COLUMNS, c->text);
    }
    fputs("\n"
          "  kage COMMAND --help  the options of a command, and examples\n"
          "  kage --version       the version\n"
          "\n"
          "Begin with: kage render scenes/cube.yaml\n"
          "\n"
          "Manuals: man kage; man kage-scene describes scene files. The same and more is\n"
          "in docs/.\n"
          "Exit status: ",
          to);
    char text[256] = "";
    size_t used = 0;
    for (int k = 0; k < exit_meaning_count && used < sizeof text; k++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%d %s", k ? "; " : "", exit_meanings[k].status,
                                 exit_meanings[k].text);
    print_wrapped(to, (int)strlen("Exit status: "), 0, COLUMNS, text);
}
