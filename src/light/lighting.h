/* Stages: where a group's shadow rays go, and how much of a light's colour arrives. */
#ifndef KAGE_LIGHT_LIGHTING_H
#define KAGE_LIGHT_LIGHTING_H

#include "scene/light.h"
#include "wave/hit_group.h"

/* g->to_light = the segments r + s t', 0 < t' < 1, from the lanes' places at t on their rays to the light. t is g->t or
 * g->t0. */
void lighting_aim(const light *l, const real *t, hit_group *g);

/* sum += what of one sample of an area is lit, by its share; or of its tint. */
void lighting_add(const hit_group *g, real share, real *sum);
void lighting_add_tint(const hit_group *g, real share, vec3s *sum);

/* Scale g->lit by spot falloff and fading at p1. */
void lighting_fade(const light *l, hit_group *g);

#endif
