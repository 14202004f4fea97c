/* libkage: shadows on bump-mapped surfaces (Sumi and Noma's method), as a library. C99 and C++17.
 * SPDX-License-Identifier: MIT
 *
 *     kage_scene *scene;
 *     kage_film *film;
 *     kage_errors *errors;
 *     if (kage_scene_load("scene.yaml", NULL, &scene, &errors) != KAGE_OK) ...
 *     if (kage_render(scene, NULL, &film, &errors) != KAGE_OK) ...
 *     kage_film_write(film, "picture.png", NULL, &errors);
 *
 * docs/library.md shows whole programs, docs/scene.md describes scenes, docs/method.md the methods.
 *
 * Ownership. The caller owns results that a function returns through a pointer to a pointer, and frees them with
 * kage_..._free. Texts and structs behind a `const` pointer belong to the object that the function was called with, and
 * are valid until that is freed. The library keeps no pointer of the caller after the call.
 *
 * Errors are values. A function that can fail returns a kage_status and stores a list of errors through its last
 * parameter, which may be NULL. On KAGE_OK and KAGE_CANCELLED the list is NULL. The caller frees it by
 * kage_errors_free. On failure the other results are NULL.
 *
 * Threads. Every function may be called from several threads at once. Threads may share scenes and films: any number
 * may render one scene, and read or write one film, at the same time. An object must not be in use when it is freed.
 *
 * The caller's process. The library prints nothing, never ends the process, and changes neither signal handlers nor
 * locale nor the settings of OpenMP. It starts the program kage-import to read models from files (see
 * kage_load_options), and reads the environment variable KAGE_IMPORT; it does not fork.
 *
 * Options are structs in which zero means the default: begin with `= {0}` in C, or `= {}` in C++. Each ends with
 * reserved fields, which must stay zero; later versions put new options there, so programs built with an older header
 * keep working. Structs that the library returns may grow at their end.
 *
 * Units. Lengths are those of the scene; colours are linear, as red, green and blue; pixels count from the top left.
 */
#ifndef KAGE_H
#define KAGE_H

#include <stddef.h>
#include <stdint.h>

#define KAGE_VERSION "1.0.0"

#if defined(__GNUC__)
#define KAGE_API __attribute__((visibility("default")))
#else
#define KAGE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The largest values of some options: pixels along a side of a picture, samples along a side of a pixel, threads, K of
 * iter:K and N of march:N. */
enum { KAGE_MAX_SIDE = 32768, KAGE_MAX_AA = 16, KAGE_MAX_THREADS = 1024, KAGE_MAX_STEPS = 1024 };

/* The version of the library; KAGE_VERSION is that of this header. */
KAGE_API const char *kage_version(void);

/* The number type of the tracer: "float" or "double". */
KAGE_API const char *kage_precision(void);

/* ---- errors ---- */

typedef enum kage_status {
    KAGE_OK,
    KAGE_BAD_INPUT,   /* the scene, or a file that it names, is wrong or can't be read */
    KAGE_BAD_OPTION,  /* an option or argument of the call is wrong */
    KAGE_NOT_WRITTEN, /* the output can't be written */
    KAGE_NO_MEMORY,
    KAGE_CANCELLED,  /* by the progress callback */
    KAGE_OUT_OF_TIME /* by kage_limits.seconds */
} kage_status;

typedef struct kage_errors kage_errors;

typedef struct kage_error {
    const char *file;    /* the scene's file, or `--set` for one of kage_load_options.sets; NULL: not in a file */
    int line, column;    /* from 1, columns in characters; 0 without a file */
    const char *text;    /* what is wrong and what was expected, in one line */
    const char *message; /* `file:line:column: text`, then the line of the file and a caret; no newline at the end */
} kage_error;

/* How many errors were found, and how many of them, the first ones, are in the list. */
KAGE_API int kage_errors_found(const kage_errors *errors);
KAGE_API int kage_errors_count(const kage_errors *errors);

/* Error number `index`, from 0. NULL: no such error. */
KAGE_API const kage_error *kage_errors_get(const kage_errors *errors, int index);

KAGE_API void kage_errors_free(kage_errors *errors); /* NULL: nothing */

/* ---- scenes ---- */

typedef struct kage_scene kage_scene;

/* Called now and then during a long call, in the caller's thread. what: the current step ("objects", "reading",
 * "smoothing", "unpacking", "checking", "building", "horizons", "rendering", "writing"); share: how much of it is done,
 * 0..1. If it returns nonzero, the call ends soon with KAGE_CANCELLED. It may call the library. */
typedef int kage_progress(void *user, const char *what, double share);

/* Arrays in the caller's memory, in place of files: where a scene can name a file, "array:NAME" names one of them. They
 * are copied during the call. A name has up to 59 letters, digits, _ and -. Pictures of the scene name the array, but
 * do not hold it. */

typedef enum kage_type { KAGE_U8, KAGE_U16, KAGE_F32, KAGE_F64 } kage_type;

/* A height map or an image. Whole numbers mean what those of a PNG mean, floats what those of an EXR mean. A height map
 * has 1 channel; an image has 1 (grey) or 3 (red, green, blue). One channel more is alpha: height maps ignore it, of
 * images it must be 1. */
typedef struct kage_image_array {
    const char *name;
    int width, height, channels;
    kage_type type;
    const void *samples; /* height rows from the top, of width pixels, of `channels` samples */
} kage_image_array;

/* A model. All means what it means in a PLY or OBJ file: coordinates are right-handed, corners go round
 * counterclockwise seen from outside, and v goes up. */
typedef struct kage_mesh_array {
    const char *name;
    int vertex_count, triangle_count;
    const double *positions, *normals, *uvs; /* 3, 3 and 2 numbers a vertex; normals, uvs: NULL: none */
    const uint32_t *triangles;               /* 3 vertices each */
} kage_mesh_array;

/* What a call may take, and what a scene and its files may have (docs/limits.md). Zero: the default. Those below
 * `seconds` can only be smaller than the built-in ones (kage_limit_get tells these). They hold where a scene is
 * read, and for what it reads later: what passes one is an error of the scene (KAGE_BAD_INPUT) and is refused before it
 * is taken, but for triangles, which are counted when their file has been decoded. */
typedef struct kage_limits {
    int64_t memory;  /* bytes that a scene, those that are changed from it, and their films may take together while the
                      * call runs. What would take more is refused before it is taken, with KAGE_NO_MEMORY and the
                      * figure that it needs. 0: 7/8 of the machine's memory; below 0: no limit */
    double seconds;  /* of the call, by the wall clock; then it ends as if it were cancelled, with KAGE_OUT_OF_TIME. 0:
                      * no limit */
    int64_t scene;   /* bytes of the scene's text */
    int64_t nesting; /* levels of maps and lists in it */
    int64_t expression;         /* bytes of an expression */
    int64_t expression_nesting; /* levels of brackets, signs and powers in it */
    int64_t picture;            /* pixels along a side of the picture */
    int64_t depth;              /* rays in a row: the scene's render.depth */
    int64_t objects;            /* in the scene's file */
    int64_t file;               /* bytes of a map, an image, a list of copies, patches or a model */
    int64_t side;               /* samples along a side of a map or an image */
    int64_t samples;            /* of a map or an image */
    int64_t copies;             /* points of a list of them */
    int64_t triangles;          /* of a model */
    int64_t patches;            /* of an object */
    void *reserved[6];
} kage_limits;

/* One of the limits of what a scene and its files may have. */
typedef struct kage_limit {
    const char *name; /* as the option --limit has it: the field's, with - for _; NULL: no such limit */
    const char *text; /* what is counted, in one line */
    int64_t most;     /* the built-in limit */
    int bytes;        /* it is of bytes */
    size_t offset;    /* of its int64_t in kage_limits */
} kage_limit;

KAGE_API int kage_limit_count(void);
KAGE_API kage_limit kage_limit_get(int index);

typedef struct kage_load_options {
    const char *const *sets; /* set_count changes of the scene, PATH=VALUE as for `kage render --set` */
    int set_count;
    int threads;             /* 0: as many as there are processors */
    kage_progress *progress; /* NULL: none */
    void *user;              /* for progress */

    /* The program that reads models (OBJ, PLY, STL, glTF, OFF, COLLADA, FBX, 3DS). NULL: the environment's KAGE_IMPORT;
     * without that kage-import in the folder of libkage.so (or of the program that libkage.a is in), in ../libexec/kage
     * from there, or in libexec/kage of the prefix that the library was installed to. Without the program a scene with
     * a model is an error of the scene; other scenes do not need it. It has limited time (3 s of a processor and 1 s a
     * MiB, ten times as much by the clock) and memory
     * (512 MiB and 96 times the file); a model that crashes it is an error of the scene, too. */
    const char *model_reader;
    const kage_image_array *images;
    const kage_mesh_array *meshes;
    int image_count, mesh_count;
    const kage_limits *limits; /* NULL: the defaults; of kage_scene_change: those of `scene`, as are fields of 0. Where
                                * one is tighter than there, all files are read again */
    long survey; /* not 0: only what kage_scene_get_info and kage_scene_survey need is built now, and what displaced
                  * surfaces, `exact` and `horizon` need at the first render: of a map ten times its memory */
    void *reserved[3];
} kage_load_options;

/* Read the scene in the file at `path`. options: NULL for the defaults. The list has all errors that were found. */
KAGE_API kage_status kage_scene_load(const char *path, const kage_load_options *options, kage_scene **scene,
                                     kage_errors **errors);

/* Read a scene from `size` bytes of text (YAML in UTF-8). name: what errors and pictures call it, NULL for "scene".
 * folder: where relative names of files begin, NULL for the current folder. */
KAGE_API kage_status kage_scene_parse(const char *text, size_t size, const char *name, const char *folder,
                                      const kage_load_options *options, kage_scene **scene, kage_errors **errors);

/* A new scene: `scene` with options->sets after its own, as if it had been read with all of them. `scene` stays as it
 * is, and either may be freed first. It is not read from files again, but for what the changes touch, and for files
 * that have changed: maps, images, models and the hierarchies over surfaces are shared between the scenes. Of an image
 * or a model that is given again under its name the new one counts. options: threads 0 and model_reader NULL mean those
 * that `scene` was read with. */
KAGE_API kage_status kage_scene_change(kage_scene *scene, const kage_load_options *options, kage_scene **changed,
                                       kage_errors **errors);

KAGE_API void kage_scene_free(kage_scene *scene); /* NULL: nothing */

typedef struct kage_light_info {
    const char *name;
    const char *kind; /* "point", "spot" or "parallel" */
    double at[3];
    int fades;      /* its light fades with distance */
    int samples[2]; /* of an area light, along its sides; 1 and 1: no area */
} kage_light_info;

/* A model's file, and its defects and repairs. */
typedef struct kage_model_info {
    const char *file;   /* as the scene says */
    int triangles;      /* that are used */
    int flat;           /* triangles without an area, left out */
    int flipped;        /* triangles that were turned over, as all of their normals are on the other side */
    int normals;        /* corners whose normal was on the other side of the triangle; replaced by the triangle's */
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
    const char *color;            /* the kind of its colour, "checker" or "image ..."; NULL: constant */
    const char *bump;             /* the kind of its bump; NULL: none */
    int mirrors, transparent;     /* its material reflects; lets light through */
    const kage_model_info *model; /* NULL: not a mesh, or a copy */
    const char *map;              /* its height map's file, as the scene says; NULL: none */
    int map_size[2];              /* of the map, in samples */
    double map_range[2];          /* the lowest and highest sample, before `scale` and `zero` */
    double height[2];             /* bounds of the bump's height P, in scene units */
    int bounded;                  /* P has finite bounds */
    int copies;                   /* how many copies of copy_of it is, from a list; 0: it is one object */
    const char *bump_of;          /* the object under whose key `bump` the bump is, often itself; NULL: no bump */
    double bump_scale;            /* the bump's `scale` */
    int map_bits;                 /* of the map's samples, which have 2^map_bits values from 0 to 1; 0: floats */
    double map_smooth;            /* the radius of its smoothing, in samples; 0: none */
} kage_object_info;

typedef struct kage_camera_info {
    double eye[3], at[3], up[3]; /* as the scene says; eye: its `from` */
    double fov, width;           /* fov in degrees, 0: orthographic; width in scene units, 0: a pinhole */
} kage_camera_info;

typedef struct kage_scene_info {
    const char *path;    /* or the name of a text in memory */
    int width, height;   /* of the picture, in pixels */
    int aa;              /* aa x aa samples a pixel */
    double aa_threshold; /* only where neighbours differ by more than this; below 0: everywhere */
    const char *method;
    int guard, displaced, self_shadow; /* render.guard, render.surface: displaced, render.self_shadow */
    int depth;                         /* rays in a row, with the camera's; 0: no secondary rays */
    int light_count, object_count;
    const kage_light_info *lights;
    const kage_object_info *objects;
    const char *bump_shadow; /* render.bump_shadow */
    int shifted;             /* render.shade: shifted */
    kage_camera_info camera;
    const char *text; /* the scene's YAML, with the changes in it that it was read with; NULL: out of memory */
} kage_scene_info;

/* What is in a scene. */
KAGE_API const kage_scene_info *kage_scene_get_info(const kage_scene *scene);

/* Write kage_scene_info.text. A change is written where the value stood that it replaces, or behind the last entry of
 * its map; all other bytes, comments and layout, stay. A scene that is read from the file is the same one, if files
 * that it names with relative names are found from there, and arrays are given again. The file appears whole or not at
 * all.
 */
KAGE_API kage_status kage_scene_write(const kage_scene *scene, const char *path, kage_errors **errors);

/* Whether the file at `path`, links followed, was read for the scene, so that no output should replace it. */
KAGE_API int kage_scene_uses_file(const kage_scene *scene, const char *path);

/* Called by kage_file_paths. path: as before the `=` of a change; value: the text of a scalar, NULL for a map or a
 * list.
 */
typedef void kage_path_call(void *user, const char *path, const char *value);

/* Tell every path that a change of the scene in the file can have, in the order of the file: for shells and editors.
 * The file is read as YAML alone, so this is quick and it need not be a good scene. call: in the caller's thread. */
KAGE_API kage_status kage_file_paths(const char *path, kage_path_call *call, void *user, kage_errors **errors);

/* Whether `word` is "color", the name of a plane of the scene's films, or what stands before its dot ("N", "uw",
 * "visibility"): what kage_write_options.layers has. */
KAGE_API int kage_scene_has_layer(const kage_scene *scene, const char *word);

/* ---- rendering ---- */

/* Yes, no, or the scene's own setting. */
typedef enum kage_choice { KAGE_AS_SCENE, KAGE_YES, KAGE_NO } kage_choice;

typedef struct kage_render_options {
    const char *method; /* where shadow rays start: none 0 1 2 2+ iter:K march:N exact auto[:E]; NULL: as the scene */
    kage_choice guard;  /* keep to the slab between the lowest and highest P */
    kage_choice displaced;     /* yes: bumped objects are truly displaced surfaces; no: bump mapping */
    kage_choice self_shadow;   /* bumped objects cast shadows */
    int width, height;         /* in pixels, 1 to KAGE_MAX_SIDE; both 0: as the scene says */
    int crop[4];               /* x0 y0 x1 y1: only pixels x0 <= x < x1, y0 <= y < y1; all 0: the whole picture */
    int aa;                    /* aa x aa samples a pixel, 1 to KAGE_MAX_AA; 0: as the scene says */
    double aa_threshold;       /* aa only where neighbours differ by more, above 0 and up to 3; 0: as the scene says */
    int layers;                /* not 0: the film has the other planes besides R, G and B */
    int timing;                /* not 0: kage_stats.stages are timed, which costs about 1 % */
    int threads;               /* 1 to KAGE_MAX_THREADS; 0: as many as there are processors */
    kage_progress *progress;   /* NULL: none */
    void *user;                /* for progress */
    const char *bump_shadow;   /* the bumps' own shadows: none march:N horizon exact; NULL: as the scene says */
    kage_choice shifted;       /* yes: shade where the shadow rays start; no: at the smooth hit */
    struct kage_film *reuse;   /* a film that is no longer needed: see kage_render. NULL: none */
    const kage_limits *limits; /* NULL: the scene's memory, and any time */
    void *reserved[4];
} kage_render_options;

/* The best picture for its cost: options.method, options.bump_shadow, and options.shifted = KAGE_YES. */
#define KAGE_RELIEF_METHOD "auto:0.15"
#define KAGE_RELIEF_BUMP_SHADOW "march:8"

typedef struct kage_film kage_film;

/* Render the scene into a new film, of at most 2^28 pixels. options: NULL for the defaults. The bytes of a film depend
 * neither on the threads nor on the crop. The first render with another value of `displaced`, with `exact`, `auto` or
 * `horizon`, reads the scene again from its text and files, which must be unchanged; errors then are KAGE_BAD_INPUT.
 * Several threads may render one scene without a lock. The film may outlive the scene.
 *
 * options.reuse is freed by the call, whatever it returns, but its memory becomes that of the new film where there is
 * enough of it: pictures of one size, one after another, then cost no page faults. The bytes are the same. */
KAGE_API kage_status kage_render(kage_scene *scene, const kage_render_options *options, kage_film **film,
                                 kage_errors **errors);

KAGE_API void kage_film_free(kage_film *film); /* NULL: nothing */

/* The size of the film (with a crop, of the crop) in pixels. */
KAGE_API int kage_film_width(const kage_film *film);
KAGE_API int kage_film_height(const kage_film *film);

/* The part of the picture that is on the film: x0 y0 x1 y1. */
KAGE_API void kage_film_crop(const kage_film *film, int crop[4]);

/* The planes: R G B; with layers also Z (depth; 1e30 where nothing is met), P.X P.Y P.Z (position), N.X N.Y N.Z (the
 * normal that is shaded), uw.u uw.w, height (P), tau (t0 - t_hit), order (-1 none, 0, 1, 2, 3 for 2+, 4 iter, 5 march,
 * 6 exact), and visibility.NAME (0..1) for each light. All are finite: none has a NaN or an infinity. */
KAGE_API int kage_film_plane_count(const kage_film *film);
KAGE_API const char *kage_film_plane_name(const kage_film *film, int index); /* NULL: no such plane */

/* The values of a plane, not a copy: height x width, row by row from the top. NULL: no such plane. */
KAGE_API const float *kage_film_plane(const kage_film *film, const char *name);

/* The picture in sRGB, into height rows of 4 bytes a pixel, red, green, blue and 255: the very values of an 8-bit PNG.
 * row_bytes: from the start of a row to that of the next; 0: 4 times the width. rgba has height times row_bytes bytes,
 * but for what follows the last row's pixels. threads: 0: as many as there are processors. */
KAGE_API kage_status kage_film_srgb(const kage_film *film, uint8_t *rgba, size_t row_bytes, int threads);

/* A text that a file of the film holds. */
typedef struct kage_metadata {
    const char *name, *value; /* the film owns them */
} kage_metadata;

/* What kage_film_write puts into a file, as PNG texts or EXR attributes: Software, kage:file (the scene's name),
 * kage:scene (its text), kage:set (its changes, a line each), kage:crop, kage:shadow, kage:guard. NULL fields: no text
 * of that index. */
KAGE_API int kage_film_metadata_count(const kage_film *film);
KAGE_API kage_metadata kage_film_metadata(const kage_film *film, int index);

/* ---- files ---- */

typedef struct kage_write_options {
    int bits;                /* of a PNG: 8 or 16; 0: 8 */
    const char *layers;      /* of an EXR: names for kage_scene_has_layer with commas between them; NULL: all planes */
    int threads;             /* 0: as many as there are processors; the bytes are the same */
    kage_progress *progress; /* NULL: none */
    void *user;              /* for progress */
    int keep;                /* not 0: see kage_render_file */
    int resume;              /* not 0: see kage_render_file */
    int band;                /* of kage_render_file: rows of a band, a multiple of 16; 0: 64 MiB or more */
    const char *format;      /* "png" or "exr"; NULL: what the path ends in */
    const kage_limits *limits; /* NULL: the film's memory, and any time. kage_render_file has those of `render` */
    void *reserved[5];
} kage_write_options;

/* Write a film. Where `path` ends in ".png" or ".PNG": R, G and B in sRGB; in ".exr": planes as 32-bit floats, linear,
 * ZIP. The file appears whole or not at all, and replaces an older one only then: a call that is cancelled or fails
 * changes nothing, and of a process that is killed nothing is left (see kage_file_tidy). A link leads to the file that
 * is written, also where that is not there yet. What is no regular file, and what stands for a descriptor of the
 * process
 * ("/dev/stdout", "/dev/fd/3"), gets the bytes at the end. The file contains the scene's text, the changes and options,
 * but no path, time or host name. options: NULL for the defaults. Another ending, or a layer that the film does not
 * have, is KAGE_BAD_OPTION. */
KAGE_API kage_status kage_film_write(const kage_film *film, const char *path, const kage_write_options *options,
                                     kage_errors **errors);

/* Render the scene and write it, as kage_render and kage_film_write, but in bands: a film of some rows is rendered,
 * written, and used again. So memory does not bound the picture, and a picture may have KAGE_MAX_SIDE pixels along both
 * sides. The bytes of the file are the same. The progress callback is that of `render`; its share is that of the whole.
 *
 * An EXR of which `write` says keep or resume has the name PATH.part until it is finished (kage_file_part), and stays
 * there when the call is cancelled or fails, or the process is killed. resume: go on with the rows that are whole in
 * PATH.part, to the same bytes. Its header must be the same, else the call fails (KAGE_NOT_WRITTEN): the scene's text,
 * options, size and layers, and the version. Files that the scene names are not compared. keep alone: begin anew.
 *
 * film: the last band, with the counts of all bands that this call has rendered; NULL: not wanted. */
KAGE_API kage_status kage_render_file(kage_scene *scene, const kage_render_options *render, const char *path,
                                      const kage_write_options *write, kage_film **film, kage_errors **errors);

/* Join bands of a picture to one file: EXR that kage_film_write or kage_render_file has written with a crop, in any
 * order. The bytes are those that kage_render_file would have written for all of their rows. Chunks are copied as they
 * are, so memory is that of 16 rows. Of the options only `progress` and `user` count.
 *
 * Bands that do not belong together are KAGE_BAD_INPUT: with a gap, or rows that are in two of them; with other
 * columns, layers, options, scenes or versions; with a number of rows, above the last band, that is no multiple of 16.
 */
KAGE_API kage_status kage_file_join(const char *const *paths, int count, const char *path,
                                    const kage_write_options *options, kage_errors **errors);

/* Whether a picture could be written at `path` now: its folder is there and may be written, and so may an older file.
 * Nothing is changed. */
KAGE_API kage_status kage_file_probe(const char *path, kage_errors **errors);

/* The name of an unfinished picture of kage_render_file: the file that `path` leads to, with ".part" behind it. Writes
 * at most `size` bytes to `name`, with a 0 at the end. Returns the length of the whole name, as snprintf does; 0:
 * `path` leads nowhere. */
KAGE_API size_t kage_file_part(const char *path, char *name, size_t size);

/* Remove what processes that were killed have left in the folder of `path`: whole or half-written files with names such
 * as ".kage-123-0" that no process has open. There are few: on file systems that lack files without a name, and of one
 * moment on others. *notes gets a line for each, NULL: there was none. */
KAGE_API void kage_file_tidy(const char *path, kage_errors **notes);

/* Whether the file is a PNG that kage has written, of any version. */
KAGE_API int kage_file_is_picture(const char *path);

/* The time of one stage of rendering. */
typedef struct kage_stage {
    const char *name;
    double seconds; /* in the tiles that are timed: use it as a share of the sum over the stages */
} kage_stage;

/* How many bumped samples used an order. */
typedef struct kage_order_count {
    const char *order; /* none 0 1 2 2+ iter march exact */
    int64_t samples;
} kage_order_count;

typedef struct kage_stats {
    double seconds;      /* of rendering, by the wall clock */
    const char *method;  /* as asked for */
    int64_t camera_rays; /* samples */
    int64_t shadow_rays;
    int64_t secondary_rays; /* reflected, refracted and straight through */
    int64_t height_lookups; /* evaluations of P */
    int64_t bumped;         /* samples on bumped objects */
    int64_t fell_back;      /* bumped samples with another order than asked for */
    int64_t unconfirmed;    /* hits of displaced and parametric surfaces that are not proved to be the first */
    int stage_count, order_count;
    const kage_stage *stages; /* all seconds are 0 without kage_render_options.timing */
    const kage_order_count *orders;
    int64_t undefined; /* samples where P, n', the shift or the light had no value (docs/scene.md, "Without a value") */
    int undefined_object; /* the first object with such a sample, index into kage_scene_info.objects; -1: none */
    int64_t memory;       /* the most bytes that the scene's family and its films have taken, as kage_limits counts */
} kage_stats;

/* What rendering the film counted. */
KAGE_API const kage_stats *kage_film_get_stats(const kage_film *film);

/* ---- one pixel ---- */

/* One method on the sample of a pixel. */
typedef struct kage_probe_row {
    const char *method;
    int guard;             /* 0: the bare formula */
    double tau, t0;        /* t0 = t + tau */
    double origin[3];      /* of the shadow rays: r + s t0 */
    const char *fell_back; /* the order that was used instead; NULL: it did not fall back */
    const double *visible; /* the visible share of each light of the scene, 0..1 */
    double color[3];       /* linear, without secondary rays */
} kage_probe_row;

/* Every value that is computed for the ray through the middle of a pixel. Names as in docs/method.md. */
typedef struct kage_probe {
    double r[3], s[3]; /* the ray r + s t */
    int object;        /* index into kage_scene_info.objects; -1: no hit, and the rest is 0 */
    double t, u, w;
    double Q[3], Qu[3], Qw[3], Quu[3], Quw[3], Qww[3], n[3];
    int bumped; /* 0: no bump, and the fields up to `slab` are 0 */
    double P, Pu, Pw, Puu, Puw, Pww, Pmin, Pmax;
    double n_bump[3]; /* n' */
    int regular;      /* 0: |n| is 0 against |Qu| and |Qw|; the smooth normal is used, sn, a, b and slab are 0 */
    double sn, a, b;  /* s.n/|n|, and s in the tangent plane */
    double slab[2];   /* tau where the ray enters and leaves the slab between Pmin and Pmax */
    int row_count;
    const kage_probe_row *rows;
    int sends;     /* the material has secondary rays, whose light is in no row */
    int undefined; /* P, n' or the surface has no value here: P is 0, n' is n, and no method shifts */
} kage_probe;

/* Trace the ray of pixel x, y by each method, on the smooth surfaces. */
KAGE_API kage_status kage_scene_probe(kage_scene *scene, int x, int y, kage_probe **probe, kage_errors **errors);
KAGE_API void kage_probe_free(kage_probe *probe); /* NULL: nothing */

/* ---- a survey: how steep the bumps are where the camera sees them ---- */

typedef struct kage_bump_survey {
    int samples; /* of 40 000 over the picture; 0: no bump, or not visible, and the rest is 0 */
    double slope_median, slope_95, slope_max; /* tan of the angle between n and n'; slope_95: the 95th percentile */
    double fell_back[3];                      /* [1], [2]: by order 1 and 2, in per cent of the samples; [0] is 0 */
    /* A step from one value of a map's samples to the next: as a height in scene units, and the median of the slope
     * that it makes where two neighbours differ by it. 0: no map, or one of floats. */
    double step, step_slope;
    double distance;  /* of the samples from the eye, in the median */
    double undefined; /* P has no value there, in per cent of the samples; slopes and fell_back are of the others */
} kage_bump_survey;

typedef enum kage_warning_code {
    KAGE_WARN_FLAT_TRIANGLES, /* value: triangles of a model without an area, which are left out */
    KAGE_WARN_UNBOUNDED,      /* P has no bounds, so the guard has no slab and march:N falls back to order 0 */
    KAGE_WARN_STEEP,          /* value: slope_95, above bound: too steep for the scene's method, an order */
    KAGE_WARN_FALLS_BACK,     /* value: of fell_back, above bound: the view is flat against the bumps for its order */
    KAGE_WARN_STEPS,          /* value: step_slope, above bound: the steps of a map's few bits are seen */
    KAGE_WARN_SCALE,          /* value: a scale that would be usual; bound: what slope_95 is above, or below */
    KAGE_WARN_ZERO,           /* all of P is farther than bound from 0. value: a usual `zero` of the map; without a map
                               * what a usual function would be lower by */
    KAGE_WARN_UNDEFINED       /* value: kage_bump_survey.undefined, above 0 */
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
    const char *command;       /* for the file's header: what wrote it. NULL: "libkage" */
    int no_cast;               /* not 0: objects without a bump cast no shadows */
    kage_choice displaced;     /* as in kage_render_options */
    kage_progress *progress;   /* NULL: none. A call that it cancels leaves no file */
    void *user;                /* for progress */
    const kage_limits *limits; /* NULL: the scene's memory, and any time */
    void *reserved[5];
} kage_povray_options;

typedef struct kage_povray_report {
    const char *coarse; /* the coarsest of the objects with a mesh that is too coarse; NULL: none. The scene owns it */
    double height;      /* by how much its heights may be wrong, in scene units */
    double pixels;      /* the same in pixels */
    void *reserved[8];
} kage_povray_report;

/* Write the scene for POV-Ray 3.7 (docs/povray.md). options and report may be NULL. KAGE_BAD_INPUT: the scene has
 * something that POV-Ray lacks. */
KAGE_API kage_status kage_scene_write_povray(kage_scene *scene, const char *path, const kage_povray_options *options,
                                             kage_povray_report *report, kage_errors **errors);

/* ---- models as scenes ---- */

typedef struct kage_import_options {
    const char *const *bumps; /* bump_count times OBJECT=MAP,scale=S,KEY=VALUE...: a height map, its file's name as the
                               * caller's, for the objects whose name fits OBJECT, which may have * and ? */
    int bump_count;
    const char *camera;       /* the name of the model's camera; NULL: its first */
    int z_up;                 /* not 0: the model's z is up, not its y */
    double brightness;        /* of all lights together; 0: 1 */
    int overwrite;            /* not 0: files that exist are replaced */
    int threads;              /* 0: as many as there are processors */
    kage_progress *progress;  /* NULL: none */
    void *user;               /* for progress */
    const char *model_reader; /* as in kage_load_options */
    const char *const *sets;  /* set_count changes, only of `scene` below, not of the file */
    int set_count;
    const kage_limits *limits; /* as in kage_load_options */
    void *reserved[7];
} kage_import_options;

typedef struct kage_import_report {
    kage_scene *scene; /* as kage_scene_load would give it, with the changes; the report owns it */
    int note_count;    /* lines on what is in the model but not in the scene */
    const char *const *notes;
    int file_count; /* images that were written beside the scene */
    const char *const *files;
} kage_import_report;

/* Write a scene for a model that kage_load_options.model_reader reads, with its camera, lights, materials, images and
 * objects (docs/models.md). The triangles stay in the model's file, which the scene names. All is read and checked
 * before the scene is written, whole or not at all; after a failure no new file stays. */
KAGE_API kage_status kage_model_import(const char *model, const char *scene, const kage_import_options *options,
                                       kage_import_report **report, kage_errors **errors);
KAGE_API void kage_import_report_free(kage_import_report *report); /* NULL: nothing */

/* ---- methods ---- */

typedef struct kage_method {
    const char *name; /* with K or N for a number: "iter:K" */
    const char *text; /* what it does, in one line */
} kage_method;

KAGE_API int kage_method_count(void);
KAGE_API kage_method kage_method_get(int index); /* NULL fields: no such method */

/* Whether `name` is a method for kage_render_options.method, such as "2+" or "iter:4". "bump", for bump mapping only,
 * is another name for "none". */
KAGE_API int kage_method_is_known(const char *name);

/* The same for the shadows of bumps on their own surface: none march:N horizon exact. */
KAGE_API int kage_bump_shadow_is_known(const char *name);

#ifdef __cplusplus
}
#endif

#endif
