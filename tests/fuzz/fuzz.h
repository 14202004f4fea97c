/* The targets of the fuzzer: each takes any bytes, gives them to the library in one way, and checks what must hold
 * whatever they are. A violation ends in abort, as the sanitizers' finds do. engine.c runs them by libFuzzer, replay.c
 * by itself over files.
 */
#ifndef KAGE_TESTS_FUZZ_H
#define KAGE_TESTS_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "kage.h"

typedef struct fuzz_target {
    const char *name;
    void (*run)(const uint8_t *data, size_t size);
} fuzz_target;

/* By name; NULL: there is none. All of them end with one without a name. */
const fuzz_target *fuzz_find(const char *name);
extern const fuzz_target fuzz_targets[];

void fuzz_scene(const uint8_t *data, size_t size);
void fuzz_expr(const uint8_t *data, size_t size);
void fuzz_png(const uint8_t *data, size_t size);
void fuzz_exr(const uint8_t *data, size_t size);
void fuzz_patch(const uint8_t *data, size_t size);
void fuzz_points(const uint8_t *data, size_t size);
void fuzz_mesh(const uint8_t *data, size_t size);
void fuzz_set(const uint8_t *data, size_t size);
void fuzz_film(const uint8_t *data, size_t size);

/* What must hold. If it does not, the rest is printed as by printf, and the program ends. */
#define HOLDS(condition, ...) ((condition) ? (void)0 : fuzz_fail(__FILE__, __LINE__, #condition, __VA_ARGS__))
__attribute__((noreturn, format(printf, 4, 5))) void fuzz_fail(const char *file, int line, const char *what,
                                                               const char *fmt, ...);

/* ---- bytes as choices ---- */

typedef struct bytes {
    const uint8_t *at;
    size_t left;
} bytes;

/* The next n bytes; 0 where there are no more. */
void bytes_take(bytes *b, void *to, size_t n);
int bytes_one(bytes *b);
int32_t bytes_int(bytes *b);

/* Lo to hi. */
int bytes_between(bytes *b, int lo, int hi);

/* A number: any bits, one of the awkward ones, or a small one. */
double bytes_number(bytes *b);

/* ---- files ---- */

/* A file in the process's own folder, which is removed at its end: a path that lives as long as the process. */
const char *fuzz_path(const char *name);
const char *fuzz_folder(void);
void fuzz_write(const char *path, const void *data, size_t size);
uint8_t *fuzz_read(const char *path, size_t *size); /* free(); NULL: there is none */

/* ---- scenes ---- */

enum { FUZZ_WIDTH = 8, FUZZ_HEIGHT = 6 };

/* A pause button: stops a call after so many calls of `progress`, so that the cost of an input is bounded by what it
 * does and not by the clock. */
typedef struct patience {
    int left;
} patience;
int fuzz_patience(void *user, const char *what, double share);

/* Read a scene, with arrays "map", "image" and "mesh" that it may name. NULL: the errors are checked. */
kage_scene *fuzz_parse(const char *text, size_t size, int sets, const char *const *set, patience *p);

/* Check a list of errors of a call that failed, and free it. */
void fuzz_errors(kage_status status, kage_errors *e);

/* Render it in FUZZ_WIDTH x FUZZ_HEIGHT pixels by `method` (NULL: as it says), and check the film. NULL: it was
 * stopped, or refused. */
kage_film *fuzz_render(kage_scene *s, const char *method, kage_choice displaced, patience *p);

/* Whether a picture of it is cheap: few objects and lights, and few samples of these. */
bool fuzz_is_small(const kage_scene *s);

/* Read a scene with `before` a file that holds the bytes and `after` its name, and render it. */
void fuzz_scene_of_file(const char *format, const char *path);

#endif
