/* A scene's text: it is read, surveyed, probed, written for POV-Ray, and rendered by every method. */
#include "fuzz/fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const methods[] = {"none", "0", "1", "2", "2+", "iter:2", "march:4", "exact", "auto"};

static void survey(kage_scene *s)
{
    kage_survey *x = NULL;
    kage_errors *e = NULL;
    const kage_status status = kage_scene_survey(s, &x, &e);
    HOLDS((status == KAGE_OK) == !!x, "status %d", (int)status);
    fuzz_errors(status, e);
    for (int k = 0; x && k < x->warning_count; k++)
        HOLDS(x->warnings[k].object >= 0 && x->warnings[k].object < kage_scene_get_info(s)->object_count,
              "a warning of object %d", x->warnings[k].object);
    kage_survey_free(x);
}

static void probe(kage_scene *s, int x, int y)
{
    kage_probe *p = NULL;
    kage_errors *e = NULL;
    const kage_status status = kage_scene_probe(s, x, y, &p, &e);
    HOLDS((status == KAGE_OK) == !!p, "status %d", (int)status);
    fuzz_errors(status, e);
    HOLDS(!p || p->object < kage_scene_get_info(s)->object_count, "object %d", p->object);
    kage_probe_free(p);
}

static void write_povray(kage_scene *s, patience *patient)
{
    const kage_povray_options o = {.progress = fuzz_patience, .user = patient};
    kage_errors *e = NULL;
    const kage_status status = kage_scene_write_povray(s, fuzz_path("out.pov"), &o, NULL, &e);
    HOLDS(status == KAGE_OK || status == KAGE_BAD_INPUT || status == KAGE_CANCELLED || status == KAGE_NO_MEMORY,
          "status %d", (int)status);
    fuzz_errors(status, e);
    remove(fuzz_path("out.pov"));
}

/* Whether all methods may be tried: few objects, and none in pieces, which take long where code is instrumented. */
static bool is_quick(const kage_scene_info *info)
{
    bool quick = info->object_count <= 2 && info->light_count <= 2;
    for (int k = 0; k < info->object_count; k++)
        quick = quick && strcmp(info->objects[k].shape, "parametric") != 0 &&
                strcmp(info->objects[k].shape, "patches") != 0;
    return quick;
}

/* A chain of mirrors doubles the work at each of its rays. */
static kage_scene *made_cheap(kage_scene *s, patience *p)
{
    const char *const set[] = {"render.depth=2"};
    const kage_load_options o = {.sets = set, .set_count = 1, .progress = fuzz_patience, .user = p};
    kage_scene *changed = NULL;
    kage_errors *e = NULL;
    const kage_status status = kage_scene_change(s, &o, &changed, &e);
    HOLDS(status == KAGE_OK || status == KAGE_CANCELLED, "a scene that was read can't be read again: %s",
          e ? kage_errors_get(e, 0)->message : "");
    kage_scene_free(s);
    return changed;
}

void fuzz_scene(const uint8_t *data, size_t size)
{
    patience p = {3000};
    kage_scene *s = fuzz_parse((const char *)data, size, 0, NULL, &p);
    if (s && fuzz_is_small(s) && (s = made_cheap(s, &p))) {
        const kage_scene_info *info = kage_scene_get_info(s);
        kage_film_free(fuzz_render(s, NULL, KAGE_AS_SCENE, &p));
        const bool quick = is_quick(info);
        for (size_t k = 0; quick && k < sizeof methods / sizeof *methods; k++)
            kage_film_free(fuzz_render(s, methods[k], KAGE_AS_SCENE, &p));
        if (quick)
            kage_film_free(fuzz_render(s, NULL, info->displaced ? KAGE_NO : KAGE_YES, &p));
        probe(s, info->width / 2, info->height / 2);
        probe(s, info->width - 1, info->height - 1);
        survey(s);
        write_povray(s, &p);
    }
    kage_scene_free(s);
}
