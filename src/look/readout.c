/* The values under the mouse. */
#include "look/readout.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
append(char text[READOUT_COLUMNS], const char *fmt, ...)
{
    const size_t used = strlen(text);
    va_list args;
    va_start(args, fmt);
    vsnprintf(text + used, READOUT_COLUMNS - used, fmt, args);
    va_end(args);
}

/* `lit`, `shadow`, or the share of an area light that is seen. */
static void append_light(char text[READOUT_COLUMNS], double visible, int width)
{
    if (visible > 0 && visible < 1)
        append(text, " %-*.3g", width, visible);
    else
        append(text, " %-*s", width, visible > 0 ? "lit" : "shadow");
}

/* The row of the picture's method; where the probe has none, as for `exact` with other steps, NULL. */
static const kage_probe_row *row_of(const kage_probe *p, const kage_scene_info *s)
{
    for (int k = 0; k < p->row_count; k++)
        if (strcmp(p->rows[k].method, s->method) == 0 && p->rows[k].guard == s->guard)
            return &p->rows[k];
    return NULL;
}

static void make_line(readout *r, const kage_scene_info *s, const kage_probe *p)
{
    const kage_object_info *o = &s->objects[p->object];
    const kage_probe_row *row = row_of(p, s);
    append(r->line, "%-4d %-4d %s  (u,w) %.4g %.4g", r->x, r->y, o->name, p->u, p->w);
    if (p->bumped)
        append(r->line, "  P %.4g", p->P);
    if (p->bumped && row)
        append(r->line, "  tau %.4g%s%s", row->tau, row->fell_back ? " by " : "", row->fell_back ? row->fell_back : "");
    for (int k = 0; row && k < s->light_count && k < 4; k++) {
        append(r->line, "  %s", s->lights[k].name);
        append_light(r->line, row->visible[k], 0);
    }
}

static void make_table(readout *r, const kage_scene_info *s, const kage_probe *p)
{
    const int lights = s->light_count < 6 ? s->light_count : 6;
    append(r->table[0], "%-8s %11s %11s  %-5s", "method", "tau", "t0", "fell");
    for (int l = 0; l < lights; l++)
        append(r->table[0], " %-8.8s", s->lights[l].name);
    r->lines = 1;
    for (int k = 0; k < p->row_count && r->lines < READOUT_LINES; k++) {
        const kage_probe_row *x = &p->rows[k];
        char *text = r->table[r->lines];
        if (x->guard != s->guard && strcmp(x->method, "none") != 0) /* the other half is not in this picture */
            continue;
        append(text, "%-8s %11.5g %11.5g  %-5s", x->method, x->tau, x->t0, x->fell_back ? x->fell_back : "");
        for (int l = 0; l < lights; l++)
            append_light(text, x->visible[l], 8);
        r->lines++;
    }
}

void readout_make(readout *r, kage_scene *scene, int x, int y)
{
    const kage_scene_info *s = kage_scene_get_info(scene);
    kage_probe *p = NULL;
    memset(r, 0, sizeof *r);
    r->x = x;
    r->y = y;
    if (kage_scene_probe(scene, x, y, &p, NULL) != KAGE_OK)
        return;
    if (p->object < 0)
        append(r->line, "%-4d %-4d nothing", x, y);
    else {
        make_line(r, s, p);
        make_table(r, s, p);
        if (p->bumped)
            snprintf(r->owner, sizeof r->owner, "%s", s->objects[p->object].bump_of);
    }
    kage_probe_free(p);
}
