/* Renders the picture of a look. */
#include "look/frame.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "look/changes.h"

/* Of `pixels` in the window. */
static int coarse(int pixels, int stage) { return stage > STAGE_FULL ? (pixels + stage - 1) / stage : pixels; }

static bool make_room(frame *f, int side)
{
    const size_t need = 4 * (size_t)f->columns * (size_t)f->rows;
    if (f->room[side] >= need)
        return true;
    free(f->rgba[side]);
    f->rgba[side] = malloc(need);
    f->room[side] = f->rgba[side] ? need : 0;
    return f->rgba[side] != NULL;
}

/* The film's pixels, at their place among the side's. */
static kage_status show(frame *f, int side, const kage_film *film, const frame_order *o)
{
    int part[4];
    kage_film_crop(film, part);
    uint8_t *to = f->rgba[side] + 4 * (size_t)part[0];
    if (o->look->layer == LAYER_PICTURE)
        return kage_film_srgb(film, to, 4 * (size_t)f->columns, o->threads);
    if (side == 0)
        f->legend = colours_range(film, o->look->layer);
    colours_paint(film, &f->legend, to, 4 * (size_t)f->columns);
    return KAGE_OK;
}

/* Columns x0 to x1 of one side. */
static kage_status render_side(frame *f, frame_films *films, int side, int x0, int x1, kage_scene *scene,
                               const frame_order *o, kage_errors **errors)
{
    const kage_scene_info *s = kage_scene_get_info(scene);
    const bool own_aa = s->aa > 1; /* the scene says how it is antialiased */
    kage_render_options r = {.method = side ? o->look->beside : NULL,
                             .width = f->columns,
                             .height = f->rows,
                             .crop = {x0, 0, x1, f->rows},
                             .layers = o->look->layer != LAYER_PICTURE,
                             .aa = 1,
                             .threads = o->threads,
                             .progress = o->progress,
                             .user = o->user,
                             .reuse = films->film[side]};
    if (o->stage == STAGE_FINE) {
        r.aa = own_aa ? 0 : CHANGES_AA;
        r.aa_threshold = own_aa ? 0 : CHANGES_AA_THRESHOLD;
    }
    if (x0 >= x1)
        return KAGE_OK;
    if (!make_room(f, side))
        return KAGE_NO_MEMORY;
    films->film[side] = NULL; /* the call frees it */
    const kage_status status = kage_render(scene, &r, &films->film[side], errors);
    return status == KAGE_OK ? show(f, side, films->film[side], o) : status;
}

static void describe(frame *f, const kage_scene_info *s, const frame_order *o)
{
    f->number = o->number;
    f->stage = o->stage;
    f->width = o->look->width;
    f->height = o->look->height;
    f->columns = coarse(f->width, o->stage);
    f->rows = coarse(f->height, o->stage);
    f->sides = *o->look->beside ? 2 : 1;
    f->whole = o->whole || f->sides == 1;
    f->split = o->split < 0 ? 0 : o->split > f->width ? f->width : o->split;
    f->legend.layer = o->look->layer;
    snprintf(f->shadow, sizeof f->shadow, "%s", s->method);
    snprintf(f->beside, sizeof f->beside, "%s", o->look->beside);
    snprintf(f->own, sizeof f->own, "%s", s->bump_shadow);
    f->shifted = s->shifted;
    f->displaced = s->displaced;
}

kage_status frame_render(frame *f, frame_films *films, kage_scene *scene, const frame_order *o, kage_errors **errors)
{
    describe(f, kage_scene_get_info(scene), o);
    const int line = f->whole ? 0 : coarse(f->split, o->stage); /* the left side is `beside` */
    const kage_status status = render_side(f, films, 0, line, f->columns, scene, o, errors);
    if (status != KAGE_OK || f->sides == 1)
        return status;
    return render_side(f, films, 1, 0, f->whole ? f->columns : line, scene, o, errors);
}

void frame_free(frame *f)
{
    for (int k = 0; k < FRAME_SIDES; k++)
        free(f->rgba[k]);
    *f = (frame){0};
}

void frame_films_free(frame_films *films)
{
    for (int k = 0; k < FRAME_SIDES; k++)
        kage_film_free(films->film[k]);
    *films = (frame_films){0};
}
