/* The list of a scene's changes, PATH=VALUE each, as it grows. */
#include "api/api.h"

#include <stdlib.h>
#include <string.h>

/* Letters of the path; 0: it is none. */
static size_t path_size(const char *set) { return set[strcspn(set, "=")] ? strcspn(set, "=") : 0; }

/* Whether a's path is the beginning of b's: that of something that has b's in it. */
static bool holds(const char *a, const char *b)
{
    const size_t n = path_size(a);
    return n > 0 && path_size(b) > n && strncmp(a, b, n) == 0 && b[n] == '.';
}

static bool is_same(const char *a, const char *b)
{
    const size_t n = path_size(a);
    return n > 0 && path_size(b) == n && strncmp(a, b, n) == 0;
}

/* The last change of the same path, after which none of what holds it follows; -1: there is none. */
static int find(const kage_scene *k, const char *set)
{
    for (int i = k->sets - 1; i >= 0 && !holds(k->set[i], set); i--)
        if (is_same(k->set[i], set))
            return i;
    return -1;
}

bool sets_put(kage_scene *k, const char *set)
{
    char *new = strdup(set);
    const int at = find(k, set);
    if (!new)
        return false;
    if (at < 0) {
        k->set[k->sets++] = new;
        return true;
    }
    free(k->set[at]);
    k->set[at] = new;
    int n = at + 1;
    for (int i = n; i < k->sets; i++) /* what it holds was changed before it */
        if (holds(set, k->set[i]))
            free(k->set[i]);
        else
            k->set[n++] = k->set[i];
    k->sets = n;
    return true;
}
