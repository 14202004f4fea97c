/* Pinhole and orthographic cameras, and their rays. */
#ifndef KAGE_SCENE_CAMERA_H
#define KAGE_SCENE_CAMERA_H

#include <stdbool.h>

#include "base/vec3.h"
#include "wave/wave.h"

/* The ray of a pixel, with x and y in -1..1 over the image:
 *     pinhole        from + t (forward + x right + y up), so s is not a unit vector
 *     orthographic   from + x right + y up + t forward
 * In both t is the depth along forward. */
typedef struct camera {
    vec3 from;
    vec3 forward;   /* unit */
    vec3 right, up; /* half the image's width and height in scene units; of a pinhole at unit depth */
    bool orthographic;
} camera;

/* A pinhole camera at `from` that looks at `at`; fov is the horizontal angle of the picture in degrees. False where at
 * = from or `up` is parallel to the view. */
bool camera_look(camera *c, vec3 from, vec3 at, vec3 up, double fov, int width, int height);

/* An orthographic camera, whose picture is `across` scene units wide. */
bool camera_orthographic(camera *c, vec3 from, vec3 at, vec3 up, double across, int width, int height);

/* A pixel coordinate, 0..size, as -1..1. */
static inline real camera_screen(double p, int size) { return (real)(2 * p / size - 1); }

/* The rays through n points of the picture, x and y in -1..1 from the left and from the bottom. camera_common sets what
 * all rays share (a pinhole's r, an orthographic camera's s), camera_rays the rest. */
void camera_common(const camera *c, int n, rays *to);
void camera_rays(const camera *c, int n, const real *x, const real *y, rays *to);

/* The ray through (x,y), in pixels from the top left of a picture of width x height, into one lane of `to`. */
void camera_ray(const camera *c, int width, int height, double x, double y, rays *to, int lane);

#endif
