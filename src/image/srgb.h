/* The sRGB transfer function of IEC 61966-2-1, from linear light to 8 or 16 bit codes, and back. */
#ifndef KAGE_IMAGE_SRGB_H
#define KAGE_IMAGE_SRGB_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct srgb srgb;

/* The function to codes of 8 or 16 bits; free() it. NULL: no memory. */
srgb *srgb_create(int bits);

/* rgba: 4 bytes for each of n pixels, the codes of r, g and b as srgb_encode has them, and 255. s: to 8 bits.
 * Reentrant. */
void srgb_encode_rgba(const srgb *s, int n, const float *r, const float *g, const float *b, uint8_t *rgba);

/* code[i] = the code nearest to linear[i], clamped to 0..1; NaN becomes 0. Reentrant. */
void srgb_encode(const srgb *s, int n, const float *linear, uint16_t *code);

/* n pixels of four values, code/255 or code/65535: the first three become linear light. False: no memory. */
bool srgb_decode(size_t n, float *v);

#endif
