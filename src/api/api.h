/* Shared by the files that implement kage.h: the structs behind its pointers, errors, progress and the locale. */
#ifndef KAGE_API_API_H
#define KAGE_API_API_H

#include <locale.h>
#include <pthread.h>

#include "kage.h"
#include "film/film.h"
#include "image/image.h"
#include "scene/scene.h"

/* The C locale for numbers, in this thread, from begin to end; the process may have set another. */
typedef struct c_locale {
    locale_t c, before;
} c_locale;
c_locale c_locale_begin(void);
void c_locale_end(c_locale *l);

/* What a scene and its films may take: memory, which its family shares, and what is read. */
typedef struct allowance {
    budget *budget; /* owned */
    int64_t most;   /* bytes; 0: no limit */
    limits limits;
} allowance;

/* A call: the caller's progress callback and limits. Once the callback has cancelled, or the time is over, all later
 * calls of progress_show return false. */
typedef struct watch {
    kage_progress *call;
    void *user;
    const c_locale *locale; /* the callback runs in locale->before */
    memory memory;
    limits limits; /* the caller's own, where it has no scene */
    double end;    /* the clock's time when the call has to end; 0: never */
    bool cancelled, late;
} watch;

/* limits: the caller's, or NULL. from: whose memory is taken, and whose limits of input hold; NULL: memory is not
 * counted, and the caller's hold. *w and *from must stay where they are. */
progress watch_begin(watch *w, kage_progress *call, void *user, const c_locale *l, const kage_limits *limits,
                     const allowance *from);

/* The seconds that are left, above 0; 0: there is no limit. */
double watch_left(const watch *w);

/* Whether the call has to end, as it was cancelled or has no more time. */
bool watch_stopped(const watch *w);

/* Whether the limits can be used. False: an error is in *e. */
bool limits_are_good(const kage_limits *limits, errors *e);

/* Those of what a scene and its files have, where they are set; the others stay. l may be NULL. */
void limits_take(limits *to, const kage_limits *l);

/* Whether something that `before` lets pass may not pass `now`. */
bool limits_are_tighter(const limits *before, const limits *now);

/* The most bytes by limits; NULL: by default. */
int64_t limits_memory(const kage_limits *limits);

/* End a call. Returns KAGE_CANCELLED or KAGE_OUT_OF_TIME where w (or NULL) was stopped, KAGE_NO_MEMORY where the errors
 * say so, otherwise `status`. Frees *e. `to`, unless NULL, gets a copy of the errors; NULL where the call succeeded or
 * was cancelled. */
kage_status errors_give(errors *e, kage_status status, const watch *w, kage_errors **to);

/* End a call with one message. */
kage_status error_give(kage_status status, kage_errors **to, const char *fmt, ...) KAGE_PRINTF(3, 4);

/* A scene is read once for each set of what it must build: true displacement for one use or another, horizon maps. */
enum { READINGS = 16 };

struct kage_scene {
    scene *first;             /* as the caller asked for it */
    scene *reading[READINGS]; /* by reading_index; one is `first`; NULL: not read yet */
    pthread_mutex_t lock;     /* of reading[] and info.text */
    kage_scene_info info;
    char *text; /* with the changes, once it is asked for; NULL: not yet, or there are none */
    /* what a further reading needs; owned */
    char *folder, *model_reader, **set;
    int sets, threads;
    allowance allowed;
    bool from_file; /* first->path is a file's */
    arrays arrays;
    shelf spare; /* of the scene that it is a change of: what its further readings had made */
};

/* Add a change after those of k, which has room for it. A change of the same place is replaced, so that changes one
 * after another do not pile up. False: out of memory. */
bool sets_put(kage_scene *k, const char *set);

/* Check the caller's arrays. False: errors in *e. */
bool arrays_are_good(const kage_load_options *o, errors *e);

/* Copy them. False: out of memory. */
bool arrays_take(arrays *to, const kage_load_options *o, memory *m);

/* What decides which reading of a scene a render needs. */
typedef struct reading {
    bool displaced;
    method shadow;
    bump_shadow bump_shadow;
} reading;

/* The reading for these, read now if needed, and p is called then; locks. It lives as long as k. NULL: errors in *e. */
const scene *scene_reading(kage_scene *k, reading r, const progress *p, errors *e);

/* Fill in, and free, k->info. False: out of memory. */
bool scene_describe(kage_scene *k);
void scene_forget(kage_scene *k);

/* The text `Software` in a picture begins with this; the version follows. */
#define SOFTWARE "kage"

enum { PICTURE_TEXTS = 7, PICTURE_CROP_SIZE = 64 };

struct kage_film {
    film *film;
    allowance allowed;
    char crop[PICTURE_CROP_SIZE]; /* as a file says it: the part that is on the film */
    char *file, *source, *sets; /* for a picture's metadata: the scene's base name, its text, its changes, one a line */
    char method[METHOD_NAME_SIZE];
    bool guard;
    kage_stats stats;
    kage_stage *stages;
    kage_order_count orders[ORDER_CODES];
};

/* Whether a word of n letters names a plane: its whole name, the part before the dot (N for N.X), or `color` for R, G
 * and B; and whether it names one of a film's. */
bool film_names_plane(const char *word, size_t n, const char *plane);
bool film_has_layer(const film *f, const char *word, size_t n);

/* Two of the texts in a picture's file. */
#define PICTURE_SOFTWARE "Software"
#define PICTURE_CROP "kage:crop"

/* What a picture's file says of it; crop: as picture_crop writes it. The film owns the texts. */
void picture_texts(const kage_film *f, const char *crop, image_text to[PICTURE_TEXTS]);
void picture_crop(window w, char text[PICTURE_CROP_SIZE]);

/* Whether a file's name has something before this ending, in capitals or not. */
bool path_ends_in(const char *path, const char *ending);

/* A picture's file that is being written, and the planes of films that go into it. */
typedef struct picture {
    image_writer *writer;
    int planes, *plane;
    const float **row; /* of each of these planes, the rows to be added */
} picture;

/* Begin a file with a part of the picture, of which f is a window or all. Not KAGE_OK: an error is in *e, and nothing
 * is open. */
kage_status picture_begin(picture *p, const kage_film *f, window part, const char *path, const kage_write_options *o,
                          errors *e);

/* Add the rows of a film, the next ones of the picture. False: stopped or failed. */
bool picture_add(picture *p, const film *f, const progress *show);

/* End the file; whole: all rows are added, else it is deleted or kept as a part. */
kage_status picture_end(picture *p, bool whole, errors *e);

#endif
