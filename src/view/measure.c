/* Measures the time from an event to its picture in the window. */
#include "view/app.h"

#include <stdio.h>
#include <stdlib.h>

static double now(void) { return (double)SDL_GetPerformanceCounter() / (double)SDL_GetPerformanceFrequency(); }

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* An event of the mouse as SDL would give it, at a place in the window. */
static void push(Uint32 type, int x, int y)
{
    SDL_Event e = {.type = type};
    if (type == SDL_MOUSEMOTION) {
        e.motion.x = x;
        e.motion.y = y;
    } else {
        e.button.button = SDL_BUTTON_LEFT;
        e.button.x = x;
        e.button.y = y;
    }
    SDL_PushEvent(&e);
}

/* Let the first picture be finished, so that its time is known. */
static bool settle(app *a)
{
    while (!(a->shown.picture.number == a->number && a->shown.picture.last) && !a->shown.news.errors)
        if (!app_step(a, 100))
            return false;
    return !a->shown.news.errors;
}

/* Move the mouse by a pixel or more and wait for the picture of that. The stage of it; -1: quit. */
static int one(app *a, int x, int y)
{
    const int before = a->number;
    push(SDL_MOUSEMOTION, x, y);
    while (a->number == before || a->shown.picture.number < a->number)
        if (!app_step(a, 100) || a->shown.news.errors)
            return -1;
    return a->shown.picture.stage;
}

static void print(double *seconds, double *picture, int frames, double whole, int full, const look *l)
{
    qsort(seconds, (size_t)frames, sizeof *seconds, by_size);
    qsort(picture, (size_t)frames, sizeof *picture, by_size);
    printf("%d frames of %dx%d: from the event to the window %.2f ms in the median, %.2f ms for 95 %%; %.1f frames a "
           "second; %d full, %d coarse; the picture alone %.2f ms\n",
           frames, l->width, l->height, 1e3 * seconds[frames / 2], 1e3 * seconds[frames * 95 / 100], frames / whole,
           full, frames - full, 1e3 * picture[frames / 2]);
}

void measure(app *a)
{
    const int frames = a->o.frames, y = a->state.look.height / 2, middle = a->state.look.width / 2, sway = 100;
    double *seconds = calloc(2 * (size_t)frames, sizeof *seconds);
    int full = 0, done = 0;
    if (!seconds || !settle(a)) {
        free(seconds);
        return;
    }
    double *picture = seconds + frames;
    push(SDL_MOUSEBUTTONDOWN, middle, y);
    const double start = now();
    for (; done < frames; done++) {
        const int k = (done + 1) % (4 * sway), x = k < sway ? k : k < 3 * sway ? 2 * sway - k : k - 4 * sway;
        const double begun = now();
        const int stage = one(a, middle + 2 * x, y);
        if (stage < 0)
            break;
        seconds[done] = now() - begun;
        picture[done] = a->shown.picture.seconds;
        full += stage <= STAGE_FULL;
    }
    if (done == frames)
        print(seconds, picture, frames, now() - start, full, &a->state.look);
    free(seconds);
}
