#include "cli/command.h"
#include "render/stats.h"

#include <stdio.h>
#include <unistd.h>

void progress_bar_start(progress_bar *p, bool quiet, const char *name, long pixels)
{
    *p = (progress_bar){.on = !quiet && isatty(STDERR_FILENO), .start = stats_clock(), .pixels = pixels, .name = name};
    p->shown = p->start;
}

/* Whether it is time to draw again; then how much of the bar is full is in `bar`. */
enum { BAR = 30 };
static bool is_due(progress_bar *p, double share, char bar[BAR + 1])
{
    const double now = stats_clock();
    if (!p->on || now - p->shown < 0.1)
        return false;
    p->shown = now;
    for (int k = 0; k < BAR; k++)
        bar[k] = k < (int)(share * BAR) ? '#' : '.';
    bar[BAR] = 0;
    return true;
}

void progress_bar_show(void *user, long done, long all)
{
    progress_bar *p = user;
    char bar[BAR + 1];
    const double share = (double)done / (double)all;
    if (!is_due(p, share, bar))
        return;
    const double gone = p->shown - p->start;
    fprintf(stderr, "\r%.24s [%s] %3.0f %%  %.1f Mpixel/s  %.1f s left \033[K", p->name, bar, 100 * share,
            share * (double)p->pixels / gone / 1e6, gone / share - gone);
}

void progress_bar_load(void *user, const char *what, double share)
{
    progress_bar *p = user;
    char bar[BAR + 1];
    if (p->what != what) { /* the first of each is seen, and the last of none hides it */
        p->what = what;
        p->shown = 0;
    }
    if (is_due(p, share, bar))
        fprintf(stderr, "\r%.24s [%s] %3.0f %%  %s \033[K", p->name, bar, 100 * share, what);
}

void progress_bar_end(progress_bar *p)
{
    if (p->on && p->shown > p->start)
        fprintf(stderr, "\r\033[K");
}
