/* Tests of several properties for each of several things: one cmocka test for each pair, named "thing: property", so
 * that a failure names both. *state of a test points to the thing's number, an int.
 */
#ifndef KAGE_PROPERTIES_H
#define KAGE_PROPERTIES_H

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "support/check.h"

typedef struct property {
    const char *name;
    CMUnitTestFunction run;
    bool (*of)(int thing); /* the things that have it; NULL: all */
} property;

/* Returns how many failed. `setup` and `end` as cmocka has them for a group, or NULL. */
static inline int run_properties(const char *group, const property *p, int properties, const char *const *things,
                                 int count, CMFixtureFunction setup, CMFixtureFunction end)
{
    const size_t most = (size_t)properties * (size_t)count;
    struct CMUnitTest *tests = calloc(most, sizeof *tests);
    char(*names)[80] = calloc(most, sizeof *names);
    int *number = calloc((size_t)count, sizeof *number), failed = -1;
    size_t n = 0;
    for (int thing = 0; tests && names && number && thing < count; thing++) {
        number[thing] = thing;
        for (int k = 0; k < properties; k++) {
            if (p[k].of && !p[k].of(thing))
                continue;
            snprintf(names[n], sizeof *names, "%s: %s", things[thing], p[k].name);
            tests[n] = (struct CMUnitTest){names[n], p[k].run, NULL, NULL, &number[thing]};
            n++;
        }
    }
    if (n > 0)
        failed = _cmocka_run_group_tests(group, tests, n, setup, end);
    free(tests);
    free(names);
    free(number);
    return failed;
}

#endif
