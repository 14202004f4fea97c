/* The stages of a picture: coarse at once, then full, then antialiased. */
#ifndef KAGE_LOOK_STAGE_H
#define KAGE_LOOK_STAGE_H

/* A stage is its divisor: a picture of STAGE_COARSEST has an eighth of the columns and rows. */
enum { STAGE_FINE = 0, STAGE_FULL = 1, STAGE_COARSEST = 8 };

/* What is known of the time that a picture takes, from those before. */
typedef struct stage_cost {
    double fixed; /* seconds besides the pixels */
    double pixel; /* seconds a pixel, of one sample; 0: not known yet */
} stage_cost;

/* A stage took so long; fixed: of it besides the pixels. The newest counts half. */
void stage_learn(stage_cost *c, double fixed, double seconds, double pixels);

/* The first stage: the finest that takes a frame's time at most. */
int stage_first(const stage_cost *c, double pixels);

/* The stage after this one. Slow pictures come in between, too. -1: none. antialiased: there is such a stage. */
int stage_next(const stage_cost *c, int stage, double pixels, int antialiased);

#endif
