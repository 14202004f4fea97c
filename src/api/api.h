/* What the files of the library's face share: the objects behind kage.h, and how internal results become its own. */
#ifndef KAGE_API_API_H
#define KAGE_API_API_H

#include <locale.h>
#include <pthread.h>

#include "kage.h"
#include "film/film.h"
#include "scene/scene.h"

/* Numbers are read and written as the C locale has them, whatever the process has set: for this thread, meanwhile. */
typedef struct c_locale {
    locale_t c, before;
} c_locale;
c_locale c_locale_begin(void);
void c_locale_end(c_locale *l);

/* The caller's progress callback, as the rooms below see it. Once it has cancelled, everything that asks ends. */
typedef struct watch {
    kage_progress *call;
    void *user;
    const c_locale *locale; /* in which the library works; the callback runs in the caller's. May be NULL */
    bool cancelled;
} watch;
progress watch_progress(watch *w);

/* Hand the errors over. Frees *e. Returns `status`, or KAGE_NO_MEMORY where that is what they say, or KAGE_CANCELLED
 * where the watch (or NULL) has. `to` may be NULL. */
kage_status errors_give(errors *e, kage_status status, const watch *w, kage_errors **to);

/* The same for one message. */
kage_status error_give(kage_status status, kage_errors **to, const char *fmt, ...) KAGE_PRINTF(3, 4);

/* Readings of one scene: what is prepared in it depends on whether true hits are asked for. */
enum { READINGS = 4 };

struct kage_scene {
    scene *first;             /* as the caller asked for it */
    scene *reading[READINGS]; /* by reading_of; one of them is `first` */
    pthread_mutex_t lock;     /* of reading[] */
    kage_scene_info info;
    /* what a further reading needs; owned */
    char *folder, *model_reader, **set;
    int sets, threads;
};

/* The reading for a surface and a method, made where there is none yet. It lives as long as k. NULL: errors in *e. */
const scene *scene_reading(kage_scene *k, bool displaced, method m, errors *e);

/* Fill in, and free, k->info. False: out of memory. */
bool scene_note(kage_scene *k);
void scene_forget(kage_scene *k);

struct kage_film {
    film *film;
    char *file, *source, *sets; /* for the texts in a picture: the scene's base name, its text, changes a line each */
    char method[METHOD_NAME_SIZE];
    bool guard;
    kage_stats stats;
    kage_stage *stages;
    kage_order_count orders[ORDER_CODES];
};

#endif
