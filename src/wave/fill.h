/* The same number for n lanes. */
#ifndef KAGE_WAVE_FILL_H
#define KAGE_WAVE_FILL_H

#include "wave/wave.h"

void fill(int n, real x, real *to);
void fill_ids(int n, int32_t id, int32_t *to);
void fill_vec3s(int n, real x, real y, real z, vec3s *to);

#endif
