/* Finds the nearest known word, for messages such as "unknown key 'colour', did you mean 'color'?". */
#ifndef KAGE_BASE_SPELLING_H
#define KAGE_BASE_SPELLING_H

#include <stddef.h>

enum { SPELLING_LONGEST = 31 }; /* longer words are never near */

/* The number of letters inserted, deleted, replaced or swapped with the next to turn a into b, ignoring case. n and m
 * are the lengths, at most SPELLING_LONGEST. */
int spelling_distance(const char *a, size_t n, const char *b, size_t m);

/* Write the word nearest to `text` into out, of words separated by spaces; "" if more than a third of its letters
 * differ. */
void spelling_nearest(const char *text, const char *words, char *out, size_t size);

/* The index of a word among words separated by spaces, -1 where it is none of them. */
int spelling_among(const char *word, const char *words);

#endif
