/* Stages: a group's shadow rays, sums over the samples of area lights, and attenuation. */
#ifndef KAGE_LIGHT_LIGHTING_H
#define KAGE_LIGHT_LIGHTING_H

#include "scene/light.h"
#include "wave/hit_group.h"

/* Shadow rays r + s t', 0 < t' < 1, from the point at t[i] on each of n rays to the light. */
void lighting_rays(const light *l, int n, const rays *x, const real *t, rays *to_light);

/* The same into g->to_light. t is g->t or g->t0. */
void lighting_aim(const light *l, const real *t, hit_group *g);

/* The same from any places. */
void lighting_aim_from(const light *l, const vec3s *from, hit_group *g);

/* sum += share * g->lit, for one sample of an area light; with tint: share * g->lit * g->tint. */
void lighting_add(const hit_group *g, real share, real *sum);
void lighting_add_tint(const hit_group *g, real share, vec3s *sum);

/* Scale g->lit by spot falloff and distance fading at the shaded place. */
void lighting_fade(const light *l, hit_group *g);

#endif
