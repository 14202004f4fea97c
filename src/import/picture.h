/* Images of a model: what kage can't read as it is becomes a PNG of 8 bits a channel. */
#ifndef KAGE_IMPORT_PICTURE_H
#define KAGE_IMPORT_PICTURE_H

#include <stdbool.h>
#include <stddef.h>

typedef enum picture_kind { PICTURE_OTHER, PICTURE_PNG, PICTURE_JPEG, PICTURE_EXR } picture_kind;

/* By the first bytes. */
picture_kind picture_kind_of(const unsigned char *bytes, size_t size);

/* Red, green and blue of 8 bits in sRGB, row by row from the top. */
typedef struct picture {
    int width, height;
    unsigned char *v; /* free() */
    bool clear;       /* some pixel was transparent; its colour is as it was behind its alpha */
} picture;

enum { PICTURE_WHY = 256 };

/* Decode a PNG or a JPEG. False, with a reason; out->v is NULL then. */
bool picture_decode(const unsigned char *bytes, size_t size, picture *out, char why[PICTURE_WHY]);

/* Pixels of 4 bytes: blue, green, red, alpha. False: out of memory. */
bool picture_of_texels(const unsigned char *bgra, int width, int height, picture *out);

/* Multiply by a colour in linear light. */
void picture_tint(picture *p, const double factor[3]);

/* Make a PNG. The bytes are to be freed. NULL: it can't be made. */
unsigned char *picture_encode(const picture *p, size_t *size);

#endif
