/* How a bump-mapped surface shadows itself by its bumps: the choices by name. */
#ifndef KAGE_METHOD_BUMP_SHADOW_H
#define KAGE_METHOD_BUMP_SHADOW_H

#include <stdbool.h>

typedef enum bump_shadow_kind {
    BUMP_SHADOW_NONE,    /* bumps cast no shadows on their own surface, as in the paper */
    BUMP_SHADOW_MARCH,   /* n steps towards the light through the slab between Pmin and Pmax */
    BUMP_SHADOW_HORIZON, /* by the height of the horizon in each direction [Max 1986] */
    BUMP_SHADOW_EXACT,   /* by the displaced surface (displaced.h) */
} bump_shadow_kind;

typedef struct bump_shadow {
    bump_shadow_kind kind;
    int n;
} bump_shadow;

enum { BUMP_SHADOW_NAME_SIZE = 16 };

/* Read a name: none march:N horizon exact, with N in 1..METHOD_STEPS_MAX. False: it is none of these. */
bool bump_shadow_parse(const char *text, bump_shadow *b);

/* Write its name. */
void bump_shadow_name(bump_shadow b, char name[BUMP_SHADOW_NAME_SIZE]);

/* The names, for messages. */
extern const char bump_shadow_expected[];

#endif
