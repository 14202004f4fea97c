/* Names of things: materials and objects. Objects are found by hashing: a scene may have a hundred thousand. */
#include "base/spelling.h"
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

/* ---- things that a node names ---- */

/* The name of thing i: each is a struct of `size` bytes that begins with its name, or NULL. */
static const char *name_of(const void *things, size_t size, int i)
{
    return *(char *const *)(const void *)((const char *)things + (size_t)i * size);
}

int reader_find(reader *r, node *at, const char *what, const char *among, const void *things, size_t size, int n)
{
    const char *name = yaml_text(r->y, at, what), *thing = strrchr(what, ' ') + 1;
    char near[64], *all;
    size_t length = 1;
    if (!name)
        return -1;
    for (int i = 0; i < n; i++) {
        const char *its = name_of(things, size, i);
        if (its && strcmp(name, its) == 0)
            return i;
        length += its ? strlen(its) + 1 : 0;
    }
    if ((all = calloc(1, length)))
        for (int i = 0; i < n; i++)
            if (name_of(things, size, i))
                strcat(strcat(all, *all ? " " : ""), name_of(things, size, i));
    spelling_nearest(name, all ? all : "", near, sizeof near);
    yaml_error(r->y, at, "no %s '%.60s'%s%s%s%s", thing, name,
               *near ? ", did you mean '" : ", expected one of those under '", *near ? near : among, "'",
               *near ? "?" : "");
    free(all);
    return -1;
}

int reader_material(reader *r, node *at)
{
    const scene *s = r->s;
    return reader_find(r, at, "the name of a material", "materials", s->material, sizeof *s->material, s->materials);
}
