/* The files of a list of points among themselves. */
#ifndef KAGE_POINTS_PARTS_H
#define KAGE_POINTS_PARTS_H

#include "points/points.h"

#include <stddef.h>

/* A file that is read. */
typedef struct points_file {
    const char *name; /* in messages */
    char *text;       /* with a 0 behind it */
    size_t size;
    const points_column *column;
    const char *label;
    const progress *progress;
    points *p;
    errors *e;
} points_file;

/* What a column of the file is: one asked for, the label, or nothing. */
enum { POINTS_NOTHING = -1, POINTS_LABEL = -2 };
int points_find(const points_file *f, const char *name, size_t length);

/* Where `at` is, and what is wrong there. Always false. */
bool points_wrong_at(const points_file *f, const char *at, const char *message);

/* The error that there is not enough memory. Always false. */
bool points_no_memory(const points_file *f);

/* Memory for n rows of the columns that the file has. kind[k]: what its column k is. False with an error. */
bool points_make(points_file *f, int columns, const int *kind, size_t n);

/* The number at *at, which moves behind it. False: there is none. */
bool points_number(const char **at, double *x);

/* "" or what is wrong with a value of the column. */
void points_check(const points_column *c, double x, char message[256]);

/* The index of a label; -1: there are too many, or it is too long. */
int32_t points_label(points *p, const char *text, size_t length, int32_t row);

bool points_csv(points_file *f);
bool points_ply(points_file *f);

#endif
