/* A reader over a text, for tests of the scene reader's parts. */
#ifndef KAGE_READING_H
#define KAGE_READING_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "read/values.h"
#include "support/check.h"

/* What a test reads from; reading_end frees it. */
typedef struct reading {
    reader r;
    scene s;
    errors e;
    scene_source from;
    char path[32];
} reading;

static inline reading *reading_of(const char *text)
{
    reading *t = calloc(1, sizeof *t);
    assert_non_null(t);
    strcpy(t->path, "/scenes/test.yaml");
    t->s.path = t->path;
    t->from = (scene_source){.path = t->path, .text = text, .size = strlen(text)};
    t->r = (reader){.y = yaml_open(t->path, text, strlen(text), 0, NULL, "", NULL, &t->e),
                    .s = &t->s,
                    .e = &t->e,
                    .from = &t->from};
    assert_non_null(t->r.y);
    return t;
}

/* The value of a key at the top. */
static inline node *reading_at(const reading *t, const char *key) { return yaml_get(yaml_root(t->r.y), key); }

/* Whether the only error has this text in it; no error where it is NULL. */
static inline void reading_told(const reading *t, const char *error)
{
    assert_int_equal(t->e.count, error != NULL);
    if (error && !strstr(t->e.text, error))
        fail_msg("'%s', expected '%s' in it", t->e.text, error);
}

static inline void reading_end(reading *t)
{
    yaml_close(t->r.y);
    errors_free(&t->e);
    files_free(&t->s.made_from);
    free(t);
}

#endif
