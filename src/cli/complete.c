/* kage complete: what may be typed next, for the completions of shells. It is silent about mistakes. */
#include "cli/options.h"

#include <stdio.h>
#include <string.h>

static bool begins(const char *text, const char *with) { return strncmp(text, with, strlen(with)) == 0; }

/* Offer a word of n letters, after `before` in the same argument, if it begins as what is typed. goes_on: no space. */
static void offer(const char *before, const char *typed, const char *word, int n, bool goes_on, const char *text)
{
    const int size = (int)strlen(typed);
    if (n >= size && strncmp(word, typed, (size_t)size) == 0)
        printf("%c%s%.*s\t%s\n", goes_on ? '+' : '=', before, n, word, text);
}

/* Words with spaces between them. Those that end in ':' go on. */
static void offer_words(const char *before, const char *typed, const char *words)
{
    for (const char *w = words; *w; w += strspn(w, " ")) {
        const int n = (int)strcspn(w, " ");
        offer(before, typed, w, n, w[n - 1] == ':', "");
        w += n;
    }
}

static void offer_methods(const char *before, const char *typed)
{
    for (int k = 0; k < kage_method_count(); k++) {
        const kage_method m = kage_method_get(k);
        const char *colon = strchr(m.name, ':');
        const bool needed = colon && colon[-1] != '['; /* iter:K, but auto[:E] */
        const int n = (int)(needed ? colon - m.name + 1 : (long)strcspn(m.name, "["));
        offer(before, typed, m.name, n, needed, m.text);
    }
}

/* Their values follow. */
static void offer_limits(const char *before, const char *typed)
{
    char word[64], text[128], most[32];
    for (int k = 0; k < kage_limit_count(); k++) {
        const kage_limit l = kage_limit_get(k);
        const int n = snprintf(word, sizeof word, "%s=", l.name);
        snprintf(text, sizeof text, "%s, %s at most", l.text, limit_text(&l, most));
        offer(before, typed, word, n, true, text);
    }
}

static void offer_commands(const char *typed)
{
    for (int k = 0; k < command_count; k++)
        if (!commands[k].hidden)
            offer("", typed, commands[k].name, (int)strlen(commands[k].name), false, commands[k].text);
}

/* ---- paths of --set ---- */

/* What is typed, and the last name that was offered: the names below one come one after another. */
typedef struct path_search {
    const char *before, *typed;
    char last[256];
} path_search;

/* The next name of a path. At its end comes the value. */
static void offer_path(void *user, const char *path, const char *value)
{
    path_search *s = user;
    const size_t size = strlen(s->typed);
    if (strncmp(path, s->typed, size) != 0)
        return;
    const size_t n = size + strcspn(path + size, ".");
    if (n >= sizeof s->last || (strncmp(path, s->last, n) == 0 && !s->last[n]))
        return;
    snprintf(s->last, sizeof s->last, "%.*s", (int)n, path);
    printf("+%s%s%s\t%s\n", s->before, s->last, path[n] || !value ? "." : "=", path[n] || !value ? "" : value);
}

/* The value that a path has in the file. */
static void offer_value(void *user, const char *path, const char *value)
{
    const path_search *s = user;
    if (value && strcmp(path, s->last) == 0 && begins(value, s->typed) && !strpbrk(value, "\t\n"))
        printf("=%s%s\tas in the file\n", s->before, value);
}

static void offer_values(const char *before, const char *typed, const char *values, const char *scene);

static void offer_set(const char *before, const char *typed, const char *scene)
{
    const char *equals = strchr(typed, '=');
    path_search s = {.before = before, .typed = typed};
    char start[512];
    if (!equals) {
        if (scene)
            kage_file_paths(scene, offer_path, &s, NULL);
        return;
    }
    snprintf(start, sizeof start, "%s%.*s", before, (int)(equals - typed + 1), typed);
    snprintf(s.last, sizeof s.last, "%.*s", (int)(equals - typed), typed);
    char name[64] = "--";
    if (begins(typed, "render.")) { /* as the option of that name */
        snprintf(name + 2, sizeof name - 2, "%.40s", s.last + strlen("render."));
        for (char *c = name; *c; c++)
            *c = *c == '_' ? '-' : *c;
        const option *o = option_find(COMMAND_RENDER, name, strlen(name));
        if (o && o->values) {
            offer_values(start, equals + 1, o->values, NULL);
            return;
        }
    }
    s = (path_search){.before = start, .typed = equals + 1};
    snprintf(s.last, sizeof s.last, "%.*s", (int)(equals - typed), typed);
    if (scene)
        kage_file_paths(scene, offer_value, &s, NULL);
}

/* ---- the command line ---- */

static void offer_values(const char *before, const char *typed, const char *values, const char *scene)
{
    if (!values)
        return;
    if (strcmp(values, VALUES_METHODS) == 0)
        offer_methods(before, typed);
    else if (strcmp(values, VALUES_LIMITS) == 0)
        offer_limits(before, typed);
    else if (strcmp(values, VALUES_COMMANDS) == 0)
        offer_commands(typed);
    else if (strcmp(values, VALUES_PATHS) == 0)
        offer_set(before, typed, scene);
    else if (strcmp(values, VALUES_LAYERS) == 0) {
        char start[512];
        const char *comma = strrchr(typed, ',');
        snprintf(start, sizeof start, "%s%.*s", before, comma ? (int)(comma - typed + 1) : 0, typed);
        offer_words(start, comma ? comma + 1 : typed, layer_names);
    } else if (values[0] == '.')
        printf(".%s\t%s\n", before, values);
    else
        offer_words(before, typed, values);
}

static void offer_options(const command *c, const char *typed)
{
    for (int k = 0; k < option_count; k++)
        if (options[k].commands & c->bit)
            offer("", typed, options[k].name, (int)strlen(options[k].name), false, options[k].text);
}

/* The option of an argument. NULL: it is none. */
static const option *option_of(const command *c, const char *arg)
{
    const bool is_long = begins(arg, "--");
    return arg[0] == '-' && arg[1] ? option_find(c->bit, arg, is_long ? strcspn(arg, "=") : 2) : NULL;
}

/* The words before the last one. */
typedef struct typed_words {
    const option *open; /* an option that waits for its value */
    const char *operand[2];
    int operands;
    bool ended; /* by -- */
} typed_words;

static typed_words read_words(const command *c, int count, char **word)
{
    typed_words t = {0};
    for (int k = 0; k < count; k++) {
        const option *o = t.ended || t.open ? NULL : option_of(c, word[k]);
        if (t.open)
            t.open = NULL;
        else if (!t.ended && strcmp(word[k], "--") == 0)
            t.ended = true;
        else if (o)
            t.open = o->read && strcmp(word[k], begins(word[k], "--") ? o->name : o->letter) == 0 ? o : NULL;
        else if (t.operands < 2)
            t.operand[t.operands++] = word[k];
    }
    return t;
}

int command_complete(int count, char **word)
{
    if (count < 1)
        return 0;
    const char *last = word[count - 1];
    const command *c = count > 1 ? command_find(word[0]) : NULL;
    if (!c) {
        if (count > 1)
            return 0;
        offer_commands(last);
        offer("", last, "--help", 6, false, "the commands");
        offer("", last, "--version", 9, false, "the version");
        return 0;
    }
    const typed_words t = read_words(c, count - 2, word + 1);
    const option *o = t.ended ? NULL : option_of(c, last);
    const char *scene = t.operand[0], *equals = strchr(last, '=');
    char before[64];
    if (t.open)
        offer_values("", last, t.open->values, scene);
    else if (o && o->read && (equals || !begins(last, "--"))) { /* --name=value, -oVALUE */
        const size_t n = begins(last, "--") && equals ? (size_t)(equals - last) + 1 : 2;
        snprintf(before, sizeof before, "%.*s", (int)n, last);
        offer_values(before, last + n, o->values, scene);
    } else if (last[0] == '-' && !t.ended)
        offer_options(c, last);
    else if (t.operands < 2)
        offer_values("", last, c->values[t.operands], scene);
    return 0;
}
