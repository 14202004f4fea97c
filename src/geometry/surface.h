/* Smooth parametric surfaces Q(u,w): where rays meet them, and their shape there. A surface knows nothing of scenes,
 * bumps or lights.
 *
 * A surface is a table of functions over a wave, and the constants that they need. The constructors below make those
 * with closed forms; patch/surface.h and mesh/mesh.h make others. surface_free frees any. A surface does not change
 * once it is made, and any number of threads may use it. All lengths are in scene units, coordinates left-handed with y
 * up; n = Qu x Qw points outward. Seen from outside, u goes to the right where w goes down, like the pixels of an
 * image.
 */
#ifndef KAGE_GEOMETRY_SURFACE_H
#define KAGE_GEOMETRY_SURFACE_H

#include <stdbool.h>

#include "base/affine.h"
#include "base/vec3.h"
#include "wave/wave.h"

typedef struct surface surface;

/* Bounds of second derivatives by t along rays: of (u,w) and of the height; and how far in t they hold. */
typedef struct path_bends {
    real u[LANES], w[LANES], h[LANES], reach[LANES];
} path_bends;

enum { AROUND_U = 1, AROUND_W = 2 };

/* The methods of one kind of surface. Each is a stage: n lanes, no allocation, reentrant. */
typedef struct surface_ops {
    const char *kind; /* as in the scene file */

    /* The nearest hit with 0 < t < h->t: where there is one, set h->t, and h->id = id. A mesh sets h->part, too. */
    void (*hit)(const surface *f, int n, const rays *x, int32_t id, hits *h);

    /* The same for rays that start on a surface. Those that start on this one, from->id[i] = id, begin at from->at on
     * its from->part; the start itself is no hit. */
    void (*hit_own)(const surface *f, int n, const rays *x, const ray_origins *from, int32_t id, hits *h);

    /* Where on the surface the hits r + s t are: the part, u and w. A mesh leaves part[i] as `hit` has set it, the
     * triangle. */
    void (*locate)(const surface *f, int n, const rays *x, const real *t, int32_t *part, real *u, real *w);

    /* The place whose normal leads to r + s t, a point near the surface; the ray meets the surface on part[i] at
     * (u[i],w[i]). (u,w) may go beyond the part's edge. On a mesh part[i] changes with the triangle. NULL: there is no
     * closed form; Newton's steps from the ray's hit find it (render/place.c). */
    void (*foot)(const surface *f, int n, const rays *x, const real *t, int32_t *part, real *u, real *w);

    /* Qu and Qw at (u,w); order 1: also Q, which most surfaces set in any case; order 2: also Quu, Quw and Qww. */
    void (*eval)(const surface *f, int n, const int32_t *part, const real *u, const real *w, int order, partials *q);

    /* Set lit[i] = 0 where the surface is hit at a t in (0,1): r + s t is a segment to a light. */
    void (*occlude)(const surface *f, int n, const rays *x, real *lit);

    /* The same for segments that start on the surface itself, on its part[i]; the start is no hit. NULL: no ray that
     * starts on the surface meets it again. */
    void (*occlude_own)(const surface *f, int n, const rays *x, const int32_t *part, real *lit);

    /* The range of (u,w) on a part. Ends are infinite where the surface has none. */
    void (*extent)(const surface *f, int part, double u[2], double w[2]);

    /* The bounding box, up to rounding. Ends are infinite where the surface has none. */
    void (*box)(const surface *f, double lo[3], double hi[3]);

    bool flat; /* all parts are: Quu, Quw and Qww are 0 */
    int parts; /* how many; 1 for a mesh, though `part` is a triangle there */

    /* For displaced surfaces (displaced.h), over one part of the surface alone. All three are NULL where closest points
     * have no closed form, as on an ellipsoid. */

    /* The stretch t0 <= t <= t1 of each ray, within 0..end[i], that may meet Q + P n/|n| for Pmin <= P <= Pmax: all
     * such places are in it. t0 > t1: there is none. */
    void (*bound)(const surface *f, int part, int n, const rays *x, const real *end, real Pmin, real Pmax, real *t0,
                  real *t1);

    /* The closest point of the surface to each r + s t: (u,w), the height over it, and the gradients of the three.
     * (u,w) may lie outside the extent. */
    void (*closest)(const surface *f, int part, int n, const rays *x, const real *t, closest_points *p);

    /* How the closest points p, to r + s t, move on along each ray. */
    void (*bend)(const surface *f, int part, int n, const rays *x, const closest_points *p, path_bends *out);

    /* AROUND_U and AROUND_W: closest points that pass an end of the extent go on at its other end. */
    int around;

    /* Whether `bound` also admits places over (u,w) beyond the part's extent; hits there do not count. */
    bool unclamped;
} surface_ops;

struct surface {
    const surface_ops *ops;
    void (*free)(surface *f); /* NULL: it owns nothing but itself */
    int others;               /* its other owners: base/shared.h */
};

/* The constructors return NULL for the arguments stated at each, or out of memory. */

/* Q = origin + u U + w W; over all (u,w), or over 0..1 where `bounded`. NULL where U and W are parallel, zero or not
 * finite. */
surface *plane_new(vec3 origin, vec3 U, vec3 W, bool bounded);

/* The box with two opposite corners and sides along the axes. part is the face, 2 axis + (1 on the high side). On each
 * face (u,w) go over 0..1 along the two other axes, in the order for which n points outward. NULL where a side is 0. */
surface *box_new(vec3 from, vec3 to);

/* Q = centre + radius (sin w cos u, cos w, sin w sin u); u the longitude in -pi..pi, w the angle from the upper pole in
 * 0..pi, in radians. NULL where radius <= 0. */
surface *sphere_new(vec3 centre, double radius);

/* Q = centre + u U + w W, u^2 + w^2 <= radius^2, U and W unit vectors at right angles to each other and to the normal:
 * with frame.h's about it, U = x and W = -z. NULL where radius <= 0 or the normal has no direction. */
surface *disc_new(vec3 centre, vec3 normal, double radius);

/* The cone between two discs across the axis from..to; with equal radii a cylinder. Q = from + rho (cos u X + sin u Z)
 * + y Y, Y along the axis and X and Z across it as frame.h has them; u the angle in -pi..pi, w the way down the side
 * from `to`, in scene units. Unless `open`, with caps: part 1 at `to`, 2 at `from`, each with disc_new's (u,w) about
 * its own n. NULL where from = to, or no radius is above 0. */
surface *cone_new(vec3 from, double from_radius, vec3 to, double to_radius, bool open);

/* Q = centre + (major + minor cos w) (cos u X + sin u Z) - minor sin w Y: u the angle around the axis, w that around
 * the tube, 0 on the outside and downwards positive, both in -pi..pi. NULL unless 0 < minor < major and the axis has a
 * direction. */
surface *torus_new(vec3 centre, vec3 axis, double major, double minor);

/* The image of a surface by an affine map. `from` must outlive it, and must not be such an image itself. It has the
 * (u,w) of `from`. Where the map mirrors, u runs the other way in its extent (on a plane: -u), so that n still points
 * outward. Where the map does not keep angles, images of round surfaces cannot be displaced. NULL where the map reduces
 * volumes to 0. */
surface *surface_transformed(const surface *from, const affine *m);

/* One owner more, who frees it, too. Returns f. */
surface *surface_share(surface *f);

/* NULL is allowed. */
void surface_free(surface *f);

#endif
