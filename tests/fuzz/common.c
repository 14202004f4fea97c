/* What the targets share: choices from bytes, files, and checks of what the library gives back. */
#include "fuzz/fuzz.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const fuzz_target fuzz_targets[] = {
    {"scene", fuzz_scene},   {"expr", fuzz_expr}, {"png", fuzz_png}, {"exr", fuzz_exr},   {"patch", fuzz_patch},
    {"points", fuzz_points}, {"mesh", fuzz_mesh}, {"set", fuzz_set}, {"film", fuzz_film}, {NULL, NULL},
};

const fuzz_target *fuzz_find(const char *name)
{
    const fuzz_target *t = fuzz_targets;
    while (t->name && strcmp(t->name, name) != 0)
        t++;
    return t->name ? t : NULL;
}

void fuzz_fail(const char *file, int line, const char *what, const char *fmt, ...)
{
    va_list args;
    fprintf(stderr, "%s:%d: does not hold: %s\n", file, line, what);
    va_start(args, fmt);
    vfprintf(stderr, fmt, args);
    va_end(args);
    fputc('\n', stderr);
    abort();
}

/* ---- bytes as choices ---- */

void bytes_take(bytes *b, void *to, size_t n)
{
    const size_t some = n < b->left ? n : b->left;
    if (some)
        memcpy(to, b->at, some);
    memset((char *)to + some, 0, n - some);
    b->at += some;
    b->left -= some;
}

int bytes_one(bytes *b)
{
    uint8_t x;
    bytes_take(b, &x, 1);
    return x;
}

int32_t bytes_int(bytes *b)
{
    int32_t x;
    bytes_take(b, &x, sizeof x);
    return x;
}

int bytes_between(bytes *b, int lo, int hi) { return lo + bytes_one(b) % (hi - lo + 1); }

double bytes_number(bytes *b)
{
    static const double awkward[] = {0, -0.0, 1, -1, 1e-45, 1e38, -1e38, 1e6, 1e-6, 1e300, (double)NAN, HUGE_VAL};
    const int kind = bytes_one(b);
    double x;
    if (kind < 16)
        bytes_take(b, &x, sizeof x);
    else if (kind < 64)
        x = awkward[kind % (int)(sizeof awkward / sizeof *awkward)];
    else
        x = (kind - 160) / 16.0;
    return x;
}

/* ---- files ---- */

static char folder[64];

static void remove_folder(void)
{
    char command[96];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    if (system(command) != 0)
        perror(folder);
}

const char *fuzz_folder(void)
{
    if (folder[0])
        return folder;
    const char *where = getenv("TMPDIR");
    const int n = snprintf(folder, sizeof folder, "%s/kage-fuzz-XXXXXX", where ? where : "/tmp");
    if (n >= (int)sizeof folder || !mkdtemp(folder)) {
        perror(folder);
        exit(2);
    }
    atexit(remove_folder);
    return folder;
}

const char *fuzz_path(const char *name)
{
    enum { PATHS = 16 };
    static char kept[PATHS][96];
    int k = 0;
    while (k < PATHS && kept[k][0] && strcmp(strrchr(kept[k], '/') + 1, name) != 0)
        k++;
    HOLDS(k < PATHS, "too many files");
    if (!kept[k][0])
        snprintf(kept[k], sizeof kept[k], "%s/%s", fuzz_folder(), name);
    return kept[k];
}

void fuzz_write(const char *path, const void *data, size_t size)
{
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data, 1, size, f) != size || fclose(f) != 0) {
        perror(path);
        exit(2);
    }
}

uint8_t *fuzz_read(const char *path, size_t *size)
{
    FILE *f = fopen(path, "rb");
    if (!f)
        return NULL;
    fseek(f, 0, SEEK_END);
    *size = (size_t)ftell(f);
    rewind(f);
    uint8_t *all = malloc(*size + 1);
    HOLDS(all && fread(all, 1, *size, f) == *size, "%s can't be read", path);
    fclose(f);
    return all;
}

/* ---- errors ---- */

/* One line without controls, but for tabs. */
static bool is_plain(const char *text)
{
    for (; *text; text++)
        if (((unsigned char)*text < 0x20 && *text != '\t') || *text == 0x7f)
            return false;
    return true;
}

void fuzz_errors(kage_status status, kage_errors *e)
{
    if (status == KAGE_CANCELLED || status == KAGE_OK) {
        HOLDS(!e, "status %d with errors", (int)status);
        return;
    }
    HOLDS(e && kage_errors_found(e) > 0 && kage_errors_count(e) > 0, "status %d without an error", (int)status);
    HOLDS(kage_errors_count(e) <= kage_errors_found(e), "more errors than were found");
    for (int k = 0; k < kage_errors_count(e); k++) {
        const kage_error *x = kage_errors_get(e, k);
        HOLDS(x->text && x->text[0] && is_plain(x->text), "text '%s'", x->text);
        HOLDS(!!x->file == (x->line > 0) && !!x->file == (x->column > 0), "%s: line %d, column %d", x->text, x->line,
              x->column);
        char place[256];
        const int n = x->file ? snprintf(place, sizeof place, "%s:%d:%d: ", x->file, x->line, x->column) : 0;
        HOLDS(n < (int)sizeof place && strncmp(x->message, place, (size_t)n) == 0, "message '%s'", x->message);
        HOLDS(strncmp(x->message + n, x->text, strlen(x->text)) == 0, "message '%s', text '%s'", x->message, x->text);
    }
    HOLDS(!kage_errors_get(e, kage_errors_count(e)), "an error beyond the last");
    kage_errors_free(e);
}

/* ---- scenes ---- */

int fuzz_patience(void *user, const char *what, double share)
{
    patience *p = user;
    HOLDS(what && share >= 0 && share <= 1, "progress '%s' %g", what, share);
    return --p->left < 0;
}

kage_scene *fuzz_parse(const char *text, size_t size, int sets, const char *const *set, patience *p)
{
    static const uint8_t map[7 * 5] = {0, 40, 90, 255, 3, 9, 128, 77, 200, 255, 255, 254, 253, 1, 2, 3, 0, 99};
    static const float image[3 * 2 * 3] = {0.5f, 0, 1, 2, 0.25f, 0.125f, 1, 1, 1, 0, 0, 0, 0.1f, 0.2f, 0.3f};
    static const double at[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, uv[] = {0, 0, 1, 0, 0, 1, 1, 1};
    static const uint32_t corner[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    const kage_image_array images[] = {{"map", 7, 5, 1, KAGE_U8, map}, {"image", 3, 2, 3, KAGE_F32, image}};
    const kage_mesh_array mesh = {"mesh", 4, 4, at, NULL, uv, corner};
    const kage_limits limits = {.memory = 512 << 20};
    const kage_load_options o = {.sets = set,
                                 .set_count = sets,
                                 .threads = 1,
                                 .progress = fuzz_patience,
                                 .user = p,
                                 .model_reader = "/nonexistent/kage-import",
                                 .images = images,
                                 .image_count = 2,
                                 .meshes = &mesh,
                                 .mesh_count = 1,
                                 .limits = &limits};
    kage_scene *s = NULL;
    kage_errors *e = NULL;
    const kage_status status = kage_scene_parse(text, size, "fuzz.yaml", fuzz_folder(), &o, &s, &e);
    HOLDS((status == KAGE_OK) == !!s, "status %d, scene %p", (int)status, (void *)s);
    HOLDS(status != KAGE_BAD_OPTION && status != KAGE_NOT_WRITTEN, "status %d", (int)status);
    fuzz_errors(status, e);
    return s;
}

bool fuzz_is_small(const kage_scene *s)
{
    const kage_scene_info *info = kage_scene_get_info(s);
    int samples = 0;
    for (int k = 0; k < info->light_count; k++)
        samples += info->lights[k].samples[0] * info->lights[k].samples[1];
    int copies = 0;
    for (int k = 0; k < info->object_count; k++)
        copies += info->objects[k].copies;
    return samples <= 64 && info->object_count <= 16 && copies <= 1000;
}

/* Images of an EXR may have samples below 0, as those of other programs may; nothing else makes light negative. */
static bool has_image(const kage_scene *s)
{
    const kage_scene_info *info = kage_scene_get_info(s);
    for (int k = 0; k < info->object_count; k++)
        if (info->objects[k].color && strncmp(info->objects[k].color, "image", 5) == 0)
            return true;
    return false;
}

/* All planes are there, and their numbers are within their ranges; a depth is infinite where nothing is hit. */
static void check_film(const kage_scene *s, const kage_film *f)
{
    const bool signed_light = has_image(s);
    const size_t n = (size_t)kage_film_width(f) * (size_t)kage_film_height(f);
    HOLDS(n == FUZZ_WIDTH * FUZZ_HEIGHT, "%zu pixels", n);
    HOLDS(kage_film_plane_count(f) >= 14, "%d planes", kage_film_plane_count(f));
    for (int k = 0; k < kage_film_plane_count(f); k++) {
        const char *name = kage_film_plane_name(f, k);
        const float *v = kage_film_plane(f, name);
        HOLDS(v, "no plane %s", name);
        for (size_t i = 0; i < n; i++) {
            HOLDS(isfinite(v[i]), "plane %s has %g at %zu", name, (double)v[i], i);
            HOLDS(strncmp(name, "visibility.", 11) != 0 || !(v[i] < 0 || v[i] > 1), "%s is %g", name, (double)v[i]);
            HOLDS(strlen(name) != 1 || name[0] == 'Z' || signed_light || !(v[i] < 0), "%s is %g", name, (double)v[i]);
        }
    }
}

kage_film *fuzz_render(kage_scene *s, const char *method, kage_choice displaced, patience *p)
{
    const kage_render_options o = {.method = method,
                                   .displaced = displaced,
                                   .width = FUZZ_WIDTH,
                                   .height = FUZZ_HEIGHT,
                                   .aa = 1,
                                   .layers = 1,
                                   .threads = 1,
                                   .progress = fuzz_patience,
                                   .user = p};
    kage_film *f = NULL;
    kage_errors *e = NULL;
    const kage_status status = kage_render(s, &o, &f, &e);
    HOLDS((status == KAGE_OK) == !!f, "status %d, film %p", (int)status, (void *)f);
    fuzz_errors(status, e);
    if (f)
        check_film(s, f);
    return f;
}

void fuzz_scene_of_file(const char *format, const char *path)
{
    char text[4096];
    const int n = snprintf(text, sizeof text, format, strrchr(path, '/') + 1);
    patience p = {2000};
    kage_scene *s = fuzz_parse(text, (size_t)n, 0, NULL, &p);
    if (s && fuzz_is_small(s))
        kage_film_free(fuzz_render(s, NULL, KAGE_AS_SCENE, &p));
    kage_scene_free(s);
}
