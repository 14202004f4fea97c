/* One picture of a look, or two, one for each side of the split line, as pixels for the window. */
#ifndef KAGE_LOOK_FRAME_H
#define KAGE_LOOK_FRAME_H

#include "look/colours.h"
#include "look/stage.h"

enum { FRAME_SIDES = 2 };

typedef struct frame {
    int number;                 /* of the look */
    int stage;                  /* stage.h */
    int width, height;          /* of the picture in the window */
    int columns, rows;          /* of the pixels here, fewer where the stage is coarse */
    uint8_t *rgba[FRAME_SIDES]; /* 4 bytes each, without gaps: by the scene's method, and by look.beside */
    size_t room[FRAME_SIDES];   /* bytes */
    int sides;                  /* 2: split */
    bool whole;                 /* both sides are whole; otherwise only what is on their side of the line */
    int split;                  /* the column of the line, of `width`, where it is not whole */
    legend legend;
    double seconds;                                                  /* for the change of the scene and the picture */
    char shadow[VIEW_METHOD], beside[VIEW_METHOD], own[VIEW_METHOD]; /* what it was made by */
    bool shifted, displaced;
    bool last; /* no finer one follows */
} frame;

/* How to make one. */
typedef struct frame_order {
    const look *look;
    int number, stage;
    bool whole;
    int split;
    int threads;
    kage_progress *progress; /* may end it; NULL: none */
    void *user;
} frame_order;

/* Films are used again. Zero: none yet. */
typedef struct frame_films {
    kage_film *film[FRAME_SIDES];
} frame_films;

/* Render. `scene` is the changed scene. Not KAGE_OK: *f is of no use. */
kage_status frame_render(frame *f, frame_films *films, kage_scene *scene, const frame_order *o, kage_errors **errors);

void frame_free(frame *f);
void frame_films_free(frame_films *films);

#endif
