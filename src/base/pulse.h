/* What long work asks between its parts: whether it is to go on. Who gives it decides how often the caller's callback
 * is called for that. */
#ifndef KAGE_BASE_PULSE_H
#define KAGE_BASE_PULSE_H

#include <stdbool.h>

typedef struct pulse {
    /* False: end soon, what is computed is not used. False again from then on. */
    bool (*beat)(void *user);
    void *user;
} pulse;

/* p may be NULL. */
static inline bool pulse_beats(const pulse *p) { return !p || p->beat(p->user); }

#endif
