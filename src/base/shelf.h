/* Things that are slow to make, each under a key that says all that it is made from. A scene that is made from another
 * finds them on that one's shelf and puts them on its own. A thing lives as long as one shelf has it.
 *
 * A shelf is filled by one thread. After that it does not change, and any number may look.
 */
#ifndef KAGE_BASE_SHELF_H
#define KAGE_BASE_SHELF_H

#include <stdbool.h>

typedef struct shelf_item shelf_item;

/* Zero-initialise. */
typedef struct shelf {
    shelf_item **item;
    int *slot; /* of a hash table: an index + 1; 0: free */
    int count, slots;
} shelf;

/* The item with a key. NULL: there is none. */
shelf_item *shelf_find(const shelf *s, const char *key);

/* Whether an item's key is there. */
bool shelf_has(const shelf *s, const shelf_item *x);

/* What was put there. */
void *shelf_thing(const shelf_item *x);

/* Put a thing on the shelf under a key that is not there yet. The shelf owns it, also on failure. False: out of
 * memory. */
bool shelf_put(shelf *s, const char *key, void *thing, void (*free_thing)(void *thing));

/* Put what is on another shelf on this one, too. */
bool shelf_put_shared(shelf *s, shelf_item *x);

void shelf_free(shelf *s);

#endif
