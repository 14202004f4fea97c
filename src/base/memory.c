/* Blocks with a head in front, which tells their size and budget. Counts change by atomic steps. */
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct budget {
    int64_t used, peak;
    int64_t holders; /* owners and blocks */
};

enum { HEAD = 64 }; /* a line of cache, so that blocks begin at one */

typedef struct head {
    budget *from;
    size_t size; /* of the block */
    void *start; /* what malloc gave */
} head;

static head *head_of(void *p) { return (head *)(void *)((char *)p - HEAD); }

/* ---- budgets ---- */

static void hold(budget *b, int n)
{
    if (b && __atomic_add_fetch(&b->holders, n, __ATOMIC_ACQ_REL) == 0)
        free(b);
}

budget *budget_open(void)
{
    budget *b = calloc(1, sizeof *b);
    hold(b, 1);
    return b;
}

budget *budget_share(budget *b)
{
    hold(b, 1);
    return b;
}

void budget_close(budget *b) { hold(b, -1); }

int64_t budget_used(const budget *b) { return __atomic_load_n(&b->used, __ATOMIC_RELAXED); }

int64_t budget_peak(const budget *b) { return __atomic_load_n(&b->peak, __ATOMIC_RELAXED); }

int64_t memory_default(void)
{
    const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    return pages > 0 && page > 0 ? (int64_t)pages * page / 8 * 7 : 0;
}

static void refuse(memory *m, int64_t wanted)
{
    int64_t none = 0;
    __atomic_compare_exchange_n(&m->wanted, &none, wanted, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
}

bool memory_count(memory *by, budget *from, int64_t bytes)
{
    if (!from)
        return true;
    const int64_t now = __atomic_add_fetch(&from->used, bytes, __ATOMIC_RELAXED);
    if (bytes > 0 && by && by->limit > 0 && now > by->limit) {
        __atomic_sub_fetch(&from->used, bytes, __ATOMIC_RELAXED);
        refuse(by, now);
        return false;
    }
    int64_t peak = budget_peak(from);
    while (now > peak &&
           !__atomic_compare_exchange_n(&from->peak, &peak, now, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
        ;
    return true;
}

/* ---- blocks ---- */

/* Whether the block may be taken; it is counted then. */
static bool may_take(memory *m, size_t size)
{
    return size < (size_t)INT64_MAX / 2 && (!m || memory_count(m, m->from, (int64_t)size));
}

/* The block behind a head at `start`, or NULL, when the count is taken back. */
static void *begin(memory *m, void *start, size_t size)
{
    budget *from = m ? m->from : NULL;
    if (!start) {
        memory_count(NULL, from, -(int64_t)size);
        return NULL;
    }
    *(head *)start = (head){from, size, start};
    hold(from, 1);
    return (char *)start + HEAD;
}

void *memory_aligned(memory *m, size_t align, size_t size)
{
    void *start = NULL;
    if (!may_take(m, size))
        return NULL;
    return begin(m, posix_memalign(&start, align, size + HEAD) == 0 ? start : NULL, size);
}

void *memory_new(memory *m, size_t size) { return memory_aligned(m, HEAD, size); }

/* Zeroed pages cost nothing until they are touched, so calloc's are used, whatever they begin at. */
void *memory_zeroed(memory *m, size_t size)
{
    if (!may_take(m, size))
        return NULL;
    char *start = calloc(1, size + 2 * HEAD);
    if (!start)
        return begin(m, NULL, size);
    char *at = start + (HEAD - (uintptr_t)start % HEAD) % HEAD;
    void *p = begin(m, at, size);
    head_of(p)->start = start;
    return p;
}

void *memory_resize(memory *m, void *p, size_t size)
{
    if (!p)
        return memory_new(m, size);
    const size_t before = head_of(p)->size;
    void *q = memory_new(m, size);
    if (!q)
        return NULL;
    memcpy(q, p, before < size ? before : size);
    memory_free(p);
    return q;
}

void memory_free(void *p)
{
    if (!p)
        return;
    const head h = *head_of(p);
    free(h.start);
    memory_count(NULL, h.from, -(int64_t)h.size);
    hold(h.from, -1);
}

/* ---- words ---- */

const char *memory_size(int64_t bytes, char text[MEMORY_SIZE])
{
    static const char *const unit[] = {"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
    double x = (double)bytes;
    int k = 0;
    for (; x >= 1024 && k < 6; k++)
        x /= 1024;
    const double tenths = k == 0 || x >= 100 ? 1 : 10;
    snprintf(text, MEMORY_SIZE, "%.4g %s", ceil(x * tenths) / tenths, unit[k]);
    return text;
}

const char *memory_words(const memory *m, char text[MEMORY_WORDS])
{
    const int64_t wanted = m ? __atomic_load_n(&m->wanted, __ATOMIC_RELAXED) : 0;
    char needed[MEMORY_SIZE], most[MEMORY_SIZE];
    if (wanted > 0)
        snprintf(text, MEMORY_WORDS,
                 "there is not enough memory: it needs %s, more than the limit of %s (--max-memory)",
                 memory_size(wanted, needed), memory_size(m->limit, most));
    else
        snprintf(text, MEMORY_WORDS, "there is not enough memory");
    return text;
}
