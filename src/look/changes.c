/* A look as changes of the scene. */
#include "look/changes.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
add(changes *c, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    vsnprintf(c->text[c->count], CHANGE_SIZE, fmt, args);
    va_end(args);
    c->list[c->count] = c->text[c->count];
    c->count++;
}

/* Six digits: more than the eye sees, and good to read in a saved scene. */
static void add_place(changes *c, const char *path, const double at[3])
{
    add(c, "%s=[%.6g, %.6g, %.6g]", path, at[0], at[1], at[2]);
}

static void add_camera(changes *c, const look *l)
{
    if (l->moved) {
        add_place(c, "camera.from", l->from);
        add_place(c, "camera.at", l->at);
    }
    if (l->zoomed)
        add(c, "camera.width=%.6g", l->across);
}

static void add_lights(changes *c, const look *l, const kage_scene_info *s)
{
    for (int k = 0; k < l->lights; k++)
        for (int j = 0; j < s->light_count; j++)
            if (strcmp(s->lights[j].name, l->light[k].name) == 0) {
                char path[VIEW_NAME + 16];
                snprintf(path, sizeof path, "lights.%s.at", l->light[k].name);
                add_place(c, path, l->light[k].at);
            }
}

/* A bump of no height begins to grow from the first notch up. */
static double scaled(double scale, int notches)
{
    const double first = 0.01;
    if (scale == 0)
        return notches > 0 ? first * pow(VIEW_NOTCH, notches) : 0;
    return scale * pow(VIEW_NOTCH, notches);
}

static void add_bumps(changes *c, const look *l, const kage_scene_info *s)
{
    for (int k = 0; k < l->bumps; k++)
        for (int j = 0; j < s->object_count; j++) {
            const kage_object_info *o = &s->objects[j];
            if (!o->bump_of || strcmp(o->bump_of, l->bump[k].name) != 0)
                continue;
            if (l->bump[k].notches)
                add(c, "objects.%s.bump.scale=%.4g", o->bump_of, scaled(o->bump_scale, l->bump[k].notches));
            break;
        }
}

static void add_word(changes *c, const char *path, const char *word)
{
    if (*word)
        add(c, "%s=%s", path, word);
}

void changes_make(changes *c, const look *l, const kage_scene_info *s, bool finished)
{
    c->count = 0;
    if (l->width != s->width || l->height != s->height)
        add(c, "image.size=[%d, %d]", l->width, l->height);
    add_camera(c, l);
    add_lights(c, l, s);
    add_bumps(c, l, s);
    add_word(c, "render.shadow", l->shadow);
    add_word(c, "render.shade", l->shade);
    add_word(c, "render.bump_shadow", l->own);
    add_word(c, "render.surface", l->surface);
    if (finished && s->aa == 1) {
        add(c, "render.aa=%d", CHANGES_AA);
        add(c, "render.aa_threshold=%g", CHANGES_AA_THRESHOLD);
    }
}
