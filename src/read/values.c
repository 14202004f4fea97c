/* The small readers of values, names and files. */
#include "read/values.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* "there is not enough memory", and what is needed. */
static const char *memory_needed(const reader *r, char text[MEMORY_WORDS])
{
    return memory_words(reader_memory(r), text);
}

void *reader_made(reader *r, void *p)
{
    char words[MEMORY_WORDS];
    if (!p && r->now)
        yaml_error(r->y, r->now, "%s", memory_needed(r, words));
    else if (!p)
        errors_add(r->e, "%s: %s", r->from->path, memory_needed(r, words));
    return p;
}

char *reader_copy(reader *r, const char *text) { return text ? reader_made(r, strdup(text)) : NULL; }

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

bool reader_pair(reader *r, node *map, const char *key, double lo, const char *what, double x[2])
{
    node *at = yaml_get(map, key);
    return !at || yaml_numbers(r->y, at, 2, lo, BIG, what, x);
}

bool reader_counts(reader *r, node *map, const char *key, int hi, const char *what, int x[2])
{
    double n[2];
    node *at = yaml_get(map, key);
    if (!at)
        return true;
    if (!yaml_numbers(r->y, at, 2, 1, hi, what, n))
        return false;
    if (n[0] != floor(n[0]) || n[1] != floor(n[1]))
        return yaml_error(r->y, at, "no whole numbers, expected %s", what);
    x[0] = (int)n[0];
    x[1] = (int)n[1];
    return true;
}

int reader_word(reader *r, node *map, const char *key, const char *words, const char *what)
{
    node *at = yaml_get(map, key);
    return at ? yaml_word(r->y, at, words, what) : 0;
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

bool reader_either(reader *r, node *map, const char *noun, const char *a, const char *b)
{
    const bool has_a = yaml_get(map, a), has_b = yaml_get(map, b);
    return has_a != has_b || yaml_error(r->y, map, "%s with %s %s %s %s, expected either '%s' or '%s'", noun,
                                        has_a ? "both" : "neither", a, has_a ? "and" : "nor", b, a, b);
}

bool reader_look(reader *r, node *map, const char *who, const char *what, vec3 *from, vec3 *to, vec3 *up)
{
    bool good = reader_need_all(r, map, "from at", what);
    good = reader_vector(r, map, "from", "the eye's place [x, y, z]", from) && good;
    good = reader_vector(r, map, "at", "the place looked at [x, y, z]", to) && good;
    good = reader_vector(r, map, "up", "a direction [x, y, z]", up) && good;
    if (good && vec3_length(vec3_sub(*to, *from)) < SMALL)
        return yaml_error(r->y, yaml_get(map, "at"), "%s looks at its own place, expected 'at' apart from 'from'", who);
    return good && reader_has_length(r, map, "up", "a vector", *up);
}

bool reader_up_along(reader *r, node *map)
{
    node *up = yaml_get(map, "up");
    return yaml_error(r->y, up ? up : map, "'up' is along the view, expected a direction across it%s",
                      up ? "" : " (it is [0, 1, 0])");
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
        reader_made(r, NULL);
    return path;
}

char *reader_input(reader *r, node *file, const char *name)
{
    const cap most = reader_limit(r, LIMIT_FILE, FILES_MOST);
    char *path = reader_beside(r, name);
    struct stat about;
    if (!path || stat(path, &about) != 0 || !S_ISREG(about.st_mode) || about.st_size <= most.most)
        return path;
    yaml_error(r->y, file, "'%s' can't be used: it has %lld bytes, expected at most %lld%s", name,
               (long long)about.st_size, (long long)most.most, most.by);
    free(path);
    return NULL;
}

/* Few letters are allowed: names are used in --set and as layers of the image. */
char *reader_plain_name(reader *r, node *key)
{
    const char *name = yaml_text(r->y, key, "a name");
    if (!name)
        return NULL;
    if (strlen(name) <= 59 && !name[strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-")])
        return reader_copy(r, name);
    yaml_error(r->y, key, "'%.60s' can't be a name, expected up to 59 letters, digits, _ and -", name);
    return NULL;
}

char *reader_name(reader *r, node *map, node *key)
{
    char *name = reader_plain_name(r, key);
    if (!name || yaml_first(map, name) == key)
        return name;
    reader_second(r, key, name);
    free(name);
    return NULL;
}

bool reader_second(reader *r, node *key, const char *name)
{
    return yaml_error(r->y, key, "a second '%s', expected each name once", name);
}

node *reader_named(reader *r, const char *key, cap most, size_t size, void *items_at, int *count)
{
    node *at = yaml_need(r->y, yaml_root(r->y), key, "the scene");
    if (!at || !yaml_map(r->y, at, key, NULL))
        return NULL;
    int n = yaml_size(at);
    if (n > most.most) {
        yaml_error(r->y, at, "%d %s, expected at most %d%s", n, key, (int)most.most, most.by);
        return NULL;
    }
    void *items = reader_made(r, calloc((size_t)(n ? n : 1), size));
    if (!items)
        return NULL;
    memcpy(items_at, &items, sizeof items);
    *count = n;
    return at;
}

bool reader_usable(reader *r, node *file, const char *name, bool was_read, int width, int height, const char *values,
                   errors *e)
{
    if (!was_read)
        yaml_error(r->y, file, "'%s' can't be used: %.*s", name, e->size ? (int)e->size - 1 : 0,
                   e->text ? e->text : "");
    else if (width < 2 || height < 2)
        was_read = yaml_error(r->y, file, "'%s' has %d x %d %s, expected at least 2 x 2", name, width, height, values);
    errors_free(e);
    return was_read;
}

expr *reader_expr(reader *r, node *at, const char *what)
{
    expr_error wrong;
    const char *text = yaml_text(r->y, at, what);
    expr *e = text ? expr_parse_within(progress_limits(r->from->progress), text, &wrong) : NULL;
    if (text && !e)
        yaml_error_in(r->y, at, wrong.offset, "%s", wrong.message);
    return e;
}
