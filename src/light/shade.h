/* Stages: light on a group, as POV-Ray's finish has it. */
#ifndef KAGE_LIGHT_SHADE_H
#define KAGE_LIGHT_SHADE_H

#include "wave/hit_group.h"
#include "scene/scene.h"

/* Both take the material's colour where it is constant, otherwise g->color.
 *
 * g->rgb = ambient light. */
void shade_ambient(hit_group *g, const material *m);

/* g->rgb += what this light sends from p1 = r + s t_hit to the eye, with n', where g->lit. A light on the far side of
 * the smooth surface gives nothing, whichever way n' leans. tinted: g->tint of it alone. Highlights keep their strength
 * on transparent materials, ambient and diffuse light their share of opacity. */
void shade_light(hit_group *g, const material *m, const light *l, bool tinted);

#endif
