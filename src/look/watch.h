/* Watches a file for changes, by its date, size and number. */
#ifndef KAGE_LOOK_WATCH_H
#define KAGE_LOOK_WATCH_H

#include <stdbool.h>
#include <sys/types.h>

typedef struct watch_mark {
    long long seconds, nanoseconds, size;
    unsigned long long number; /* editors often write a new file and rename it */
    bool there;
} watch_mark;

typedef struct watch {
    const char *path;
    watch_mark read; /* as the file was when it was last taken */
    watch_mark seen; /* at the last look */
} watch;

void watch_start(watch *w, const char *path);

/* Look at the file. True: it has changed since it was taken and is the same as at the last look, so that whoever writes
 * it has probably finished; it counts as taken now. A file that is missing or empty is still being written. */
bool watch_look(watch *w);

#endif
