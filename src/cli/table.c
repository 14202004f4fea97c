/* kage table: the tables as JSON, from which scripts/man.py makes the manuals. */
#include "cli/options.h"

#include <stdio.h>

static void print_text(const char *text)
{
    putchar('"');
    for (const char *c = text; *c; c++)
        if (*c == '\n')
            printf("\\n");
        else
            printf(*c == '"' || *c == '\\' ? "\\%c" : "%c", *c);
    putchar('"');
}

static void print_field(const char *name, const char *text)
{
    printf("\"%s\": ", name);
    print_text(text ? text : "");
    printf(", ");
}

static void print_list(const char *name, const char *const *text, int most)
{
    printf("\"%s\": [", name);
    for (int k = 0; k < most && text[k]; k++) {
        printf(k ? ", " : "");
        print_text(text[k]);
    }
    printf("]");
}

int command_table(void)
{
    printf("{\"version\": \"%s\", \"commands\": [", kage_version());
    for (int k = 0; k < command_count; k++) {
        const command *c = &commands[k];
        printf("%s\n  {", k ? "," : "");
        print_field("name", c->name);
        print_field("text", c->text);
        print_field("more", c->more);
        printf("\"bit\": %d, \"needed\": %d, \"hidden\": %s, ", c->bit, c->needed, c->hidden ? "true" : "false");
        print_list("operands", c->operand, 2);
        printf(", ");
        print_list("examples", c->example, 8);
        printf("}");
    }
    printf("],\n\"headings\": [");
    for (int g = 0; g < OPTION_GROUPS; g++) {
        printf(g ? ", " : "");
        print_text(option_headings[g]);
    }
    printf("],\n\"options\": [");
    for (int k = 0; k < option_count; k++) {
        const option *o = &options[k];
        printf("%s\n  {", k ? "," : "");
        print_field("name", o->name);
        print_field("letter", o->letter);
        print_field("argument", o->argument);
        print_field("text", o->text);
        print_field("more", o->more);
        printf("\"commands\": %d, \"about\": %d}", o->commands, (int)o->about);
    }
    printf("],\n\"limits\": [");
    for (int k = 0; k < kage_limit_count(); k++) {
        const kage_limit l = kage_limit_get(k);
        char most[32];
        printf("%s\n  {", k ? "," : "");
        print_field("name", l.name);
        print_field("most", limit_text(&l, most));
        printf("\"text\": ");
        print_text(l.text);
        printf("}");
    }
    printf("],\n\"exit\": [");
    for (int k = 0; k < exit_meaning_count; k++) {
        printf("%s{\"status\": %d, \"text\": ", k ? ", " : "", exit_meanings[k].status);
        print_text(exit_meanings[k].text);
        printf("}");
    }
    printf("],\n\"methods\": [");
    for (int k = 0; k < kage_method_count(); k++) {
        printf("%s\n  {", k ? "," : "");
        print_field("name", kage_method_get(k).name);
        printf("\"text\": ");
        print_text(kage_method_get(k).text);
        printf("}");
    }
    printf("]}\n");
    return 0;
}
