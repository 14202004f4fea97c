/* Shared by the files that implement kage.h: the structs behind its pointers, errors, progress and the locale. */
#ifndef KAGE_API_API_H
#define KAGE_API_API_H

#include <locale.h>
#include <pthread.h>

#include "kage.h"
#include "film/film.h"
#include "scene/scene.h"

/* The C locale for numbers, in this thread, from begin to end; the process may have set another. */
typedef struct c_locale {
    locale_t c, before;
} c_locale;
c_locale c_locale_begin(void);
void c_locale_end(c_locale *l);

/* The caller's progress callback. Once it has cancelled, all later calls of progress_show return false. */
typedef struct watch {
    kage_progress *call;
    void *user;
    const c_locale *locale; /* the callback runs in locale->before */
    bool cancelled;
} watch;
progress watch_progress(watch *w);

/* End a call. Returns KAGE_CANCELLED where w (or NULL) was cancelled, KAGE_NO_MEMORY where the errors say so, otherwise
 * `status`. Frees *e. `to`, unless NULL, gets a copy of the errors; NULL where the call succeeded or was cancelled. */
kage_status errors_give(errors *e, kage_status status, const watch *w, kage_errors **to);

/* End a call with one message. */
kage_status error_give(kage_status status, kage_errors **to, const char *fmt, ...) KAGE_PRINTF(3, 4);

/* A scene is read once for each set of what it must build: true displacement for one use or another, horizon maps. */
enum { READINGS = 16 };

struct kage_scene {
    scene *first;             /* as the caller asked for it */
    scene *reading[READINGS]; /* by reading_index; one is `first`; NULL: not read yet */
    pthread_mutex_t lock;     /* of reading[] */
    kage_scene_info info;
    /* what a further reading needs; owned */
    char *folder, *model_reader, **set;
    int sets, threads;
};

/* What decides which reading of a scene a render needs. */
typedef struct reading {
    bool displaced;
    method shadow;
    bump_shadow bump_shadow;
} reading;

/* The reading for these, read now if needed; locks. It lives as long as k. NULL: errors in *e. */
const scene *scene_reading(kage_scene *k, reading r, errors *e);

/* Fill in, and free, k->info. False: out of memory. */
bool scene_note(kage_scene *k);
void scene_forget(kage_scene *k);

struct kage_film {
    film *film;
    char *file, *source, *sets; /* for a picture's metadata: the scene's base name, its text, its changes, one a line */
    char method[METHOD_NAME_SIZE];
    bool guard;
    kage_stats stats;
    kage_stage *stages;
    kage_order_count orders[ORDER_CODES];
};

#endif
