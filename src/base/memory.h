/* Memory with a limit. What takes much is asked for here, before it is taken: map samples, tables, triangles,
 * hierarchies, films, buffers. A budget counts what its blocks take together, from any thread; a block is given back to
 * the budget that it came from, so that whoever frees it need not know that. Small things are malloc's.
 */
#ifndef KAGE_BASE_MEMORY_H
#define KAGE_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Counts bytes. It lives until its last owner closes it and its last block is freed. */
typedef struct budget budget;

/* A budget with one owner. NULL: out of memory. */
budget *budget_open(void);
budget *budget_share(budget *b); /* one owner more; NULL of NULL */
void budget_close(budget *b);    /* one owner less; NULL: nothing */
int64_t budget_used(const budget *b);
int64_t budget_peak(const budget *b);

/* A budget as one call uses it. NULL in its place, or zero: nothing is counted and there is no limit. */
typedef struct memory {
    budget *from;
    int64_t limit;  /* bytes that the budget may be at; 0: no limit */
    int64_t wanted; /* what it would have been at by the first block that was refused; 0: none was */
} memory;

/* A limit that leaves the machine some of its memory: 7/8 of it. 0: how much it has is not known. */
int64_t memory_default(void);

/* A block of `size` bytes, at a multiple of 64; zeroed; at 64 bytes behind a multiple of `align`, a power of two. NULL:
 * refused, or out of memory. m may be NULL. */
void *memory_new(memory *m, size_t size);
void *memory_zeroed(memory *m, size_t size);
void *memory_aligned(memory *m, size_t align, size_t size);

/* The block p, or NULL, with another size; perhaps elsewhere. It is counted where m says. NULL: p is as before. */
void *memory_resize(memory *m, void *p, size_t size);

void memory_free(void *p); /* NULL: nothing */

/* Count bytes that a library takes, of the budget `from` (NULL: nothing); less than 0 gives them back. False: refused;
 * `by` may be NULL. */
bool memory_count(memory *by, budget *from, int64_t bytes);

/* "there is not enough memory", and where the limit refused it the figures. */
enum { MEMORY_WORDS = 160 };
const char *memory_words(const memory *m, char text[MEMORY_WORDS]);

/* Bytes as "9.4 GB", of 1024^3 bytes a GB, as --max-memory takes them; rounded up. */
enum { MEMORY_SIZE = 32 };
const char *memory_size(int64_t bytes, char text[MEMORY_SIZE]);

#endif
