/* The stages of a picture. */
#include "look/stage.h"

/* Of 60 frames a second, less what showing one takes; and how long a picture may take before a coarser one is shown
 * first. */
static const double frame = 0.0145, patience = 0.25;

void stage_learn(stage_cost *c, double fixed, double seconds, double pixels)
{
    const double each = (seconds > fixed ? seconds - fixed : 0) / pixels;
    c->fixed = c->pixel > 0 ? (c->fixed + fixed) / 2 : fixed;
    c->pixel = c->pixel > 0 ? (c->pixel + each) / 2 : each;
}

static double seconds_of(const stage_cost *c, int stage, double pixels)
{
    return c->fixed + c->pixel * pixels / ((double)stage * stage);
}

int stage_first(const stage_cost *c, double pixels)
{
    if (!(c->pixel > 0))
        return STAGE_COARSEST / 2;
    for (int stage = STAGE_FULL; stage < STAGE_COARSEST; stage *= 2)
        if (seconds_of(c, stage, pixels) <= frame)
            return stage;
    return STAGE_COARSEST;
}

int stage_next(const stage_cost *c, int stage, double pixels, int antialiased)
{
    if (stage > STAGE_FULL)
        return seconds_of(c, STAGE_FULL, pixels) <= patience ? STAGE_FULL : stage / 2;
    return stage == STAGE_FULL && antialiased ? STAGE_FINE : -1;
}
