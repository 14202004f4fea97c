#include "command.h"
#include "stats.h"

#include <stdio.h>
#include <unistd.h>

void progress_start(progress *p, bool quiet, const char *name, long pixels)
{
    *p = (progress){.on = !quiet && isatty(STDERR_FILENO), .start = stats_clock(), .pixels = pixels, .name = name};
    p->shown = p->start;
}

void progress_show(void *user, long done, long all)
{
    enum { BAR = 30 };
    progress *p = user;
    double now = stats_clock(), gone = now - p->start, share = (double)done / (double)all;
    if (!p->on || now - p->shown < 0.1)
        return;
    p->shown = now;
    char bar[BAR + 1];
    for (int k = 0; k < BAR; k++)
        bar[k] = k < (int)(share * BAR) ? '#' : '.';
    bar[BAR] = 0;
    fprintf(stderr, "\r%.24s [%s] %3.0f %%  %.1f Mpixel/s  %.1f s left \033[K", p->name, bar, 100 * share,
            share * (double)p->pixels / gone / 1e6, gone / share - gone);
}

void progress_end(progress *p)
{
    if (p->on && p->shown > p->start)
        fprintf(stderr, "\r\033[K");
}
