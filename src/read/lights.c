/* Lights: points, spots, parallel light and areas, and how they fade. */
#include "read/parts.h"

/* The direction of a spot or a parallel light. */
static void read_aim(reader *r, node *at, const char *what, light *l)
{
    node *to = yaml_need(r->y, at, "to", what);
    if (!to || !reader_vector(r, at, "to", "the place it points at [x, y, z]", &l->to))
        return;
    vec3 way = vec3_sub(l->to, l->at);
    if (vec3_length(way) < SMALL)
        yaml_error(r->y, to, "the light points at its own place, expected 'to' apart from 'at'");
    else
        l->axis = vec3_unit(way);
}

static void read_spot(reader *r, node *at, light *l)
{
    l->kind = LIGHT_SPOT;
    l->radius = 30;
    l->falloff = 45;
    if (!yaml_map(r->y, at, "spot", "to radius falloff tightness"))
        return;
    read_aim(r, at, "spot", l);
    bool good = reader_number(r, at, "radius", 0, false, 90,
                              "degrees from the axis to the end of the full light, 0 to 90", &l->radius);
    good = reader_number(r, at, "falloff", 0, true, 90,
                         "degrees from the axis to the end of all light, above 0 and up to 90", &l->falloff) &&
           good;
    reader_number(r, at, "tightness", 0, false, BIG, "an exponent, 0 or more", &l->tightness);
    if (good && l->radius > l->falloff)
        yaml_error(r->y, yaml_get(at, yaml_get(at, "radius") ? "radius" : "falloff"),
                   "a radius of %g and a falloff of %g degrees, expected a radius no larger than the falloff",
                   l->radius, l->falloff);
}

static void read_fade(reader *r, node *at, light *l)
{
    l->fade_power = 2;
    if (!yaml_map(r->y, at, "fade", "distance power") || !yaml_need(r->y, at, "distance", "fade"))
        return;
    reader_number(r, at, "distance", SMALL, false, BIG,
                  "the distance at which the light has its colour, from 1e-6 to 1e6", &l->fade_distance);
    reader_number(r, at, "power", 0, true, 100, "an exponent above 0, at most 100", &l->fade_power);
}

static void read_area(reader *r, node *at, light *l)
{
    if (!yaml_map(r->y, at, "area", "u w samples"))
        return;
    bool good = reader_need_all(r, at, "u w samples", "area");
    good = reader_vector(r, at, "u", "one side of the area, [x, y, z]", &l->u) && good;
    good = reader_vector(r, at, "w", "the other side of the area, [x, y, z]", &l->w) && good;
    reader_counts(r, at, "samples", LIGHT_MAX_SIDE, "how many samples [along u, along w], 1 to 64 each", l->samples);
    if (good && l->kind == LIGHT_PARALLEL)
        yaml_error(r->y, at, "a parallel light has no area, expected 'area' only in a point light or a spot");
}

static void read_light(reader *r, node *v, light *l)
{
    node *k, *spot;
    if (!yaml_map(r->y, v, "a light", "at color spot parallel fade area"))
        return;
    if (yaml_need(r->y, v, "at", "a light"))
        reader_vector(r, v, "at", "the light's place [x, y, z]", &l->at);
    reader_color(r, v, "color", &l->color);
    if ((spot = yaml_get(v, "spot")))
        read_spot(r, spot, l);
    if ((k = yaml_get(v, "parallel"))) {
        l->kind = LIGHT_PARALLEL;
        if (spot)
            yaml_error(r->y, k, "a second kind, 'parallel' beside 'spot', expected one");
        else if (yaml_map(r->y, k, "parallel", "to"))
            read_aim(r, k, "parallel", l);
    }
    if ((k = yaml_get(v, "fade")))
        read_fade(r, k, l);
    if ((k = yaml_get(v, "area")))
        read_area(r, k, l);
}

void reader_lights(reader *r)
{
    scene *s = r->s;
    node *at = reader_named(r, "lights", (cap){SCENE_MAX_ITEMS, ""}, sizeof *s->light, &s->light, &s->lights), *key;
    for (int i = 0; at && i < s->lights; i++) {
        node *v = yaml_pair(at, i, &key);
        light *l = &s->light[i];
        *l = (light){.color = {1, 1, 1}, .samples = {1, 1}};
        l->name = reader_name(r, at, key);
        read_light(r, v, l);
    }
}
