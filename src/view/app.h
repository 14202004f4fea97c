/* The program as a whole: events go to the state, looks to the worker, pictures to the window. */
#ifndef KAGE_VIEW_APP_H
#define KAGE_VIEW_APP_H

#include "look/watch.h"
#include "view/events.h"
#include "view/window.h"

typedef struct app_options {
    const char *path;
    const char **sets;
    int set_count, threads;
    kage_limits limits;
    int frames;  /* not 0: measure so many */
    bool report; /* print a line for each picture that is shown */
} app_options;

typedef struct app {
    app_options o;
    window window;
    worker *worker;
    view_state state;
    shown shown;
    held_keys held;
    watch watch;
    Uint32 event;      /* of SDL: the worker has something new */
    int number;        /* of the newest look */
    Uint32 asked;      /* when it was asked for, in milliseconds */
    Uint32 told;       /* when the message was shown */
    Uint32 looked;     /* at the file */
    Uint64 frame_time; /* when the last picture was shown */
    bool stale;        /* the window must be drawn again */
} app;

/* Open the window on a scene, which it takes. False: SDL_GetError() says why. */
bool app_start(app *a, const app_options *o, kage_scene *scene);
void app_end(app *a);

/* Wait for events and news, at most `wait` milliseconds, and take them. False: quit. */
bool app_step(app *a, int wait);

/* ---- measure.c ---- */

/* Turn the eye for o.frames frames; print the times from an event to its picture in the window. */
void measure(app *a);

#endif
