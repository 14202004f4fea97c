/* The sRGB transfer function of IEC 61966-2-1, from linear light to 8 or 16 bit codes. */
#ifndef KAGE_SRGB_H
#define KAGE_SRGB_H

#include <stdint.h>

typedef struct srgb srgb;

/* The function to codes of 8 or 16 bits; free() it. NULL: no memory. */
srgb *srgb_create(int bits);

/* code[i] = the code nearest to linear[i], clamped to 0..1; NaN becomes 0. Reentrant. */
void srgb_encode(const srgb *s, int n, const float *linear, uint16_t *code);

#endif
