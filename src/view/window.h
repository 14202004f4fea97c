/* The window: the picture, the split line, panels over it on demand, and a bar of two lines below it. */
#ifndef KAGE_VIEW_WINDOW_H
#define KAGE_VIEW_WINDOW_H

#include "view/font.h"
#include "view/worker.h"

/* Where things are drawn: a surface of bytes red, green, blue, alpha. */
typedef struct canvas {
    SDL_Surface *s;
    font *font;
} canvas;

typedef struct window {
    SDL_Window *sdl;
    canvas to;
    int bar; /* the bar's height in pixels */
} window;

/* What is shown, besides the state. */
typedef struct shown {
    frame picture;
    worker_news news;
    char message[SAVE_TEXT]; /* in place of the readout; empty: none */
    bool timed;              /* with times, which differ from run to run */
    double rate;             /* frames a second while something moves; 0: nothing does */
} shown;

/* A window for a picture of this size, less where the screen is smaller; its real size is in width and height. False:
 * SDL_GetError() says why. */
bool window_open(window *w, const char *title, int *width, int *height);
void window_close(window *w);

/* The size of the picture in the window as it is now. */
void window_size(const window *w, int *width, int *height);

/* Draw it all. */
void window_draw(window *w, const shown *x, const view_state *v, const kage_scene_info *s);

/* ---- panels.c: what lies over the picture ---- */

/* Draw into the picture, of width x height pixels. */
void panel_help(canvas *c, int width, int height);
void panel_errors(canvas *c, int width, int height, const char *errors, bool of_file);
void panel_table(canvas *c, int width, int height, const readout *r);
void panel_legend(canvas *c, int width, int height, const legend *l);
void panel_split(canvas *c, int width, int height, int line, const char *left, const char *right);

/* ---- bar.c ---- */

/* The two lines below the picture. */
void bar_draw(canvas *c, int y, int width, int height, const shown *x, const view_state *v, const kage_scene_info *s);

/* How the picture is made, in words: "order 0". */
const char *bar_method(const char *method, char text[2 * VIEW_METHOD]);

#endif
