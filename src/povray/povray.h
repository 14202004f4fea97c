/* A scene for POV-Ray 3.7 that shows what kage shows (docs/povray.md). */
#ifndef KAGE_POVRAY_POVRAY_H
#define KAGE_POVRAY_POVRAY_H

#include "scene/scene.h"

typedef struct pov_options {
    const char *command;      /* that made the file, for its first lines */
    bool no_cast;             /* objects without a bump cast no shadows */
    const progress *progress; /* NULL: none */
    double share;             /* of the work that is done when an object begins; pov_write sets it */
} pov_options;

/* The least accurate mesh of a file that was written. */
typedef struct pov_report {
    const char *coarse;    /* the object whose mesh is coarse, since it had too many triangles; NULL: none is */
    double height, pixels; /* the largest error of its heights, in scene units and in pixels */
} pov_report;

/* Whether POV-Ray can show the scene. False with errors in *e. */
bool pov_possible(const scene *s, errors *e);

/* Write the scene to `path`, displaced if scene->displaced, otherwise without bumps. False with errors in *e. */
bool pov_write(const scene *s, const pov_options *o, const char *path, pov_report *report, errors *e);

#endif
