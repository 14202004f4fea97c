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

/* In one line of the terminal, with a shorter bar where it is narrow. */
static void draw(progress_bar *p, double share, const char *tail)
{
    enum { WIDTH = 30, LEAST = 4, NAME = 24 };
    char bar[WIDTH + 1] = "", line[160];
    const int around = snprintf(line, sizeof line, "%.*s [] %3.0f %%  %s ", NAME, p->name, 100 * share, tail);
    const int room = terminal_columns(stderr) - 1 - around, width = room < LEAST ? LEAST : room < WIDTH ? room : WIDTH;
    for (int k = 0; k < width; k++)
        bar[k] = k < (int)(share * width) ? '#' : '.';
    fprintf(stderr, "\r%.*s [%s] %3.0f %%  %s \033[K", NAME, p->name, bar, 100 * share, tail);
    p->drawn = true;
}

int progress_bar_show(void *user, const char *what, double share)
{
    progress_bar *p = user;
    char rate[64], clock[64];
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
    const bool rated = p->pixels && done > 0 && strcmp(what, "rendering") == 0;
    snprintf(rate, sizeof rate, "%.1f Mpixel/s  %.1f s left", done * (double)p->pixels / gone / 1e6,
             gone / done * (1 - share));
    snprintf(clock, sizeof clock, gone >= 1 ? "%s, %.0f s" : "%s", what, gone);
    draw(p, share, rated ? rate : clock);
    return 0;
}

void progress_bar_end(progress_bar *p)
{
    if (p->drawn)
        fprintf(stderr, "\r\033[K");
}
