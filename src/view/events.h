/* SDL's events as those of the view. */
#ifndef KAGE_VIEW_EVENTS_H
#define KAGE_VIEW_EVENTS_H

#include <SDL.h>

#include "look/state.h"

/* False: the event means nothing to the view. */
bool events_read(const SDL_Event *from, view_event *to);

#endif
