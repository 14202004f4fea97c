/* Text in the system's monospaced font. */
#ifndef KAGE_VIEW_FONT_H
#define KAGE_VIEW_FONT_H

#include <SDL.h>

typedef struct font font;

/* NULL: there is none; why it failed is in SDL_GetError(). pixels: the height of its letters, with their space. */
font *font_open(int pixels);
void font_close(font *f); /* NULL: nothing */

/* From one letter to the next, and from one line to the next, in pixels. */
int font_advance(const font *f);
int font_line(const font *f);

/* Draw a text of one line in UTF-8 with its top left at x, y, not beyond x1. Returns the x behind it. */
int font_draw(font *f, SDL_Surface *to, int x, int y, int x1, SDL_Color color, const char *text);

/* The letters of a text. */
int font_letters(const char *text);

#endif
