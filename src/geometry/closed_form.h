/* The kinds of surfaces with closed forms, as data: their parameters in the scene file, their constructors, and what
 * exports need. A new kind is one file, with its methods and its closed_form, and one line in CLOSED_FORMS.
 */
#ifndef KAGE_GEOMETRY_CLOSED_FORM_H
#define KAGE_GEOMETRY_CLOSED_FORM_H

#include "base/frame.h"
#include "geometry/surface.h"

/* NAME of each kind: the word of the scene file; form_NAME is its closed_form. */
#define CLOSED_FORMS(NAME)                                                                                             \
    NAME(plane)                                                                                                        \
    NAME(rectangle)                                                                                                    \
    NAME(disc)                                                                                                         \
    NAME(box)                                                                                                          \
    NAME(sphere)                                                                                                       \
    NAME(cylinder)                                                                                                     \
    NAME(cone)                                                                                                         \
    NAME(torus)                                                                                                        \
    NAME(ellipsoid)

#define SHAPE_SMALL 1e-6 /* shorter lengths are refused: their squares would vanish beside others in float */

/* The values of a shape's parameters, each where its form_parameter says. */
typedef struct shape_values {
    vec3 v[3];   /* places and directions */
    double r[2]; /* lengths, in scene units */
    bool open;
} shape_values;

typedef enum form_type {
    FORM_PLACE,     /* [x, y, z], in v: moving the shape moves it. A form has one, or two opposite ends */
    FORM_VECTOR,    /* [x, y, z], in v */
    FORM_DIRECTION, /* the same with a length above 0 */
    FORM_EDGE,      /* [x, y, z] whose length matters and is above 0 */
    FORM_LENGTH,    /* 0 or more, in r */
    FORM_POSITIVE,  /* SHAPE_SMALL or more, in r */
    FORM_OPEN,      /* true or false, in open; false by default. All others are required */
} form_type;

typedef struct form_parameter {
    const char *key; /* as in the scene file; NULL after the last one */
    form_type type;
    int slot;             /* in shape_values' v or r */
    const char *expected; /* of vectors: what an error says was expected */
} form_parameter;

/* Why no surface can be made. */
typedef struct form_fault {
    const char *key;     /* the parameter that is wrong; NULL: all of them together */
    const char *message; /* what is wrong and what was expected; NULL: out of memory */
} form_fault;

/* A flat part: Q = O + u U + w W. */
typedef struct flat_part {
    vec3 O, U, W;
    double rim; /* the radius of a disc, in units of u and w; 0: there is no such part; -1: no disc */
} flat_part;

/* Q(u,w) as three texts in the expression language, with the middle (shape_centred) at the origin. */
typedef struct form_formula {
    char xyz[3][384];
    double u[2], w[2]; /* the range */
} form_formula;

typedef struct closed_form {
    const char *name;
    const form_parameter *parameters;

    /* NULL: an error, with the reason in *fault, which the caller has cleared. */
    surface *(*make)(const shape_values *v, form_fault *fault);

    /* Whether the part is flat, and then its frame. NULL: none is. */
    bool (*flat)(const shape_values *v, int part, flat_part *out);

    /* Q as formulas, for shapes of one part. True displacement uses them, as a parametric patch, where closest points
     * have no closed form. False, or NULL: there are none. */
    bool (*formula)(const shape_values *v, form_formula *out);

    bool solid; /* has an inside, unless it is open: light that passes through the surface is refracted */

    /* The same shape for POV-Ray, as povray/smooth.c reads it. NULL: POV-Ray gets a mesh. */
    const char *povray;
} closed_form;

#define DECLARE_FORM(NAME) extern const closed_form form_##NAME;
CLOSED_FORMS(DECLARE_FORM)
#undef DECLARE_FORM

#define COUNT_FORM(NAME) +1
enum { CLOSED_FORM_COUNT = 0 CLOSED_FORMS(COUNT_FORM) };
#undef COUNT_FORM

extern const closed_form *const closed_forms[CLOSED_FORM_COUNT];

/* Their names, separated and followed by a space, as a string literal. */
#define FORM_NAME(NAME) #NAME " "
#define CLOSED_FORM_NAMES CLOSED_FORMS(FORM_NAME)

/* The shape moved so that the middle of its places is in the origin; *middle: where it was. */
shape_values shape_centred(const closed_form *form, const shape_values *v, vec3 *middle);

/* In surface.c. The formula of a shape that turns about the frame's y: rho and y are functions of w alone, u is the
 * angle from x to z.
 */
void formula_revolve(form_formula *f, frame axes, const char *rho, const char *y);

/* Also there. Two ranges of (u,w), as the member `extent` of surface_ops: 0..1 for both, and -pi..pi for u with 0..pi
 * for w. */
void extent_unit(const surface *f, int part, double u[2], double w[2]);
void extent_polar(const surface *f, int part, double u[2], double w[2]);

/* Also there. The member `bend` of flat surfaces: u, w and the height are linear along a ray. */
void bend_flat(const surface *f, int part, int n, const rays *x, const closest_points *p, path_bends *out);

/* Within REACH of the distance at which a gradient of 1/distance would be infinite, it is below BEND_MORE of what it
 * was. */
#define BEND_REACH 0.25
#define BEND_MORE (1 / (1 - BEND_REACH))

#endif
