/* The small readers of the scene reader. */
#include "read/values.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char *reader_copy(reader *r, const char *text)
{
    char *c = text ? strdup(text) : NULL;
    if (text && !c)
        errors_add(r->e, "out of memory");
    return c;
}

static bool read_three(reader *r, node *at, double lo, const char *what, vec3 *v)
{
    double x[3];
    if (!at)
        return true;
    if (!yaml_numbers(r->y, at, 3, lo, BIG, what, x))
        return false;
    *v = (vec3){x[0], x[1], x[2]};
    return true;
}

bool reader_vector(reader *r, node *map, const char *key, const char *what, vec3 *v)
{
    return read_three(r, yaml_get(map, key), -BIG, what, v);
}

bool reader_color(reader *r, node *map, const char *key, vec3 *v)
{
    return read_three(r, yaml_get(map, key), 0, "a linear colour [red, green, blue], 0 or more each", v);
}

bool reader_number(reader *r, node *map, const char *key, double lo, bool open, double hi, const char *what, double *x)
{
    node *at = yaml_get(map, key);
    return !at || yaml_number(r->y, at, lo, open, hi, what, x);
}

bool reader_has_length(reader *r, node *map, const char *key, const char *noun, vec3 v)
{
    return vec3_length(v) >= SMALL ||
           yaml_error(r->y, yaml_get(map, key), "no direction, expected %s with a length", noun);
}

bool reader_need_all(reader *r, node *map, const char *keys, const char *what)
{
    bool good = true;
    char key[32];
    for (size_t n; *keys; keys += n + (keys[n] == ' ')) {
        n = strcspn(keys, " ");
        snprintf(key, sizeof key, "%.*s", (int)n, keys);
        good = yaml_need(r->y, map, key, what) && good;
    }
    return good;
}

char *reader_beside(reader *r, const char *file)
{
    const char *folder = r->from->folder ? r->from->folder : r->s->path;
    size_t n = strlen(folder); /* of the folder, with its slash where it has one */
    if (!r->from->folder)
        while (n > 0 && folder[n - 1] != '/')
            n--;
    if (*file == '/')
        n = 0;
    const char *slash = n > 0 && folder[n - 1] != '/' ? "/" : "";
    const size_t size = n + strlen(file) + 2;
    char *path = malloc(size);
    if (path)
        snprintf(path, size, "%.*s%s%s", (int)n, folder, slash, file);
    if (!path || !files_add_path(&r->s->made_from, path))
        errors_add(r->e, "out of memory");
    return path;
}

/* Few letters are allowed: names are used in --set and as layers of the image. */
char *reader_name(reader *r, node *map, node *key)
{
    const char *name = yaml_text(r->y, key, "a name");
    if (!name)
        return NULL;
    if (strlen(name) > 59 || name[strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-")])
        yaml_error(r->y, key, "'%.60s' can't be a name, expected up to 59 letters, digits, _ and -", name);
    else if (yaml_first(map, name) != key)
        yaml_error(r->y, key, "a second '%s', expected each name once", name);
    else
        return reader_copy(r, name);
    return NULL;
}

node *reader_named(reader *r, const char *key, size_t size, void *array, int *count)
{
    node *at = yaml_need(r->y, yaml_root(r->y), key, "the scene");
    if (!at || !yaml_map(r->y, at, key, NULL))
        return NULL;
    int n = yaml_size(at);
    if (n > SCENE_MAX_ITEMS) {
        yaml_error(r->y, at, "%d %s, expected at most %d", n, key, SCENE_MAX_ITEMS);
        return NULL;
    }
    void *items = calloc((size_t)(n ? n : 1), size);
    if (!items) {
        errors_add(r->e, "out of memory");
        return NULL;
    }
    memcpy(array, &items, sizeof items);
    *count = n;
    return at;
}

expr *reader_expr(reader *r, node *at, const char *what)
{
    expr_error wrong;
    const char *text = yaml_text(r->y, at, what);
    expr *e = text ? expr_parse(text, &wrong) : NULL;
    if (text && !e)
        yaml_error_in(r->y, at, wrong.offset, "%s", wrong.message);
    return e;
}
