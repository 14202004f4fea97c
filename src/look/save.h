/* Saves the picture, and the changed scene beside the scene, under new names. */
#ifndef KAGE_LOOK_SAVE_H
#define KAGE_LOOK_SAVE_H

#include "look/state.h"

typedef struct save_order {
    kage_scene *scene; /* as read from its file */
    const char *path;  /* of that file */
    const look *look;
    int threads;
    const kage_limits *limits;
    kage_progress *progress; /* may end it */
    void *user;
} save_order;

enum { SAVE_TEXT = 512 };

/* Write DIR/NAME-view-N.yaml and .png, for DIR/NAME.yaml and the first N that is free. The picture is that of the
 * written scene. text: what was written, or why not. */
bool save_picture(const save_order *o, char text[SAVE_TEXT]);

/* DIR/NAME of DIR/NAME.yaml: n letters of it. */
int save_stem(const char *path);

#endif
