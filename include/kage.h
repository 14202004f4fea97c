/* libkage: shadows on bump-mapped surfaces (Sumi and Noma's method), as a library. C99 and C++17.
 *
 *     kage_scene *scene;
 *     kage_film *film;
 *     kage_errors *errors;
 *     if (kage_scene_load("scene.yaml", NULL, &scene, &errors) != KAGE_OK) ...
 *     if (kage_render(scene, NULL, &film, &errors) != KAGE_OK) ...
 *     kage_film_write_png(film, "picture.png", 8, &errors);
 *
 * docs/library.md shows whole programs, docs/scene.md describes scenes, docs/method.md the methods.
 *
 * Ownership. What a function gives back through a pointer to a pointer is the caller's, who frees it with the function
 * of its name. Texts and structs behind a `const` pointer belong to the object that they were asked from, and live as
 * long as it does. The library keeps no pointer that it is given, but for the call.
 *
 * Errors are values. A function that can fail returns a kage_status, and puts a list of what is wrong where its last
 * parameter points; that parameter may be NULL. On KAGE_OK and KAGE_CANCELLED the list is NULL. The list is the
 * caller's: kage_errors_free. On failure the other results are NULL.
 *
 * Threads. Every function may be called from several threads at once. Scenes and films may be shared by threads: any
 * number may render one scene, and read or write one film, at the same time. Only freeing an object needs that nobody
 * else uses it.
 *
 * The caller's process. The library prints nothing, never ends the process, and changes neither signal handlers nor
 * locale nor the settings of OpenMP. It starts a program of its own, kage-import, to read models from files (see
 * kage_load_options), and reads the environment variable KAGE_IMPORT; it does not fork.
 *
 * Options are structs in which all zero means the default, so that `= {0}` in C, or `= {}` in C++, is how to begin one:
 * there is no function to call first and none to forget. Each ends with reserved room, which must stay zero, from which
 * later versions take new options; so programs built with an older header keep working, as their zeros mean what was
 * before. Structs that the library hands out may grow at their end.
 *
 * Units. Lengths are those of the scene; colours are linear, as red, green and blue; pixels count from the top left.
 */
#ifndef KAGE_H
#define KAGE_H

#include <stddef.h>
#include <stdint.h>

#define KAGE_VERSION "0.1.0"

#if defined(__GNUC__)
#define KAGE_API __attribute__((visibility("default")))
#else
#define KAGE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The largest values of some options: pixels along a side of a picture, samples along a side of a pixel, threads. */
enum { KAGE_MAX_SIDE = 32768, KAGE_MAX_AA = 16, KAGE_MAX_THREADS = 1024 };

/* The version of the library that runs, as KAGE_VERSION is that of this header. */
KAGE_API const char *kage_version(void);

/* The numbers that it computes with: "float" or "double". */
KAGE_API const char *kage_precision(void);

/* ---- errors ---- */

typedef enum kage_status {
    KAGE_OK,
    KAGE_BAD_INPUT,   /* the scene, or a file that it names, is wrong or can't be read */
    KAGE_BAD_OPTION,  /* an option or argument of the call is wrong */
    KAGE_NOT_WRITTEN, /* the output can't be written */
    KAGE_NO_MEMORY,
    KAGE_CANCELLED /* by the progress callback */
} kage_status;

typedef struct kage_errors kage_errors;

typedef struct kage_error {
    const char *file;    /* the scene's file, or `--set` for one of kage_load_options.sets; NULL: no place in a file */
    int line, column;    /* from 1, a column is a character; 0 where there is no file */
    const char *text;    /* what is wrong and what was expected, in one line */
    const char *message; /* all of it: `file:line:column: text`, and below the line of the file and a caret; no newline
                            at its end */
} kage_error;

/* How many errors were found; and how many of them the list has, the first ones, for kage_errors_get. */
KAGE_API int kage_errors_found(const kage_errors *errors);
KAGE_API int kage_errors_count(const kage_errors *errors);

/* Error number `index`, from 0. NULL: there is none of that number. */
KAGE_API const kage_error *kage_errors_get(const kage_errors *errors, int index);

KAGE_API void kage_errors_free(kage_errors *errors); /* NULL: nothing */

/* ---- scenes ---- */

typedef struct kage_scene kage_scene;

/* Called now and then while a long call works: `what` is done ("objects", "reading", "unpacking", "checking",
 * "building", "rendering"), and this share of it, 0..1. It runs in the thread that made the call. Not 0: the call ends
 * soon with KAGE_CANCELLED. It may call the library. */
typedef int kage_progress(void *user, const char *what, double share);

typedef struct kage_load_options {
    const char *const *sets; /* changes of the scene, PATH=VALUE as by `kage render --set`; */
    int set_count;           /* so many */
    int threads;             /* that share the work; 0: as many as there are processors */
    kage_progress *progress; /* NULL: none */
    void *user;              /* for progress */

    /* The program that reads models (OBJ, PLY, STL, glTF, OFF). NULL: the environment's KAGE_IMPORT; without that
     * kage-import in the folder of libkage.so (or of the program that libkage.a is in), in ../libexec/kage from there,
     * or in libexec/kage of the prefix that the library was installed to. Without the program a scene with a model is
     * an error of the scene; other scenes do not need it. The program has limited time (3 s and 1 s a MiB) and memory
     * (512 MiB and 96 times the file); a model that crashes it is an error of the scene, too. */
    const char *model_reader;
    void *reserved[8];
} kage_load_options;

/* Read the scene in the file at `path`. options: NULL for the defaults. All errors that can be found at once are in
 * the list. */
KAGE_API kage_status kage_scene_load(const char *path, const kage_load_options *options, kage_scene **scene,
                                     kage_errors **errors);

/* Read a scene from `size` bytes of text (YAML in UTF-8). name: what errors and pictures call it, NULL for "scene".
 * folder: where relative names of files begin, NULL for the current folder. */
KAGE_API kage_status kage_scene_parse(const char *text, size_t size, const char *name, const char *folder,
                                      const kage_load_options *options, kage_scene **scene, kage_errors **errors);

KAGE_API void kage_scene_free(kage_scene *scene); /* NULL: nothing */

typedef struct kage_light_info {
    const char *name;
    const char *kind; /* "point", "spot" or "parallel" */
    double at[3];
    int fades;      /* with the distance */
    int samples[2]; /* of an area light, along its sides; 1 and 1: no area */
} kage_light_info;

/* A model's file, and what was found in it. */
typedef struct kage_model_info {
    const char *file;   /* as the scene says */
    int triangles;      /* that are used */
    int flat;           /* triangles without an area, left out */
    int flipped;        /* triangles whose normals all said that they face the other way, and which do so now */
    int normals;        /* corners whose normal was on the other side of the triangle; they have the triangle's own */
    int untextured;     /* triangles without texture coordinates */
    int mirrored;       /* triangles whose texture is mirrored */
    int texture_points; /* triangles on which the texture has no area */
} kage_model_info;

typedef struct kage_object_info {
    const char *name;
    const char *shape;            /* its kind, as in docs/scene.md */
    const char *copy_of;          /* the object that it is a copy of; NULL: none */
    int transformed;              /* it has a transform */
    const char *material;         /* the material's name */
    const char *color;            /* what its colour is made by, "checker" or "image ..."; NULL: it is constant */
    const char *bump;             /* what its bump is made by; NULL: it has none */
    int mirrors, transparent;     /* its material does */
    const kage_model_info *model; /* NULL: no mesh, or a copy */
    const char *map;              /* its height map's file, as the scene says; NULL: none */
    int map_size[2];              /* of the map, in samples */
    double map_range[2];          /* the lowest and highest sample, before `scale` and `zero` */
    double height[2];             /* bounds of the bump's height P, in scene units */
    int bounded;                  /* P has finite bounds */
} kage_object_info;

typedef struct kage_scene_info {
    const char *path;    /* or the name of a text in memory */
    int width, height;   /* of the picture, in pixels */
    int aa;              /* aa x aa samples a pixel, */
    double aa_threshold; /* where neighbours differ by more than this; below 0: everywhere */
    const char *method;
    int guard, displaced, self_shadow; /* render.guard, render.surface: displaced, render.self_shadow */
    int depth;                         /* how many rays follow one another; 0: no material sends rays on */
    int light_count, object_count;
    const kage_light_info *lights;
    const kage_object_info *objects;
} kage_scene_info;

/* What is in a scene. */
KAGE_API const kage_scene_info *kage_scene_get_info(const kage_scene *scene);

/* Whether the file at `path`, links followed, is one that the scene is made from, which no output should replace. */
KAGE_API int kage_scene_uses_file(const kage_scene *scene, const char *path);

/* Whether `word` is "color", the name of a plane of the scene's films, or what stands before its dot ("N", "uw",
 * "visibility"): what kage_film_write_exr takes as a layer. */
KAGE_API int kage_scene_has_layer(const kage_scene *scene, const char *word);

/* ---- rendering ---- */

/* A yes or no that the scene decides unless the caller does. */
typedef enum kage_choice { KAGE_AS_SCENE, KAGE_YES, KAGE_NO } kage_choice;

typedef struct kage_render_options {
    const char *method;      /* where shadow rays start: none 0 1 2 2+ iter:K march:N exact; NULL: as the scene says */
    kage_choice guard;       /* keep to the slab between the lowest and highest P */
    kage_choice displaced;   /* bumped objects as the displaced surfaces that they stand for; not: bump mapping */
    kage_choice self_shadow; /* bumped objects cast shadows */
    int width, height;       /* in pixels, 1 to KAGE_MAX_SIDE; both 0: as the scene says */
    int crop[4];             /* x0 y0 x1 y1: only pixels x0 <= x < x1, y0 <= y < y1; all 0: the whole picture */
    int aa;                  /* aa x aa samples a pixel, 1 to KAGE_MAX_AA; 0: as the scene says */
    double aa_threshold;     /* these only where neighbours differ by more, above 0 and up to 3; 0: as the scene says */
    int layers;              /* not 0: the film has the other planes besides R, G and B */
    int timing;              /* not 0: kage_stats.stages are timed, which costs about 1 % */
    int threads;             /* that render, 1 to KAGE_MAX_THREADS; 0: as many as there are processors */
    kage_progress *progress; /* NULL: none */
    void *user;              /* for progress */
    void *reserved[8];
} kage_render_options;

typedef struct kage_film kage_film;

/* Render the scene into a new film. options: NULL for the defaults. The bytes of a film depend neither on the threads
 * nor on the crop. A scene that was read for one kind of surface and is first rendered as the other (`displaced`, and
 * the method `exact`) is read again, once for each, from its text and the files that it names, which must still be
 * there, and unchanged, then; what is wrong with it as the other is KAGE_BAD_INPUT. Needs no lock: several threads may
 * render one scene. The film does not need the scene any more. */
KAGE_API kage_status kage_render(kage_scene *scene, const kage_render_options *options, kage_film **film,
                                 kage_errors **errors);

KAGE_API void kage_film_free(kage_film *film); /* NULL: nothing */

/* Pixels of the film: of the crop, where there is one. */
KAGE_API int kage_film_width(const kage_film *film);
KAGE_API int kage_film_height(const kage_film *film);

/* x0 y0 x1 y1: which part of the picture is on the film. */
KAGE_API void kage_film_crop(const kage_film *film, int crop[4]);

/* The planes: R G B; with layers also Z (depth), P.X P.Y P.Z (position), N.X N.Y N.Z (the normal that is shaded), uw.u
 * uw.w, height (P), tau (t0 - t), order (-1 none, 0, 1, 2, 3 for 2+, 4 iter, 5 march, 6 exact), and visibility.NAME
 * (0..1) for each light. */
KAGE_API int kage_film_plane_count(const kage_film *film);
KAGE_API const char *kage_film_plane_name(const kage_film *film, int index); /* NULL: none of that number */

/* The values of a plane, without a copy: height x width, row by row from the top. NULL: it has none of that name. */
KAGE_API const float *kage_film_plane(const kage_film *film, const char *name);

/* Write R, G and B as a PNG of 8 or 16 bits (0: 8) in sRGB. The file appears whole or not at all, and replaces what is
 * there. In it, as in an EXR, is the text of the scene, and what else the picture is made from, but no path, no clock
 * and no name of the machine. KAGE_NOT_WRITTEN: why is in the list. */
KAGE_API kage_status kage_film_write_png(const kage_film *film, const char *path, int bits, kage_errors **errors);

/* Write planes as an OpenEXR of 32-bit floats, linear. layers: names for kage_scene_has_layer with commas between them;
 * NULL: all planes. A name that the film does not have is KAGE_BAD_OPTION. threads: 0 for all processors; the bytes are
 * the same. Otherwise as kage_film_write_png. */
KAGE_API kage_status kage_film_write_exr(const kage_film *film, const char *path, const char *layers, int threads,
                                         kage_errors **errors);

/* Whether the file is a PNG that kage has written, of any version. */
KAGE_API int kage_file_is_picture(const char *path);

/* One stage of rendering. */
typedef struct kage_stage {
    const char *name;
    double seconds; /* in some of the tiles, which are timed; of use as a share of the sum over the stages */
} kage_stage;

/* How many bumped samples used an order in the end. */
typedef struct kage_order_count {
    const char *order; /* none 0 1 2 2+ iter march exact */
    int64_t samples;
} kage_order_count;

typedef struct kage_stats {
    double seconds;      /* the time that rendering took, by the wall clock */
    const char *method;  /* that was asked for */
    int64_t camera_rays; /* samples */
    int64_t shadow_rays;
    int64_t secondary_rays; /* reflected, refracted and straight through */
    int64_t height_lookups; /* evaluations of P */
    int64_t bumped;         /* samples on bumped objects, by the method; */
    int64_t fell_back;      /* those of them with another order than asked for */
    int64_t unconfirmed;    /* hits of displaced surfaces that are not certain to the last digits */
    int stage_count, order_count;
    const kage_stage *stages; /* all seconds are 0 without kage_render_options.timing */
    const kage_order_count *orders;
} kage_stats;

/* What rendering the film counted. */
KAGE_API const kage_stats *kage_film_get_stats(const kage_film *film);

/* ---- one pixel ---- */

/* One method on the sample of a pixel. */
typedef struct kage_probe_row {
    const char *method;
    int guard;             /* 0: the bare formula */
    double tau, t0;        /* t0 = t + tau: the shadow rays start at r + s t0, */
    double origin[3];      /* which is here */
    const char *fell_back; /* the order that was used instead; NULL: none */
    const double *visible; /* for each light of the scene, 0..1: the share of it that is seen */
    double color[3];       /* without light that is mirrored or let through */
} kage_probe_row;

/* Every value on the way of the ray through the middle of a pixel. Names as in docs/method.md. */
typedef struct kage_probe {
    double r[3], s[3]; /* the ray r + s t */
    int object;        /* index into kage_scene_info.objects; -1: it meets nothing, and what follows is 0 */
    double t, u, w;
    double Q[3], Qu[3], Qw[3], Quu[3], Quw[3], Qww[3], n[3];
    int bumped; /* 0: no bump, and what follows up to `rows` is 0 */
    double P, Pu, Pw, Puu, Puw, Pww, Pmin, Pmax;
    double n_bump[3]; /* n' */
    int regular;      /* 0: |n| is 0 against Qu and Qw: the smooth normal is used, and the next three are 0 */
    double sn, a, b;  /* s.n/|n|, and s in the tangent plane */
    double slab[2];   /* tau where the ray enters and leaves the slab between Pmin and Pmax */
    int row_count;
    const kage_probe_row *rows;
    int sends; /* the material sends rays on, whose light is in no row */
} kage_probe;

/* Follow the ray of pixel x, y by each method. The smooth surfaces, as the scene was read. */
KAGE_API kage_status kage_scene_probe(kage_scene *scene, int x, int y, kage_probe **probe, kage_errors **errors);
KAGE_API void kage_probe_free(kage_probe *probe); /* NULL: nothing */

/* ---- a survey: how steep the bumps are where the camera sees them ---- */

typedef struct kage_bump_survey {
    int samples; /* of 40 000 over the picture; 0: no bump, or the camera does not see it, and what follows is 0 */
    double slope_median, slope_95, slope_max; /* tan of the angle between n and n'; 95 of 100 are below the second */
    double fell_back[3];                      /* in per cent of the samples, by the orders 1 and 2; [0] is 0 */
} kage_bump_survey;

typedef enum kage_warning_code {
    KAGE_WARN_FLAT_TRIANGLES, /* value: triangles of a model without an area, which are left out */
    KAGE_WARN_UNBOUNDED,      /* P has no bounds, so the guard has no slab and march:N falls back to order 0 */
    KAGE_WARN_STEEP,          /* value: slope_95, above bound: more than the orders 0, 1 and 2 are good for */
    KAGE_WARN_FALLS_BACK      /* value: the larger of fell_back, above bound: the view is flat against the bumps */
} kage_warning_code;

typedef struct kage_warning {
    kage_warning_code code;
    int object; /* index into kage_scene_info.objects */
    double value, bound;
} kage_warning;

typedef struct kage_survey {
    const kage_bump_survey *objects; /* one for each of kage_scene_info.objects */
    int warning_count;
    const kage_warning *warnings; /* in the order of the objects */
} kage_survey;

KAGE_API kage_status kage_scene_survey(kage_scene *scene, kage_survey **survey, kage_errors **errors);
KAGE_API void kage_survey_free(kage_survey *survey); /* NULL: nothing */

/* ---- POV-Ray ---- */

typedef struct kage_povray_options {
    const char *command;   /* for the file's first lines: what made it. NULL: "libkage" */
    int no_cast;           /* not 0: objects without a bump cast no shadows */
    kage_choice displaced; /* as in kage_render_options */
    void *reserved[8];
} kage_povray_options;

typedef struct kage_povray_report {
    const char *coarse; /* the object whose mesh is the worst of those that had to be coarse; NULL: none. The scene's */
    double height;      /* by how much its heights may be off, in scene units, */
    double pixels;      /* and in pixels */
    void *reserved[8];
} kage_povray_report;

/* Write the scene for POV-Ray 3.7 (docs/povray.md), options and report may be NULL. What
 * POV-Ray does not have is KAGE_BAD_INPUT. */
KAGE_API kage_status kage_scene_write_povray(kage_scene *scene, const char *path, const kage_povray_options *options,
                                             kage_povray_report *report, kage_errors **errors);

/* ---- methods ---- */

typedef struct kage_method {
    const char *name; /* with K or N for a number: "iter:K" */
    const char *text; /* what it does, in one line */
} kage_method;

KAGE_API int kage_method_count(void);
KAGE_API kage_method kage_method_get(int index); /* of NULLs: there is none of that number */

/* Whether kage_render_options.method may be this: "2+", "iter:4". */
KAGE_API int kage_method_is_known(const char *name);

#ifdef __cplusplus
}
#endif

#endif
