/* What a scene is made from by name, files and arrays in memory, and what other scenes have made from the same. */
#define _GNU_SOURCE /* nanoseconds in struct stat */
#include "read/parts.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The error that there is no such array. Always false. */
static bool unknown_array(reader *r, node *file, bool is_mesh, const char *name)
{
    const arrays *all = r->from->arrays;
    char known[400] = "";
    size_t n = 0;
    for (int k = 0; all && k < all->count && n + 64 < sizeof known; k++)
        if (all->item[k]->is_mesh == is_mesh)
            n += (size_t)snprintf(known + n, sizeof known - n, "%s%s", n ? ", " : "", all->item[k]->name);
    return yaml_error(r->y, file, "no array '%.60s' of %s is given, expected %s%s", name,
                      is_mesh ? "a model" : "samples", n ? "one of: " : "a file's name, as none is given", known);
}

/* The file, and what tells whether it has changed. */
static void identify(source *to)
{
    struct stat about;
    if (stat(to->path, &about) == 0 && S_ISREG(about.st_mode))
        snprintf(to->id, sizeof to->id, "file %llx %llx %lld %lld.%09ld", (unsigned long long)about.st_dev,
                 (unsigned long long)about.st_ino, (long long)about.st_size, (long long)about.st_mtim.tv_sec,
                 about.st_mtim.tv_nsec);
}

bool reader_source(reader *r, node *file, bool is_mesh, const char *what, source *to)
{
    const size_t prefix = strlen(ARRAY_PREFIX);
    *to = (source){.name = yaml_text(r->y, file, what)};
    if (!to->name)
        return false;
    if (strncmp(to->name, ARRAY_PREFIX, prefix) != 0) {
        to->path = reader_input(r, file, to->name);
        if (to->path)
            identify(to);
        return to->path;
    }
    to->array = arrays_find(r->from->arrays, is_mesh, to->name + prefix);
    if (!to->array)
        return unknown_array(r, file, is_mesh, to->name + prefix);
    snprintf(to->id, sizeof to->id, "array %p", (const void *)to->array);
    return true;
}

void source_free(source *s) { free(s->path); }

/* ---- shared with other scenes ---- */

char *reader_key(reader *r, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    const int n = vsnprintf(NULL, 0, fmt, args);
    va_end(args);
    char *key = reader_made(r, malloc((size_t)n + 1));
    va_start(args, fmt);
    if (key)
        vsnprintf(key, (size_t)n + 1, fmt, args);
    va_end(args);
    return key;
}

void *reader_found(reader *r, const char *key)
{
    shelf_item *x = key ? shelf_find(&r->s->shelf, key) : NULL;
    if (x || !key)
        return x ? shelf_thing(x) : NULL;
    for (int k = 0; !x && k < r->from->shelves; k++)
        x = shelf_find(r->from->shelf[k], key);
    if (!x)
        return NULL;
    return shelf_put_shared(&r->s->shelf, x) ? shelf_thing(x) : reader_made(r, NULL);
}

static void free_surface(void *f) { surface_free(f); }

bool reader_keep(reader *r, const char *key, void *thing, void (*free_thing)(void *thing))
{
    if (!key)
        free_thing(thing);
    return key && (shelf_put(&r->s->shelf, key, thing, free_thing) || reader_made(r, NULL));
}

surface *reader_found_surface(reader *r, const char *key)
{
    surface *f = reader_found(r, key);
    return f ? surface_share(f) : NULL;
}

surface *reader_keep_surface(reader *r, const char *key, surface *f)
{
    if (!f || !key || reader_keep(r, key, surface_share(f), free_surface))
        return f;
    surface_free(f);
    return NULL;
}

static void free_bump(void *p) { bump_free(p); }

bump *reader_found_bump(reader *r, const char *key)
{
    bump *p = reader_found(r, key);
    return p ? bump_share(p) : NULL;
}

bump *reader_keep_bump(reader *r, const char *key, bump *p)
{
    if (!p || !key || reader_keep(r, key, bump_share(p), free_bump))
        return p;
    bump_free(p);
    return NULL;
}
