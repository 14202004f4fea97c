/* Watches a file for changes. */
#include "look/watch.h"

#include <sys/stat.h>

static watch_mark mark_of(const char *path)
{
    struct stat about;
    if (stat(path, &about) != 0)
        return (watch_mark){0};
    return (watch_mark){(long long)about.st_mtim.tv_sec, (long long)about.st_mtim.tv_nsec, (long long)about.st_size,
                        (unsigned long long)about.st_ino, true};
}

static bool same(watch_mark a, watch_mark b)
{
    return a.seconds == b.seconds && a.nanoseconds == b.nanoseconds && a.size == b.size && a.number == b.number &&
           a.there == b.there;
}

void watch_start(watch *w, const char *path)
{
    w->path = path;
    w->read = w->seen = mark_of(path);
}

bool watch_look(watch *w)
{
    const watch_mark now = mark_of(w->path), before = w->seen;
    w->seen = now;
    if (!now.there || now.size == 0 || same(now, w->read) || !same(now, before))
        return false;
    w->read = now;
    return true;
}
