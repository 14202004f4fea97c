/* The program as a whole. */
#include "view/app.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Milliseconds: between two looks at the file, and how long a message stays. */
enum { LOOK_EACH = 200, MESSAGE_STAYS = 4000 };

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static void ask_picture(app *a)
{
    worker_show(a->worker, &a->state.look, ++a->number, a->state.x);
    a->asked = SDL_GetTicks();
}

bool app_start(app *a, const app_options *o, kage_scene *scene)
{
    const kage_scene_info *s = kage_scene_get_info(scene);
    int width = s->width, height = s->height;
    char title[256];
    memset(a, 0, sizeof *a);
    a->o = *o;
    watch_start(&a->watch, o->path);
    a->shown.timed = !o->report;
    snprintf(title, sizeof title, "%s - kage", base_name(o->path));
    if (!window_open(&a->window, title, &width, &height)) {
        kage_scene_free(scene);
        return false;
    }
    view_start(&a->state, width, height);
    a->event = SDL_RegisterEvents(1);
    const worker_options w = {o->path, o->sets, o->set_count, o->threads, o->limits, a->event};
    a->worker = worker_start(&w, scene);
    if (!a->worker) {
        kage_scene_free(scene);
        return false;
    }
    ask_picture(a);
    return true;
}

void app_end(app *a)
{
    if (a->worker)
        worker_end(a->worker);
    frame_free(&a->shown.picture);
    free(a->shown.news.errors);
    window_close(&a->window);
}

/* ---- what tests and measurements read ---- */

static void report_picture(const app *a)
{
    static const char *const layers[] = {"picture", "tau", "order", "height"};
    const frame *f = &a->shown.picture;
    if (!a->o.report)
        return;
    printf("shown %d %s stage=%d size=%dx%d shadow=%s beside=%s shade=%s own=%s surface=%s layer=%s\n", f->number,
           f->last ? "last" : "more", f->stage, f->columns, f->rows, f->shadow, *f->beside ? f->beside : "-",
           f->shifted ? "shifted" : "smooth", f->own, f->displaced ? "displaced" : "smooth", layers[f->legend.layer]);
    fflush(stdout);
}

static void report_text(const app *a, const char *what, const char *text)
{
    if (!a->o.report)
        return;
    printf("%s%s%.*s\n", what, *text ? " " : "", (int)strcspn(text, "\n"), text);
    fflush(stdout);
}

static void report_under(const app *a)
{
    const readout *r = &a->shown.news.under;
    char text[2 * VIEW_NAME];
    snprintf(text, sizeof text, "%d %d %s", r->x, r->y, r->owner);
    report_text(a, "under", text);
}

/* ---- events ---- */

static void take_event(app *a, const view_event *e, unsigned *asked)
{
    view_event own = *e;
    if (e->kind == EVENT_SIZE)
        window_size(&a->window, &own.x, &own.y);
    const int x = a->state.x, y = a->state.y;
    const bool over = a->state.over;
    *asked |= view_take(&a->state, worker_scene(a->worker), a->shown.news.under.owner, &own);
    if (a->state.over != over || (over && (a->state.x != x || a->state.y != y)))
        worker_point(a->worker, a->state.over ? a->state.x : -1, a->state.y);
    if (e->kind == EVENT_KEY || e->kind == EVENT_PRESS)
        *a->shown.message = 0;
}

/* Take all events that wait. What they ask for, as bits. */
static unsigned take_events(app *a, int wait)
{
    SDL_Event e;
    view_event own;
    unsigned asked = 0;
    for (bool some = SDL_WaitEventTimeout(&e, wait); some; some = SDL_PollEvent(&e)) {
        if (e.type == SDL_WINDOWEVENT && e.window.event == SDL_WINDOWEVENT_EXPOSED)
            asked |= ASK_WINDOW;
        else if (events_read(&a->held, &e, &own))
            take_event(a, &own, &asked);
    }
    return asked;
}

/* ---- news of the worker ---- */

/* A running mean over the time between pictures, while they follow each other. */
static void note_rate(app *a)
{
    const Uint64 now = SDL_GetPerformanceCounter();
    const double seconds = (double)(now - a->frame_time) / (double)SDL_GetPerformanceFrequency();
    a->frame_time = now;
    if (seconds > 0.5)
        a->shown.rate = 0;
    else
        a->shown.rate = a->shown.rate > 0 ? 1 / (0.9 / a->shown.rate + 0.1 * seconds) : 1 / seconds;
}

static void tell(app *a, const char *text)
{
    snprintf(a->shown.message, sizeof a->shown.message, "%s", text);
    a->told = SDL_GetTicks();
    a->stale = true;
}

static void hear_news(app *a)
{
    shown *x = &a->shown;
    char *before = x->news.errors;
    const int saves = x->news.saves;
    const readout under = x->news.under;
    worker_listen(a->worker, &x->news);
    const char *now = x->news.errors;
    if (now ? !before || strcmp(before, now) != 0 : before != NULL) {
        report_text(a, now ? "errors" : "good", now ? now : "");
        a->stale = true;
    }
    free(before);
    if (x->news.saves != saves) {
        tell(a, x->news.saved);
        report_text(a, x->news.saved, "");
    }
    if (under.x != x->news.under.x || under.y != x->news.under.y) {
        a->stale = true;
        report_under(a);
    }
}

/* Take the newest picture and texts. True: the picture is another one. */
static bool take_news(app *a)
{
    const bool fresh = worker_take(a->worker, &a->shown.picture);
    hear_news(a);
    if (fresh) {
        note_rate(a);
        a->stale = true;
    }
    return fresh;
}

/* The rate and messages pass. */
static void forget(app *a, Uint32 now)
{
    shown *x = &a->shown;
    if (*x->message && now - a->told > MESSAGE_STAYS) {
        *x->message = 0;
        a->stale = true;
    }
    if (x->rate > 0 && now - a->asked > 1000) {
        x->rate = 0;
        a->stale = true;
    }
}

static void look_at_file(app *a, Uint32 now)
{
    if (now - a->looked < LOOK_EACH)
        return;
    a->looked = now;
    if (watch_look(&a->watch))
        worker_reload(a->worker);
    a->stale = a->stale || a->shown.news.busy; /* how far it is */
}

bool app_step(app *a, int wait)
{
    const Uint32 soon = 25; /* milliseconds: a picture that comes so soon is worth waiting for */
    const unsigned asked = take_events(a, wait);
    if (asked & ASK_QUIT)
        return false;
    if (asked & ASK_PICTURE)
        ask_picture(a);
    if (asked & ASK_RELOAD)
        worker_reload(a->worker);
    if (asked & ASK_SAVE) {
        worker_save(a->worker);
        tell(a, "saving ...");
    }
    const Uint32 now = SDL_GetTicks();
    const bool fresh = take_news(a);
    look_at_file(a, now);
    forget(a, now);
    a->stale = a->stale || (asked & ~(unsigned)ASK_PICTURE);
    if (a->stale && (fresh || a->shown.picture.number == a->number || now - a->asked > soon)) {
        a->stale = false;
        window_draw(&a->window, &a->shown, &a->state, worker_scene(a->worker));
        if (fresh)
            report_picture(a);
    }
    return true;
}
