/* Stages: the light that a group reflects to the eye, by POV-Ray's finish. */
#ifndef KAGE_LIGHT_SHADE_H
#define KAGE_LIGHT_SHADE_H

#include "wave/hit_group.h"
#include "scene/scene.h"

/* g->rgb = ambient light. The colour is the material's or, with a pattern, g->color; so too in shade_light. */
void shade_ambient(hit_group *g, const material *m);

/* g->rgb += diffuse light and highlights of light l at the shaded place with n', times g->lit and, if tinted, g->tint.
 * front: a light behind the smooth surface gives nothing; otherwise n' decides. Opacity scales ambient and diffuse
 * light, not highlights. */
void shade_light(hit_group *g, const material *m, const light *l, bool tinted, bool front);

#endif
