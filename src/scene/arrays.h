/* Images and models that a program hands to the library in memory, by name, in place of files. They are copies, which
 * scenes share. */
#ifndef KAGE_SCENE_ARRAYS_H
#define KAGE_SCENE_ARRAYS_H

#include "image/array.h"
#include "mesh/mesh_data.h"

/* What a scene says in place of a file's name: this, then the array's name. */
#define ARRAY_PREFIX "array:"

/* One of the two. */
typedef struct scene_array {
    int others; /* base/shared.h */
    char *name;
    bool is_mesh;
    image_array image;
    mesh_array mesh;
    void *memory; /* of all samples or numbers; owned */
} scene_array;

typedef struct arrays {
    scene_array **item;
    int count;
} arrays;

/* Add a copy of an image or a model, in place of an array of this kind and name. m: what it is taken from; NULL: no
 * limit. False: out of memory. */
bool arrays_add_image(arrays *a, const char *name, const image_array *from, memory *m);
bool arrays_add_mesh(arrays *a, const char *name, const mesh_array *mesh, memory *m);

/* Add those of another set. They are not copied. */
bool arrays_add_all(arrays *a, const arrays *from);

/* NULL: there is none. */
const scene_array *arrays_find(const arrays *a, bool is_mesh, const char *name);

void arrays_free(arrays *a);

#endif
