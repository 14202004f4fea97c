/* Models: what comes through the pipe from kage-import, as triangles and as a scene, and arrays in memory. Of the
 * importer only its place is taken, by letters.c, as it does not fail on purpose. The bytes are a short form of
 * letters.
 */
#include "fuzz/fuzz.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "mesh/letter.h"

#define HEAD                                                                                                           \
    "camera: {from: [0.3, 0.5, -4], at: [0, 0, 0], fov: 50}\n"                                                         \
    "image: {size: [8, 6]}\n"                                                                                          \
    "lights: {lamp: {at: [-4, 5, -2]}}\n"                                                                              \
    "materials: {it: {}}\n"

/* By their number in the bytes. */
static const char *const uses[] = {
    HEAD "objects: {it: {mesh: {file: %s}, material: it, bump: {function: 0.05*sin(20*u)}}}\n",
    HEAD "objects: {it: {mesh: {file: %s, normals: smooth, crease: 90}, material: it}}\n",
    HEAD "objects: {it: {mesh: {file: %s, part: a}, material: it}}\n",
    HEAD "render: {shadow: exact}\n"
         "objects: {it: {mesh: {file: %s, normals: flat}, material: it, bump: {function: 0.01*cos(9*w)}}}\n",
    HEAD "objects: {it: {mesh: {file: %s, part: b}, material: it, transform: [{scale: [1, -2, 1]}]}}\n",
};

enum { USES = sizeof uses / sizeof *uses, ROOM = 1 << 16, PATIENCE = 2000 };

/* ---- letters ---- */

typedef struct room {
    char *at;
    size_t used;
    bool full;
} room;

static void put(room *r, const void *from, size_t n)
{
    r->full = r->full || r->used + n > ROOM;
    if (!r->full) {
        memcpy(r->at + r->used, from, n);
        r->used += n;
    }
}

/* A text of up to `size` bytes, often with nothing after it that ends it. */
static void take_text(bytes *b, char *to, size_t size)
{
    const int kind = bytes_one(b);
    if (kind >= 250)
        memset(to, kind - 250 + 'a', size);
    else
        bytes_take(b, to, (size_t)(kind % 40) < size ? (size_t)(kind % 40) : size);
}

/* A count: mostly small, sometimes any. */
static int take_count(bytes *b)
{
    const int kind = bytes_one(b);
    return kind < 224 ? kind % 16 : bytes_int(b);
}

static void put_floats(bytes *b, room *r, size_t n)
{
    for (size_t k = 0; k < n && !r->full; k++) {
        const float x = (float)bytes_number(b);
        put(r, &x, sizeof x);
    }
}

static void put_triangles(bytes *b, room *r, const mesh_data *d)
{
    const size_t n = d->n > 0 ? (size_t)d->n : 0, parts = d->parts > 0 ? (size_t)d->parts : 0;
    put_floats(b, r, 9 * n);
    for (size_t k = 0; k < n && !r->full; k++)
        put_floats(b, r, 15);
    for (size_t k = 0; k < parts && !r->full; k++) {
        mesh_part p = {.first = take_count(b)};
        p.n = take_count(b);
        take_text(b, p.name, sizeof p.name);
        put(r, &p, sizeof p);
    }
}

static void put_letter(bytes *b, room *r, bool as_scene)
{
    letter l;
    memset(&l, 0, sizeof l);
    const int kind = bytes_one(b), of = kind % 8, wrong = kind == 255;
    const int32_t is = of < 6 ? of : of == 6 ? LETTER_DONE : bytes_int(b);
    memcpy(&l.is, &is, sizeof is);
    l.magic = wrong ? 0 : LETTER_MAGIC;
    if (is == LETTER_READ)
        l.share = bytes_number(b);
    if (is == LETTER_WRONG || is == LETTER_NOTE || is == LETTER_FILE)
        take_text(b, l.why, sizeof l.why);
    if (is == LETTER_DONE && !as_scene) {
        l.data.n = take_count(b);
        l.data.parts = take_count(b);
        l.data.notes.flat = take_count(b);
    }
    const int size = is == LETTER_FILE || is == LETTER_DONE ? take_count(b) : 0;
    l.size = is == LETTER_DONE && size >= 0 && size < 8 ? b->left : size < -(1 << 30) ? SIZE_MAX : (size_t)abs(size);
    put(r, &l, sizeof l);
    if (is == LETTER_DONE && !as_scene)
        put_triangles(b, r, &l.data);
    else
        for (size_t k = 0; k < l.size && b->left; k++) {
            const char c = (char)bytes_one(b);
            put(r, &c, 1);
        }
}

static const char *letters_program(void)
{
    static char path[4096];
    const ssize_t n = path[0] ? 0 : readlink("/proc/self/exe", path, sizeof path - 16);
    if (n > 0) {
        path[n] = 0;
        strcpy(strrchr(path, '/') + 1, "letters");
        HOLDS(access(path, X_OK) == 0, "%s is missing", path);
    }
    return path;
}

/* ---- what is done with them ---- */

static void render(const char *text, const kage_mesh_array *mesh, const char *reader)
{
    patience p = {PATIENCE};
    kage_scene *s = NULL;
    kage_errors *e = NULL;
    const kage_load_options o = {.threads = 1,
                                 .progress = fuzz_patience,
                                 .user = &p,
                                 .model_reader = reader,
                                 .meshes = mesh,
                                 .mesh_count = mesh ? 1 : 0};
    const kage_status status = kage_scene_parse(text, strlen(text), "fuzz.yaml", fuzz_folder(), &o, &s, &e);
    HOLDS((status == KAGE_OK) == !!s, "status %d, scene %p", (int)status, (void *)s);
    fuzz_errors(status, e);
    if (s)
        kage_film_free(fuzz_render(s, NULL, KAGE_AS_SCENE, &p));
    kage_scene_free(s);
}

static void import(const char *model)
{
    patience p = {PATIENCE};
    const char *const bumps[] = {"*=map.png,scale=0.1"};
    const kage_import_options o = {.bumps = bumps,
                                   .bump_count = 1,
                                   .overwrite = 1,
                                   .threads = 1,
                                   .progress = fuzz_patience,
                                   .user = &p,
                                   .model_reader = letters_program()};
    kage_import_report *r = NULL;
    kage_errors *e = NULL;
    const kage_status status = kage_model_import(model, fuzz_path("out.yaml"), &o, &r, &e);
    HOLDS((status == KAGE_OK) == !!r, "status %d, report %p", (int)status, (void *)r);
    fuzz_errors(status, e);
    for (int k = 0; r && k < r->file_count; k++)
        remove(r->files[k]);
    kage_import_report_free(r);
    remove(fuzz_path("out.yaml"));
}

static void read_letters(bytes *b, int use)
{
    const char *path = fuzz_path("in.obj");
    char text[1024];
    room r = {malloc(ROOM), 0, false};
    for (int k = 0; b->left && k < 64; k++)
        put_letter(b, &r, use >= USES);
    fuzz_write(path, r.at, r.used);
    free(r.at);
    if (use >= USES) {
        import(path);
        return;
    }
    snprintf(text, sizeof text, uses[use], "in.obj");
    render(text, NULL, letters_program());
}

static void read_arrays(bytes *b, int use)
{
    enum { VERTICES = 24, TRIANGLES = 24 };
    static double at[VERTICES][3], normal[VERTICES][3], uv[VERTICES][2];
    static uint32_t corner[TRIANGLES][3];
    const int what = bytes_one(b);
    const int vertices = bytes_between(b, what & 8 ? 0 : 3, VERTICES);
    const int triangles = bytes_between(b, what & 8 ? 0 : 1, TRIANGLES);
    const kage_mesh_array mesh = {.name = what & 4 ? "it" : "m",
                                  .vertex_count = vertices,
                                  .triangle_count = triangles,
                                  .positions = at[0],
                                  .normals = what & 1 ? normal[0] : NULL,
                                  .uvs = what & 2 ? uv[0] : NULL,
                                  .triangles = corner[0]};
    for (int k = 0; k < mesh.vertex_count; k++)
        for (int i = 0; i < 8; i++)
            *(i < 3 ? &at[k][i] : i < 6 ? &normal[k][i - 3] : &uv[k][i - 6]) = bytes_number(b);
    for (int k = 0; k < mesh.triangle_count; k++)
        for (int i = 0; i < 3; i++)
            corner[k][i] = what & 16 ? (uint32_t)bytes_int(b)
                                     : (uint32_t)(bytes_one(b) % (mesh.vertex_count ? mesh.vertex_count : 1));
    char text[1024];
    snprintf(text, sizeof text, uses[use], "array:it");
    kage_mesh_array named = mesh;
    named.name = "it";
    render(text, what & 4 ? &mesh : &named, NULL);
}

/* The first byte: the use in a scene, as letters or as arrays, or an import. */
void fuzz_mesh(const uint8_t *data, size_t size)
{
    bytes b = {data, size};
    const int use = bytes_one(&b) % (2 * USES + 2);
    if (use < USES)
        read_arrays(&b, use);
    else
        read_letters(&b, use - USES);
}
