/* Scenes from text, and what their rays find. */
#ifndef KAGE_TESTS_SCENE_TEXT_H
#define KAGE_TESTS_SCENE_TEXT_H

#include <stdio.h>
#include <string.h>

#include "render/trace.h"
#include "scene/scene.h"
#include "wave/lane.h"

static inline scene *scene_text(const char *text)
{
    errors e = {0};
    scene *s = scene_read(&(scene_source){.path = "test.yaml", .text = text, .size = strlen(text)}, &e);
    if (!s)
        fail_msg("%s", e.text);
    errors_free(&e);
    return s;
}

/* A workspace in which lane i has its ray through pixel i of the picture, row by row. */
static inline workspace *camera_wave(const tracer *tr)
{
    const scene *s = tr->scene;
    workspace *v = workspace_new(tr, NULL);
    assert_non_null(v);
    for (int i = 0; i < LANES; i++)
        camera_ray(&s->camera, s->width, s->height, i % s->width + 0.5, i / s->width + 0.5, &v->x, i);
    return v;
}

#endif
