/* The bumps' own shadows by name. */
#include "method/bump_shadow.h"

#include <stdio.h>
#include <string.h>

#include "method/method.h"

const char bump_shadow_expected[] = "none, march:N, horizon or exact";

static const char *const names[] = {"none", "march", "horizon", "exact"};

bool bump_shadow_parse(const char *text, bump_shadow *b)
{
    method m;
    for (int k = 0; k < 4; k++)
        if (k != BUMP_SHADOW_MARCH && strcmp(text, names[k]) == 0) {
            *b = (bump_shadow){(bump_shadow_kind)k, 0};
            return true;
        }
    if (!method_parse(text, &m) || m.kind != METHOD_MARCH)
        return false;
    *b = (bump_shadow){BUMP_SHADOW_MARCH, m.n};
    return true;
}

void bump_shadow_name(bump_shadow b, char name[BUMP_SHADOW_NAME_SIZE])
{
    snprintf(name, BUMP_SHADOW_NAME_SIZE, b.kind == BUMP_SHADOW_MARCH ? "%s:%d" : "%s", names[b.kind], b.n);
}
