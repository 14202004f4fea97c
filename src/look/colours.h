/* Layers as false colours, with what the legend says of them. */
#ifndef KAGE_LOOK_COLOURS_H
#define KAGE_LOOK_COLOURS_H

#include "look/state.h"

/* tau: blue below 0, white at 0, red above; the range is symmetric. order: a colour for each. height: from dark to
 * bright over the heights in the picture. Where there is no bump: grey. */
typedef struct legend {
    view_layer layer;
    double low, high; /* the values at the ends of the bar */
} legend;

/* The layer's name with its unit, for the legend. */
const char *colours_title(view_layer layer);

/* The orders by their value in the film's plane `order`, from -1 on. NULL: no such order. */
const char *colours_order(int order);

/* The range of the layer's values on a film with layers. */
legend colours_range(const kage_film *f, view_layer layer);

/* One value as red, green, blue. */
void colours_of(const legend *l, double value, uint8_t rgb[3]);

/* The pixels of a film with layers by the legend, 4 bytes each, rows of row_bytes. */
void colours_paint(const kage_film *f, const legend *l, uint8_t *rgba, size_t row_bytes);

#endif
