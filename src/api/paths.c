/* kage_file_paths: the paths of a scene's values. */
#include "api/api.h"

#include "yaml/yaml.h"

#include <stdio.h>
#include <string.h>

/* Beyond these nothing is told: no scene has so deep or so long lists of values that one would change by hand. */
enum { MOST_PATH = 256, MOST_DEPTH = 12, MOST_ITEMS = 64 };

/* path: the one of `at`, of `used` letters, with room for MOST_PATH. */
typedef struct telling {
    yaml *y;
    kage_path_call *call;
    void *user;
    char path[MOST_PATH];
} telling;

static void tell(telling *t, node *at, size_t used, int depth);

/* Tell what is in a map or a list, under this name. */
static void tell_below(telling *t, node *at, const char *name, size_t used, int depth)
{
    const int n = snprintf(t->path + used, MOST_PATH - used, "%s%s", used ? "." : "", name);
    if (at && n > 0 && (size_t)n < MOST_PATH - used)
        tell(t, at, used + (size_t)n, depth + 1);
    t->path[used] = 0;
}

static void tell(telling *t, node *at, size_t used, int depth)
{
    const bool map = yaml_is_map(at), list = yaml_is_list(at);
    if (depth)
        t->call(t->user, t->path, map || list ? NULL : yaml_text(t->y, at, "a value"));
    if (depth == MOST_DEPTH)
        return;
    for (int k = 0, n = map ? yaml_size(at) : 0; k < n && k < 16 * MOST_ITEMS; k++) {
        node *key;
        node *value = yaml_pair(at, k, &key);
        const char *name = yaml_text(t->y, key, "a key");
        if (name && !strpbrk(name, ".= \t\n"))
            tell_below(t, value, name, used, depth);
    }
    for (int k = 0, n = list ? yaml_list(t->y, at, "a list") : 0; k < n && k < MOST_ITEMS; k++) {
        char number[16];
        snprintf(number, sizeof number, "%d", k);
        tell_below(t, yaml_item(at, k), number, used, depth);
    }
}

kage_status kage_file_paths(const char *path, kage_path_call *call, void *user, kage_errors **to)
{
    errors e = {0};
    telling t = {.y = yaml_open(path, NULL, 0, 0, NULL, "", NULL, &e), .call = call, .user = user};
    const bool good = t.y;
    if (good) {
        tell(&t, yaml_root(t.y), 0, 0);
        yaml_close(t.y);
        errors_free(&e); /* of values that are no scalar, map or list */
        e = (errors){0};
    }
    return errors_give(&e, good ? KAGE_OK : KAGE_BAD_INPUT, NULL, to);
}
