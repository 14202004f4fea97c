/* A scene for POV-Ray 3.7 that shows what kage shows (docs/povray.md). */
#ifndef KAGE_POVRAY_POVRAY_H
#define KAGE_POVRAY_POVRAY_H

#include "scene/scene.h"

typedef struct pov_options {
    const char *command; /* for the file's first lines: what made it */
    bool no_cast;        /* objects without a bump cast no shadows */
} pov_options;

/* What the writer has to say besides. */
typedef struct pov_report {
    const char *coarse;    /* the object whose mesh is the worst of those that had to be coarse; NULL: none */
    double height, pixels; /* what its heights are off at most: in scene units, on the screen */
} pov_report;

/* Whether POV-Ray has all that is in the scene. */
bool pov_possible(const scene *s, errors *e);

/* Write the scene to `path`, as scene->displaced says with bumps or without. False with the errors in *e. */
bool pov_write(const scene *s, const pov_options *o, const char *path, pov_report *report, errors *e);

#endif
