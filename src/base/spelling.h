/* Which word was meant: for messages such as "unknown key 'colour', did you mean 'color'?". */
#ifndef KAGE_BASE_SPELLING_H
#define KAGE_BASE_SPELLING_H

#include <stddef.h>

enum { SPELLING_LONGEST = 31 }; /* letters of a word that is compared */

/* How many letters must be inserted, left out, replaced or swapped with the next to make b of a, ignoring case. n and m
 * are the lengths, at most SPELLING_LONGEST. */
int spelling_distance(const char *a, size_t n, const char *b, size_t m);

/* Write the nearest to `text` of words separated by spaces into out, or "" where more than a third of the letters
 * differ. */
void spelling_nearest(const char *text, const char *words, char *out, size_t size);

/* The index of a word among words separated by spaces, -1 where it is none of them. */
int spelling_among(const char *word, const char *words);

#endif
