/* The Damerau-Levenshtein distance between words. Three rows of its table are kept. */
#include "base/spelling.h"

#include <stdio.h>
#include <string.h>

/* By ASCII, whatever the locale is. */
static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c + 32) : c; }

int spelling_distance(const char *a, size_t n, const char *b, size_t m)
{
    int row[3][SPELLING_LONGEST + 1];
    for (size_t i = 0; i <= n; i++)
        for (size_t j = 0; j <= m; j++) {
            int *d = row[i % 3], *above = row[(i + 2) % 3], *before = row[(i + 1) % 3];
            if (i == 0 || j == 0) {
                d[j] = (int)(i + j);
                continue;
            }
            d[j] = above[j - 1] + (lower(a[i - 1]) != lower(b[j - 1]));
            d[j] = above[j] + 1 < d[j] ? above[j] + 1 : d[j];
            d[j] = d[j - 1] + 1 < d[j] ? d[j - 1] + 1 : d[j];
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]) &&
                before[j - 2] + 1 < d[j])
                d[j] = before[j - 2] + 1;
        }
    return row[n % 3][m];
}

void spelling_nearest(const char *text, const char *words, char *out, size_t size)
{
    int best = (int)(strlen(text) + 2) / 3 + 1; /* nearer than about a third of the word */
    *out = 0;
    if (strlen(text) > SPELLING_LONGEST)
        return;
    for (const char *w = words; *w;) {
        size_t n = strcspn(w, " ");
        int d = n <= SPELLING_LONGEST ? spelling_distance(text, strlen(text), w, n) : best;
        if (d < best) {
            best = d;
            snprintf(out, size, "%.*s", (int)n, w);
        }
        w += n + (w[n] == ' ');
    }
}

int spelling_among(const char *word, const char *words)
{
    size_t length = strlen(word);
    for (int i = 0; *words; i++) {
        size_t n = strcspn(words, " ");
        if (n == length && strncmp(words, word, n) == 0)
            return i;
        words += n + (words[n] == ' ');
    }
    return -1;
}
