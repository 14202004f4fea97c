/* How much a scene and its files may have. A caller may make limits smaller than the built-in ones, which stand where
 * each kind of thing is read.
 */
#ifndef KAGE_BASE_LIMITS_H
#define KAGE_BASE_LIMITS_H

#include <stdint.h>

/* What is limited; kage_limits in kage.h says what each means. */
typedef enum limit_kind {
    LIMIT_SCENE,
    LIMIT_NESTING,
    LIMIT_EXPRESSION,
    LIMIT_EXPRESSION_NESTING,
    LIMIT_PICTURE,
    LIMIT_DEPTH,
    LIMIT_OBJECTS,
    LIMIT_FILE,
    LIMIT_SIDE,
    LIMIT_SAMPLES,
    LIMIT_COPIES,
    LIMIT_TRIANGLES,
    LIMIT_PATCHES,
    LIMIT_KINDS
} limit_kind;

typedef struct cap {
    int64_t most;
    const char *by; /* at the end of a message, what set it: " (--limit side)"; "": it is built in */
} cap;

/* What a caller has set; most 0: nothing. */
typedef struct limits {
    cap of[LIMIT_KINDS];
} limits;

/* The limit that holds. set: the caller's, or NULL. */
static inline cap limit_of(const limits *set, limit_kind kind, int64_t built_in)
{
    return set && set->of[kind].most > 0 ? set->of[kind] : (cap){built_in, ""};
}

#endif
