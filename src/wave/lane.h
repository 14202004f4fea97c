/* One lane of a wave as a vector of bumpshadow.h. Inlined, so that loops with these still vectorise. */
#ifndef KAGE_WAVE_LANE_H
#define KAGE_WAVE_LANE_H

#ifdef KAGE_DOUBLE
#define BS_DOUBLE
#endif
#include "bumpshadow.h"
#include "wave/wave.h"

static inline bs_vec3 lane_get(const vec3s *v, int i) { return (bs_vec3){v->x[i], v->y[i], v->z[i]}; }

static inline void lane_set(vec3s *v, int i, bs_vec3 x)
{
    v->x[i] = x.x;
    v->y[i] = x.y;
    v->z[i] = x.z;
}

/* v over its length; shorter where that has no digits, and 0 where v is 0. */
static inline bs_vec3 lane_unit(bs_vec3 v)
{
    real il = 1 / real_sqrt(real_max(bs_dot(v, v), REAL_LEAST));
    return (bs_vec3){v.x * il, v.y * il, v.z * il};
}

/* r + s t */
static inline bs_vec3 lane_at(const rays *x, int i, real t)
{
    return (bs_vec3){x->r.x[i] + x->s.x[i] * t, x->r.y[i] + x->s.y[i] * t, x->r.z[i] + x->s.z[i] * t};
}

#endif
