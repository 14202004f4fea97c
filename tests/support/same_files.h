/* Whole files, and whether two have the same bytes. */
#ifndef KAGE_TESTS_SAME_FILES_H
#define KAGE_TESTS_SAME_FILES_H

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "support/check.h"

static inline char *slurp(const char *path, size_t *size)
{
    FILE *f = fopen(path, "rb");
    struct stat st;
    assert_non_null(f);
    assert_int_equal(fstat(fileno(f), &st), 0);
    char *bytes = malloc((size_t)st.st_size + 1);
    *size = fread(bytes, 1, (size_t)st.st_size, f);
    fclose(f);
    return bytes;
}

static inline void assert_same_files(const char *a, const char *b)
{
    size_t m, n;
    char *p = slurp(a, &m), *q = slurp(b, &n);
    assert_int_equal(m, n);
    assert_memory_equal(p, q, n);
    free(p);
    free(q);
}

#endif
