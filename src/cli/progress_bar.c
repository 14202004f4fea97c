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

/* Whether it is time to draw again. If so, `bar` shows the share, 0..1. */
enum { BAR = 30 };
static bool is_due(progress_bar *p, double share, char bar[BAR + 1])
{
    const double now = p->on ? clock_now() : 0;
    if (!p->on || now - p->shown < 0.1)
        return false;
    p->shown = now;
    for (int k = 0; k < BAR; k++)
        bar[k] = k < (int)(share * BAR) ? '#' : '.';
    bar[BAR] = 0;
    return true;
}

int progress_bar_render(void *user, const char *what, double share)
{
    progress_bar *p = user;
    char bar[BAR + 1];
    (void)what;
    if (!is_due(p, share, bar))
        return 0;
    const double gone = p->shown - p->start;
    fprintf(stderr, "\r%.24s [%s] %3.0f %%  %.1f Mpixel/s  %.1f s left \033[K", p->name, bar, 100 * share,
            share * (double)p->pixels / gone / 1e6, gone / share - gone);
    return 0;
}

int progress_bar_load(void *user, const char *what, double share)
{
    progress_bar *p = user;
    char bar[BAR + 1];
    if (strcmp(what, "objects") == 0) /* too fast to see */
        return 0;
    if (strcmp(p->what, what) != 0) { /* draw the first call of each step at once */
        snprintf(p->what, sizeof p->what, "%s", what);
        p->shown = 0;
    }
    if (is_due(p, share, bar))
        fprintf(stderr, "\r%.24s [%s] %3.0f %%  %s \033[K", p->name, bar, 100 * share, what);
    return 0;
}

void progress_bar_end(progress_bar *p)
{
    if (p->on && p->shown > p->start)
        fprintf(stderr, "\r\033[K");
}
