/* The camera: where it stands, and the rays of a picture's samples. */
#ifndef KAGE_SCENE_CAMERA_H
#define KAGE_SCENE_CAMERA_H

#include <stdbool.h>

#include "base/vec3.h"
#include "wave/wave.h"

/* The ray of a pixel, with x and y in -1..1 over the image:
 *     a pinhole      from + t (forward + x right + y up), so that s is no unit vector
 *     orthographic   from + x right + y up + t forward
 * In both t is the depth along forward. */
typedef struct camera {
    vec3 from;
    vec3 forward;   /* unit */
    vec3 right, up; /* to the edges of the image: half the picture's width and height, a pinhole's at unit depth */
    bool orthographic;
} camera;

/* A camera at `from` that looks at `at`; fov is the horizontal angle of the picture in degrees. False where the
 * directions have no sense: at = from, or up along the view. */
bool camera_look(camera *c, vec3 from, vec3 at, vec3 up, double fov, int width, int height);

/* Likewise an orthographic one, whose picture is `across` scene units wide. */
bool camera_orthographic(camera *c, vec3 from, vec3 at, vec3 up, double across, int width, int height);

/* A coordinate of pixels (0..size, fractions within a pixel) on the picture from -1 to 1. */
static inline real camera_screen(double p, int size) { return (real)(2 * p / size - 1); }

/* Rays through n places of the picture, x and y in -1..1 from the left and from the bottom, in two steps: what all have
 * in common (a pinhole's r, an orthographic camera's s), and the rest. */
void camera_common(const camera *c, int n, rays *to);
void camera_rays(const camera *c, int n, const real *x, const real *y, rays *to);

/* One ray, into a lane of `to`: through (x,y) in pixels from the top left of a picture of width x height. */
void camera_ray(const camera *c, int width, int height, double x, double y, rays *to, int lane);

#endif
