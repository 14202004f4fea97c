/* Changes of a scene: lines of PATH=VALUE up to an empty one, then the scene's text. What is written of the changed
 * scene must read as the same scene, and a scene that is changed later must be the same, too.
 */
#include "fuzz/fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SETS = 16, PATIENCE = 2000 };

static const char plain[] = "camera: {from: [0.3, 0.5, -4], at: [0, 0, 0], fov: 50} # a remark\n"
                            "image:\n  size: [8, 6]\nlights:\n  lamp: {at: [-4, 5, -2]}\n"
                            "materials: {it: {color: [1, 0.5, 0.25]}}\n"
                            "objects:\n  it:\n    sphere: {center: [0, 0, 0], radius: 1}\n    material: it\n"
                            "    bump: {function: 0.1*sin(9*u), scale: 0.5}\n"
                            "    transform:\n      - rotate: [0, 10, 0]\n      - scale: 2\n";

static bool same_text(const char *a, const char *b) { return a && b ? strcmp(a, b) == 0 : a == b; }

static void compare_films(kage_scene *a, kage_scene *b, const char *text)
{
    patience p = {PATIENCE}, q = {PATIENCE};
    if (!fuzz_is_small(a))
        return;
    kage_film *f = fuzz_render(a, NULL, KAGE_AS_SCENE, &p), *g = fuzz_render(b, NULL, KAGE_AS_SCENE, &q);
    HOLDS(!f == !g, "one of them is no picture\n%s", text);
    const size_t size = FUZZ_WIDTH * FUZZ_HEIGHT * sizeof(float);
    for (int k = 0; f && k < kage_film_plane_count(f); k++) {
        const char *name = kage_film_plane_name(f, k);
        HOLDS(kage_film_plane(g, name) && memcmp(kage_film_plane(f, name), kage_film_plane(g, name), size) == 0,
              "the plane %s differs\n%s", name, text);
    }
    kage_film_free(f);
    kage_film_free(g);
}

static void compare(kage_scene *a, kage_scene *b, const char *text)
{
    const kage_scene_info *x = kage_scene_get_info(a), *y = kage_scene_get_info(b);
    HOLDS(x->width == y->width && x->height == y->height && x->aa == y->aa && same_text(x->method, y->method) &&
              x->light_count == y->light_count && x->object_count == y->object_count && x->depth == y->depth,
          "the scenes differ\n%s", text);
    for (int k = 0; k < x->object_count; k++)
        HOLDS(same_text(x->objects[k].name, y->objects[k].name) &&
                  same_text(x->objects[k].shape, y->objects[k].shape) &&
                  same_text(x->objects[k].map, y->objects[k].map),
              "the objects %d differ\n%s", k, text);
    compare_films(a, b, text);
}

/* The same changes, made one after another to the scene without them: where that succeeds, the scene is the same. */
static void change_later(kage_scene *all, const char *text, size_t size, int n, const char *const *set)
{
    patience p = {PATIENCE};
    kage_scene *s = fuzz_parse(text, size, 0, NULL, &p);
    for (int k = 0; s && k < n; k++) {
        const kage_load_options o = {.sets = set + k, .set_count = 1, .progress = fuzz_patience, .user = &p};
        kage_scene *next = NULL;
        kage_errors *e = NULL;
        const kage_status status = kage_scene_change(s, &o, &next, &e);
        fuzz_errors(status, e);
        kage_scene_free(s);
        s = next;
    }
    if (s)
        compare(all, s, kage_scene_get_info(s)->text);
    kage_scene_free(s);
}

void fuzz_set(const uint8_t *data, size_t size)
{
    char *all = malloc(size + 1), *at = all;
    const char *set[SETS];
    int n = 0;
    if (size)
        memcpy(all, data, size);
    all[size] = 0;
    while (n < SETS && *at && *at != '\n') { /* as on a command line, they end at a 0 */
        set[n++] = at;
        at += strcspn(at, "\n");
        if (*at)
            *at++ = 0;
    }
    at += *at == '\n';
    const char *text = *at ? at : plain;
    const size_t length = *at ? size - (size_t)(at - all) : sizeof plain - 1;
    patience p = {PATIENCE};
    kage_scene *s = fuzz_parse(text, length, n, set, &p);
    const char *written = s ? kage_scene_get_info(s)->text : NULL;
    if (written) {
        patience q = {PATIENCE};
        kage_scene *again = fuzz_parse(written, strlen(written), 0, NULL, &q);
        HOLDS(again || q.left < 0, "the written scene is none\n%s", written);
        if (again)
            compare(s, again, written);
        kage_scene_free(again);
        change_later(s, text, length, n, set);
    }
    kage_scene_free(s);
    free(all);
}
