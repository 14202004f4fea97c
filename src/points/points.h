/* Lists of places with further numbers and a label each, from a CSV or a PLY file.
 *
 * CSV: the first line names the columns, separated by commas, semicolons, tabs or spaces; it may begin with '#', as
 * numpy.savetxt writes it. Empty lines and lines that begin with '#' are skipped, fields may be in double quotes.
 *
 * PLY: the properties of the element `vertex`, ASCII or binary; other elements are skipped if they come later. The
 * label is a whole number there.
 */
#ifndef KAGE_POINTS_POINTS_H
#define KAGE_POINTS_POINTS_H

#include <stdint.h>

#include "base/errors.h"
#include "base/progress.h"

/* POINTS_MOST: of a list. */
enum { POINTS_MOST = 1 << 28, POINTS_COLUMNS = 16, POINTS_LABELS = 256, POINTS_LABEL_SIZE = 64 };

/* A column that is asked for: its name and range. `needed`: a file without it is an error. */
typedef struct points_column {
    const char *name;
    double lo, hi;
    bool needed;
    const char *expected; /* in messages: "a factor from 1e-6 to 1e6" */
} points_column;

typedef struct points {
    int32_t n;
    double *v[POINTS_COLUMNS]; /* by the columns asked for; NULL: the file does not have it */
    int32_t *label;            /* of each row: an index; -1: empty; NULL: the file does not have it */
    int labels;
    char name[POINTS_LABELS][POINTS_LABEL_SIZE]; /* of each label */
    int32_t first[POINTS_LABELS];                /* the first row that has it */
    int32_t *line;                               /* of each row; NULL: a binary file */
    char *text;                                  /* of a CSV file, for errors */
} points;

/* Read the file at `path`, `name` in messages; the columns end with one without a name. label: the name of the labels'
 * column. False: all errors are in e. In either case free it. */
bool points_read(const char *path, const char *name, const points_column *columns, const char *label, const progress *w,
                 points *p, errors *e);
void points_free(points *p);

/* Add an error about a row. Always false. */
bool points_error(const points *p, const char *name, int32_t row, const char *message, errors *e);

#endif
