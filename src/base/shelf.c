/* Shelves as hash tables of items, which count their shelves. */
#include "base/shelf.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/shared.h"

struct shelf_item {
    int others; /* shared.h */
    char *key;
    void *thing;
    void (*free_thing)(void *thing);
};

static void drop(shelf_item *x)
{
    if (!shared_drop(&x->others))
        return;
    x->free_thing(x->thing);
    free(x->key);
    free(x);
}

/* FNV-1a. */
static uint32_t hash(const char *key)
{
    uint32_t h = 2166136261u;
    for (; *key; key++)
        h = (h ^ (unsigned char)*key) * 16777619u;
    return h;
}

/* The slot that has the key, or the free one where it belongs. */
static int slot_of(const shelf *s, const char *key)
{
    const uint32_t mask = (uint32_t)s->slots - 1;
    uint32_t at = hash(key) & mask;
    while (s->slot[at] && strcmp(s->item[s->slot[at] - 1]->key, key) != 0)
        at = (at + 1) & mask;
    return (int)at;
}

shelf_item *shelf_find(const shelf *s, const char *key)
{
    const int at = s->slots ? s->slot[slot_of(s, key)] : 0;
    return at ? s->item[at - 1] : NULL;
}

bool shelf_has(const shelf *s, const shelf_item *x) { return shelf_find(s, x->key); }

void *shelf_thing(const shelf_item *x) { return x->thing; }

/* Room for one more, at most half of the slots being used. */
static bool grow(shelf *s)
{
    if (2 * (s->count + 1) <= s->slots)
        return true;
    const int slots = s->slots ? 2 * s->slots : 16;
    int *slot = calloc((size_t)slots, sizeof *slot);
    shelf_item **item = slot ? realloc(s->item, sizeof(shelf_item *) * (size_t)slots / 2) : NULL;
    if (!item) {
        free(slot);
        return false;
    }
    free(s->slot);
    s->item = item;
    s->slot = slot;
    s->slots = slots;
    for (int k = 0; k < s->count; k++)
        slot[slot_of(s, item[k]->key)] = k + 1;
    return true;
}

static bool add(shelf *s, shelf_item *x)
{
    if (!grow(s)) {
        drop(x);
        return false;
    }
    const int at = slot_of(s, x->key);
    s->item[s->count++] = x;
    s->slot[at] = s->count;
    return true;
}

bool shelf_put(shelf *s, const char *key, void *thing, void (*free_thing)(void *thing))
{
    shelf_item *x = calloc(1, sizeof *x);
    char *copy = strdup(key);
    if (!x || !copy) {
        free(x);
        free(copy);
        free_thing(thing);
        return false;
    }
    *x = (shelf_item){0, copy, thing, free_thing};
    return add(s, x);
}

bool shelf_put_shared(shelf *s, shelf_item *x)
{
    shared_add(&x->others);
    return add(s, x);
}

void shelf_free(shelf *s)
{
    for (int k = 0; k < s->count; k++)
        drop(s->item[k]);
    free(s->item);
    free(s->slot);
    *s = (shelf){0};
}
