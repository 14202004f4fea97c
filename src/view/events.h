/* SDL's events as those of the view. */
#ifndef KAGE_VIEW_EVENTS_H
#define KAGE_VIEW_EVENTS_H

#include <SDL.h>

#include "look/state.h"

/* The keys that are held, as the events have told so far: SDL_GetModState is ahead of them. */
typedef struct held_keys {
    SDL_Keymod mod;
} held_keys;

/* False: the event means nothing to the view. */
bool events_read(held_keys *held, const SDL_Event *from, view_event *to);

#endif
