/* The values under the mouse, as `kage pixel` has them: one line, and a table of all methods. */
#ifndef KAGE_LOOK_READOUT_H
#define KAGE_LOOK_READOUT_H

#include "look/state.h"

enum { READOUT_LINES = 24, READOUT_COLUMNS = 160 };

typedef struct readout {
    int x, y;                   /* the pixel */
    char owner[VIEW_NAME];      /* of the bump there; empty: none */
    char line[READOUT_COLUMNS]; /* object, (u,w), P, tau by the picture's method, its lights */
    char table[READOUT_LINES][READOUT_COLUMNS];
    int lines; /* of the table */
} readout;

/* Ask the scene for a pixel of its picture. Where there is no memory or no such pixel the texts are empty. */
void readout_make(readout *r, kage_scene *scene, int x, int y);

#endif
