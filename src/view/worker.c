/* The thread that reads and renders. */
#include "view/worker.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "look/changes.h"

/* How long a look must stay before a finer picture of it is begun, in milliseconds. */
enum { STILL = 60 };

/* What the window asks for. */
typedef struct request {
    look look;
    int number, split;
    int x, y, point; /* of the mouse; point counts the questions */
    int reloads, saves;
    bool quit;
} request;

struct worker {
    worker_options o;
    SDL_Thread *thread;
    SDL_mutex *lock;
    SDL_cond *wake;

    /* Under the lock. */
    request asked;
    frame ready;
    bool fresh; /* `ready` is newer than what the window shows */
    worker_news news;
    kage_scene *base;  /* the scene as read */
    kage_scene *given; /* what the window looks at: base, or an older one */
    char *file_errors, *look_errors;

    /* For the progress callback, without the lock. */
    SDL_atomic_t urgent;  /* the window has asked for something since the last request was taken */
    SDL_atomic_t quit;    /* and that is to end */
    SDL_atomic_t percent; /* of the picture */

    /* The thread's own. */
    request done;        /* what has been answered */
    kage_scene *changed; /* base with the changes of done.look; NULL: it has errors */
    int stage;           /* of the last picture of done.look; -1: its last one is shown */
    bool first;          /* the picture is the look's first */
    bool owed;           /* it was given up */
    Uint32 began, ended; /* when that was begun and done */
    stage_cost cost;
    frame_films films;
    frame made;
};

static void push(worker *w)
{
    SDL_Event e = {.type = w->o.event};
    SDL_PushEvent(&e);
}

/* All errors as one text, and how many there are; without a list, what the status means. Frees the list. NULL: no
 * memory. */
static char *text_of(kage_status status, kage_errors *e)
{
    const int count = kage_errors_count(e), found = kage_errors_found(e);
    size_t size = 64;
    if (count == 0)
        return strdup(status == KAGE_NO_MEMORY ? "there is not enough memory" : "the picture can't be made");
    for (int k = 0; k < count; k++)
        size += strlen(kage_errors_get(e, k)->message) + 1;
    char *text = calloc(1, size);
    for (int k = 0; text && k < count; k++)
        strcat(strcat(text, kage_errors_get(e, k)->message), k < count - 1 ? "\n" : "");
    if (text && found > 1)
        snprintf(text + strlen(text), 64, "\n%d errors%s", found, found > count ? ", the first of them above" : "");
    kage_errors_free(e);
    return text;
}

/* Replace the errors of the file or of the look. */
static void set_errors(worker *w, char **which, kage_status status, kage_errors *e)
{
    char *text = status == KAGE_OK ? NULL : text_of(status, e);
    SDL_LockMutex(w->lock);
    char *before = *which;
    *which = text;
    SDL_UnlockMutex(w->lock);
    if (text || before)
        push(w);
    free(before);
}

/* The values under the mouse, where it has moved. */
static void answer_point(worker *w, bool again)
{
    SDL_LockMutex(w->lock);
    const bool moved = w->asked.point != w->done.point;
    w->done.x = w->asked.x;
    w->done.y = w->asked.y;
    w->done.point = w->asked.point;
    SDL_UnlockMutex(w->lock);
    if (!moved && !(again && w->done.x >= 0))
        return;
    readout r = {0};
    if (w->done.x >= 0 && w->changed)
        readout_make(&r, w->changed, w->done.x, w->done.y);
    SDL_LockMutex(w->lock);
    w->news.under = r;
    SDL_UnlockMutex(w->lock);
    push(w);
}

/* The callback of a call that may be given up when the window asks for something else. A look's first picture is
 * finished, unless it takes long: else nothing would be seen while the mouse moves. */
static int outdated(void *user, const char *what, double share)
{
    const Uint32 patience = 300; /* milliseconds */
    worker *w = user;
    (void)what;
    SDL_AtomicSet(&w->percent, (int)(100 * share));
    if (SDL_AtomicGet(&w->quit))
        return 1;
    if (!w->first) /* a slow picture does not keep the mouse waiting */
        answer_point(w, false);
    return SDL_AtomicGet(&w->urgent) && (!w->first || SDL_GetTicks() - w->began > patience);
}

/* The callback of a call that only the end interrupts. */
static int ended(void *user, const char *what, double share)
{
    worker *w = user;
    (void)what;
    SDL_AtomicSet(&w->percent, (int)(100 * share));
    return SDL_AtomicGet(&w->quit);
}

/* ---- the tasks ---- */

/* Read the scene again. False: it has errors, and stays as it was. */
static bool reload(worker *w)
{
    const kage_load_options o = {.sets = w->o.sets,
                                 .set_count = w->o.set_count,
                                 .threads = w->o.threads,
                                 .progress = ended,
                                 .user = w,
                                 .limits = &w->o.limits};
    kage_scene *s = NULL;
    kage_errors *e = NULL;
    const kage_status status = kage_scene_load(w->o.path, &o, &s, &e);
    set_errors(w, &w->file_errors, status, e);
    if (status != KAGE_OK)
        return false;
    kage_scene_free(w->changed);
    w->changed = NULL;
    SDL_LockMutex(w->lock);
    kage_scene *old = w->base == w->given ? NULL : w->base;
    w->base = s;
    SDL_UnlockMutex(w->lock);
    kage_scene_free(old);
    return true;
}

static void save(worker *w)
{
    const save_order o = {w->base, w->o.path, &w->done.look, w->o.threads, &w->o.limits, ended, w};
    char text[SAVE_TEXT];
    save_picture(&o, text);
    SDL_LockMutex(w->lock);
    memcpy(w->news.saved, text, sizeof text);
    w->news.saves = w->done.saves;
    SDL_UnlockMutex(w->lock);
    push(w);
}

static void publish(worker *w)
{
    SDL_LockMutex(w->lock);
    const frame f = w->ready;
    w->ready = w->made;
    w->made = f;
    w->fresh = true;
    SDL_UnlockMutex(w->lock);
    push(w);
}

/* One picture, at w->stage. False: given up, or its look has errors. */
static bool draw(worker *w, double fixed)
{
    const double ticks = (double)SDL_GetPerformanceFrequency();
    const Uint64 start = SDL_GetPerformanceCounter();
    const look *l = &w->done.look;
    const double pixels = (double)l->width * l->height;
    const frame_order o = {l, w->done.number, w->stage, !w->first, w->done.split, w->o.threads, outdated, w};
    kage_errors *e = NULL;
    const kage_status status = frame_render(&w->made, &w->films, w->changed, &o, &e);
    const double took = (double)(SDL_GetPerformanceCounter() - start) / ticks;
    const double share = SDL_AtomicGet(&w->percent) / 100.0, area = w->stage > 1 ? w->stage * w->stage : 1;
    if (status == KAGE_CANCELLED) {
        if (w->first && share > 0.02) /* it is slow: the next one is coarser */
            stage_learn(&w->cost, fixed, fixed + took / share, pixels / area);
        return false;
    }
    set_errors(w, &w->look_errors, status, e);
    if (status != KAGE_OK)
        return false;
    if (w->stage != STAGE_FINE)
        stage_learn(&w->cost, fixed, fixed + took, pixels / area);
    w->made.seconds = fixed + took;
    w->made.last = stage_next(&w->cost, w->stage, pixels, l->layer == LAYER_PICTURE) < 0;
    if (w->made.last && !w->made.whole) /* the line can't be moved over it yet */
        w->made.last = false;
    publish(w);
    return true;
}

/* The first picture of a new look. */
static void draw_first(worker *w)
{
    const double ticks = (double)SDL_GetPerformanceFrequency();
    const Uint64 start = SDL_GetPerformanceCounter();
    const look *l = &w->done.look;
    changes c;
    kage_errors *e = NULL;
    kage_scene *changed = NULL;
    w->first = true;
    w->owed = false;
    w->began = SDL_GetTicks();
    changes_make(&c, l, kage_scene_get_info(w->base), false);
    const kage_load_options o = {
        .sets = c.list, .set_count = c.count, .threads = w->o.threads, .progress = outdated, .user = w};
    const kage_status status = kage_scene_change(w->base, &o, &changed, &e);
    const double fixed = (double)(SDL_GetPerformanceCounter() - start) / ticks;
    kage_scene_free(w->changed);
    w->changed = changed;
    if (status != KAGE_OK) {
        w->stage = -1;
        w->owed = status == KAGE_CANCELLED;
        if (!w->owed)
            set_errors(w, &w->look_errors, status, e);
        return;
    }
    w->stage = stage_first(&w->cost, (double)l->width * l->height);
    if (!draw(w, fixed)) {
        w->stage = -1;
        w->owed = SDL_AtomicGet(&w->urgent);
    }
    w->ended = SDL_GetTicks();
}

/* A finer picture of the same look, or the other halves of a split one. */
static void draw_next(worker *w)
{
    const look *l = &w->done.look;
    const bool halves = w->first && *l->beside;
    const int before = w->stage;
    const int next = stage_next(&w->cost, before, (double)l->width * l->height, l->layer == LAYER_PICTURE);
    w->stage = next < 0 && halves ? before : next;
    if (w->stage < 0)
        return;
    w->first = false;
    if (draw(w, 0))
        return;
    w->first = halves;
    w->stage = SDL_AtomicGet(&w->urgent) ? before : -1; /* given up, or errors */
}

/* ---- the loop ---- */

/* A finer picture may follow. */
static bool unfinished(const worker *w) { return w->stage >= 0 && w->changed; }

static bool is_new(const worker *w)
{
    const request *a = &w->asked, *d = &w->done;
    return a->quit || a->number != d->number || a->point != d->point || a->reloads != d->reloads ||
           a->saves != d->saves;
}

/* Milliseconds until a finer picture may be begun. */
static Uint32 time_left(const worker *w)
{
    const Uint32 passed = SDL_GetTicks() - w->ended;
    return passed < STILL ? STILL - passed : 0;
}

/* Wait until there is something to do; the request before, and the one now. False: only a finer picture. */
static bool wait_for_request(worker *w, request *before)
{
    SDL_LockMutex(w->lock);
    *before = w->done;
    w->news.busy = false;
    while (!is_new(w)) {
        if (!unfinished(w))
            SDL_CondWait(w->wake, w->lock);
        else if (SDL_CondWaitTimeout(w->wake, w->lock, time_left(w)) == SDL_MUTEX_TIMEDOUT)
            break;
    }
    const bool news = is_new(w);
    const request answered = w->done;
    w->done = w->asked;
    w->done.point = answered.point; /* answer_point takes these */
    w->done.x = answered.x;
    w->done.y = answered.y;
    w->news.busy = true;
    SDL_AtomicSet(&w->urgent, 0);
    SDL_AtomicSet(&w->percent, 0);
    SDL_UnlockMutex(w->lock);
    return news;
}

static int run(void *user)
{
    worker *w = user;
    request before;
    for (;;) {
        const bool news = wait_for_request(w, &before);
        if (w->done.quit)
            return 0;
        bool again = w->owed || w->done.number != before.number; /* a save may have stopped it, or a bad file */
        if (w->done.reloads != before.reloads)
            again = reload(w) || again;
        if (again)
            draw_first(w);
        if (w->done.saves != before.saves)
            save(w);
        answer_point(w, again);
        if (!news && unfinished(w))
            draw_next(w);
    }
}

/* ---- the window's side ---- */

worker *worker_start(const worker_options *o, kage_scene *scene)
{
    worker *w = calloc(1, sizeof *w);
    if (!w)
        return NULL;
    w->o = *o;
    w->base = w->given = scene;
    w->stage = -1;
    w->done.x = w->asked.x = -1;
    w->lock = SDL_CreateMutex();
    w->wake = SDL_CreateCond();
    w->thread = w->lock && w->wake ? SDL_CreateThread(run, "render", w) : NULL;
    if (w->thread)
        return w;
    SDL_DestroyCond(w->wake);
    SDL_DestroyMutex(w->lock);
    free(w);
    return NULL;
}

/* Wake the thread, and end what it does if that is `urgent`. The lock is held, and given back. */
static void ask(worker *w, int urgent)
{
    if (urgent)
        SDL_AtomicSet(&w->urgent, 1);
    SDL_CondSignal(w->wake);
    SDL_UnlockMutex(w->lock);
}

void worker_end(worker *w)
{
    SDL_LockMutex(w->lock);
    w->asked.quit = true;
    SDL_AtomicSet(&w->quit, 1);
    ask(w, 1);
    SDL_WaitThread(w->thread, NULL);
    kage_scene_free(w->changed);
    if (w->given != w->base)
        kage_scene_free(w->given);
    kage_scene_free(w->base);
    frame_films_free(&w->films);
    frame_free(&w->made);
    frame_free(&w->ready);
    free(w->file_errors);
    free(w->look_errors);
    SDL_DestroyCond(w->wake);
    SDL_DestroyMutex(w->lock);
    free(w);
}

void worker_show(worker *w, const look *l, int number, int split)
{
    SDL_LockMutex(w->lock);
    memcpy(&w->asked.look, l, sizeof *l);
    w->asked.number = number;
    w->asked.split = split;
    ask(w, 1);
}

void worker_point(worker *w, int x, int y)
{
    SDL_LockMutex(w->lock);
    w->asked.x = x;
    w->asked.y = y;
    w->asked.point++;
    ask(w, 0);
}

void worker_reload(worker *w)
{
    SDL_LockMutex(w->lock);
    w->asked.reloads++;
    ask(w, 1);
}

void worker_save(worker *w)
{
    SDL_LockMutex(w->lock);
    w->asked.saves++;
    ask(w, 1);
}

bool worker_take(worker *w, frame *shown)
{
    SDL_LockMutex(w->lock);
    const bool fresh = w->fresh;
    if (fresh) {
        const frame f = *shown;
        *shown = w->ready;
        w->ready = f;
        w->fresh = false;
    }
    SDL_UnlockMutex(w->lock);
    return fresh;
}

void worker_listen(worker *w, worker_news *n)
{
    SDL_LockMutex(w->lock);
    const char *errors = w->file_errors ? w->file_errors : w->look_errors;
    *n = w->news;
    n->of_file = w->file_errors != NULL;
    n->errors = errors ? malloc(strlen(errors) + 1) : NULL;
    if (n->errors)
        strcpy(n->errors, errors);
    n->share = SDL_AtomicGet(&w->percent) / 100.0;
    SDL_UnlockMutex(w->lock);
}

const kage_scene_info *worker_scene(worker *w)
{
    SDL_LockMutex(w->lock);
    kage_scene *old = w->given == w->base ? NULL : w->given;
    w->given = w->base;
    SDL_UnlockMutex(w->lock);
    kage_scene_free(old);
    return kage_scene_get_info(w->given);
}
