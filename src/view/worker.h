/* The thread that reads and renders, so that the window never waits. The window asks for looks; pictures of them come
 * back coarse at once, then full, then antialiased. A picture that nobody wants any more is given up.
 */
#ifndef KAGE_VIEW_WORKER_H
#define KAGE_VIEW_WORKER_H

#include <SDL.h>

#include "look/frame.h"
#include "look/readout.h"
#include "look/save.h"

typedef struct worker worker;

typedef struct worker_options {
    const char *path;        /* of the scene */
    const char *const *sets; /* its changes from the command line */
    int set_count, threads;
    kage_limits limits;
    Uint32 event; /* of SDL, which is pushed when there is something new for the window */
} worker_options;

/* Texts for the window. */
typedef struct worker_news {
    readout under;         /* the values under the mouse */
    char saved[SAVE_TEXT]; /* the outcome of the last save */
    int saves;             /* how many were asked for and are done */
    char *errors;          /* of the scene's file, or of the look; NULL: none. The window's own copy; it frees it */
    bool of_file;          /* the errors are in the scene's file or what it names */
    double share;          /* of the picture that is being rendered, 0..1 */
    bool busy;             /* a picture is being rendered, or the scene read */
} worker_news;

/* Takes the scene, which was read by `o`. NULL: no memory, or no thread. */
worker *worker_start(const worker_options *o, kage_scene *scene);
void worker_end(worker *w);

/* Ask for pictures of a look; number: larger than that of the look before. split: the column of the split line. */
void worker_show(worker *w, const look *l, int number, int split);

/* Ask for the values of a pixel; x below 0: of none. */
void worker_point(worker *w, int x, int y);

void worker_reload(worker *w);
void worker_save(worker *w);

/* The newest picture in exchange for `shown`, which the worker fills again. False: there is no newer one. */
bool worker_take(worker *w, frame *shown);

void worker_listen(worker *w, worker_news *n);

/* The scene as it was last read without errors. It lives until the next call. */
const kage_scene_info *worker_scene(worker *w);

#endif
