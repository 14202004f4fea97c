/* Displaced surfaces for tests. */
#ifndef KAGE_TESTS_DISPLACE_H
#define KAGE_TESTS_DISPLACE_H

#include "displaced/displaced.h"
#include "support/check.h"

/* The displaced surface of f by P, which adds to *c. */
static inline surface *displace(const surface *f, bump *P, displaced_counts *c)
{
    assert_true(displaced_has_form(f) && displaced_has_bounds(P));
    surface *d = displaced_new(f, P, NULL, &(bool){true});
    assert_non_null(d);
    ((displaced *)d)->counts = c;
    return d;
}

#endif
