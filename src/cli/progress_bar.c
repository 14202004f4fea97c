/* The progress bar and its clock. */
#include "cli/command.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

double clock_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void progress_bar_start(progress_bar *p, bool quiet, const char *name, long pixels)
{
    *p = (progress_bar){.on = !quiet && isatty(STDERR_FILENO), .start = clock_now(), .pixels = pixels, .name = name};
    p->shown = p->start;
}

int progress_bar_show(void *user, const char *what, double share)
{
    enum { WIDTH = 30 };
    progress_bar *p = user;
    char bar[WIDTH + 1] = "", rate[64];
    stop_note(what, share);
    if (stop_asked())
        return 1;
    if (!p->on || strcmp(what, "objects") == 0) /* objects: too fast to see */
        return 0;
    const bool first = strcmp(p->what, what) != 0; /* of this step: draw at once, unless it is the render */
    const double now = clock_now();
    if (first) {
        p->first = share;
        p->start = now;
    }
    const double gone = now - p->start, done = share - p->first; /* of this step */
    snprintf(p->what, sizeof p->what, "%s", what);
    if (now - p->shown < 0.1 && (p->pixels || !first))
        return 0;
    p->shown = now;
    for (int k = 0; k < WIDTH; k++)
        bar[k] = k < (int)(share * WIDTH) ? '#' : '.';
    snprintf(rate, sizeof rate, "%.1f Mpixel/s  %.1f s left", done * (double)p->pixels / gone / 1e6,
             gone / done * (1 - share));
    const bool rated = p->pixels && done > 0 && strcmp(what, "rendering") == 0;
    p->drawn = true;
    fprintf(stderr, "\r%.24s [%s] %3.0f %%  %s \033[K", p->name, bar, 100 * share, rated ? rate : what);
    return 0;
}

void progress_bar_end(progress_bar *p)
{
    if (p->drawn)
        fprintf(stderr, "\r\033[K");
}
