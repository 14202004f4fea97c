/* Stores past the cache, of rows that are written once: the processor need not read a cache line before it is
 * overwritten, and keeps what it has in the cache. Only on x86-64; elsewhere they are plain stores.
 */
#ifndef KAGE_FILM_STREAM_H
#define KAGE_FILM_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/real.h"

enum { STREAM_ROW = 16 }; /* floats: a whole cache line, else such stores are slower than others */

#if defined(__x86_64__) && !defined(KAGE_DOUBLE)
#include <xmmintrin.h>
static inline void stream_four(float *to, const real *from) { _mm_stream_ps(to, _mm_loadu_ps(from)); }
static inline void stream_end(void) { _mm_sfence(); }
#else
static inline void stream_four(float *to, const real *from)
{
    for (int k = 0; k < 4; k++)
        to[k] = (float)from[k];
}
static inline void stream_end(void) {}
#endif

/* Whether rows of STREAM_ROW floats from `to` on, one every `stride` floats, are whole cache lines. */
static inline bool stream_fits(const float *to, size_t stride)
{
    return (uintptr_t)to % (STREAM_ROW * sizeof *to) == 0 && stride % STREAM_ROW == 0;
}

/* Copy `rows` rows. The thread calls stream_end before another one reads them. */
static inline void stream_rows(float *to, size_t stride, int rows, const real *from)
{
    for (int k = 0; k < rows; k++)
        for (int c = 0; c < STREAM_ROW; c += 4)
            stream_four(to + (size_t)k * stride + c, from + k * STREAM_ROW + c);
}

#endif
