/* A look as changes of the scene, PATH=VALUE as for --set. */
#ifndef KAGE_LOOK_CHANGES_H
#define KAGE_LOOK_CHANGES_H

#include "look/state.h"

enum { CHANGE_SIZE = 192, CHANGES_MOST = 2 * VIEW_MOST + 12 };

typedef struct changes {
    char text[CHANGES_MOST][CHANGE_SIZE];
    const char *list[CHANGES_MOST]; /* of text, for kage_load_options */
    int count;
} changes;

/* Each picture of a scene without antialiasing ends with this one. */
#define CHANGES_AA 3
#define CHANGES_AA_THRESHOLD 0.1

/* The changes that make the look of a scene, s, as read from its file. Lights and bumps that it lacks are left out.
 * finished: with the antialiasing above where the scene has none, as a saved scene has. */
void changes_make(changes *c, const look *l, const kage_scene_info *s, bool finished);

#endif
