/* The names of objects, found by hashing: a scene may have a hundred thousand. */
#include "read/parts.h"

#include <stdlib.h>
#include <string.h>

/* FNV-1a. */
static uint32_t hash_of(const char *name)
{
    uint32_t h = 2166136261u;
    for (; *name; name++)
        h = (h ^ (unsigned char)*name) * 16777619u;
    return h;
}

bool names_begin(names *n, int count)
{
    n->size = 16;
    while (n->size < 2 * (uint32_t)count)
        n->size *= 2;
    n->slot = calloc(n->size, sizeof *n->slot);
    return n->slot != NULL;
}

/* Where the name is, or could be. */
static uint32_t slot_of(const names *n, const object *o, const char *name)
{
    uint32_t k = hash_of(name) & (n->size - 1);
    while (n->slot[k] && strcmp(o[n->slot[k] - 1].name, name) != 0)
        k = (k + 1) & (n->size - 1);
    return k;
}

int names_find(const names *n, const object *o, const char *name) { return n->slot[slot_of(n, o, name)] - 1; }

bool names_add(names *n, const object *o, int i)
{
    const uint32_t k = slot_of(n, o, o[i].name);
    if (n->slot[k])
        return false;
    n->slot[k] = i + 1;
    return true;
}

void names_free(names *n)
{
    free(n->slot);
    n->slot = NULL;
}
