/* Layers as false colours. */
#include "look/colours.h"

#include <math.h>
#include <stddef.h>

/* Stops of colour maps with equal steps: ColorBrewer's RdBu, turned over, and matplotlib's viridis. */
static const uint8_t blue_to_red[][3] = {{5, 48, 97},     {33, 102, 172},  {67, 147, 195},  {146, 197, 222},
                                         {209, 229, 240}, {247, 247, 247}, {253, 219, 199}, {244, 165, 130},
                                         {214, 96, 77},   {178, 24, 43},   {103, 0, 31}};
static const uint8_t dark_to_bright[][3] = {{68, 1, 84},    {71, 45, 123},  {59, 82, 139},
                                            {44, 114, 142}, {33, 145, 140}, {40, 174, 128},
                                            {94, 201, 98},  {173, 220, 48}, {253, 231, 37}};

/* ColorBrewer's Set2 and Dark2: colours that are told apart. */
static const struct {
    const char *name;
    uint8_t rgb[3];
} orders[] = {{"none", {150, 150, 150}}, {"0", {102, 194, 165}},   {"1", {252, 141, 98}},     {"2", {141, 160, 203}},
              {"2+", {117, 112, 179}},   {"iter", {231, 41, 138}}, {"march", {255, 217, 47}}, {"exact", {217, 95, 2}}};
enum { ORDERS = sizeof orders / sizeof *orders, STOPS_RED = 11, STOPS_BRIGHT = 9 };

static const uint8_t grey[3] = {60, 60, 60};

const char *colours_title(view_layer layer)
{
    static const char *const titles[] = {"", "tau", "order", "height P"};
    return titles[layer];
}

const char *colours_order(int order) { return order >= -1 && order < ORDERS - 1 ? orders[order + 1].name : NULL; }

static const float *plane_of(const kage_film *f, view_layer layer)
{
    static const char *const names[] = {"R", "tau", "order", "height"};
    return kage_film_plane(f, names[layer]);
}

/* Two digits of the next larger of 1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten, so that the range does not
 * change with each picture. */
static double rounded_up(double x)
{
    static const double steps[] = {1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10};
    if (!(x > 0))
        return 1;
    const double power = pow(10, floor(log10(x)));
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++)
        if (steps[k] * power >= x * (1 - 1e-9))
            return steps[k] * power;
    return 10 * power;
}

legend colours_range(const kage_film *f, view_layer layer)
{
    const float *v = plane_of(f, layer);
    const size_t n = (size_t)kage_film_width(f) * (size_t)kage_film_height(f);
    legend l = {layer, 0, 0};
    if (layer == LAYER_ORDER)
        return (legend){layer, -1, ORDERS - 2};
    for (size_t k = 0; k < n; k++)
        if (isfinite(v[k])) {
            l.low = fmin(l.low, (double)v[k]);
            l.high = fmax(l.high, (double)v[k]);
        }
    if (layer == LAYER_TAU) {
        l.high = rounded_up(fmax(l.high, -l.low));
        l.low = -l.high;
    } else if (!(l.high > l.low))
        l.high = l.low + 1;
    return l;
}

static void between(const uint8_t (*stop)[3], int stops, double x, uint8_t rgb[3])
{
    const double at = fmin(fmax(x, 0), 1) * (stops - 1);
    const int k = at >= stops - 1 ? stops - 2 : (int)at;
    for (int c = 0; c < 3; c++)
        rgb[c] = (uint8_t)(stop[k][c] + (at - k) * (stop[k + 1][c] - stop[k][c]) + 0.5);
}

void colours_of(const legend *l, double value, uint8_t rgb[3])
{
    const uint8_t *fixed = grey;
    if (l->layer == LAYER_ORDER && value >= -1 && value < ORDERS - 1)
        fixed = orders[(int)value + 1].rgb;
    else if (l->layer != LAYER_ORDER && isfinite(value)) {
        const double x = (value - l->low) / (l->high - l->low);
        if (l->layer == LAYER_TAU)
            between(blue_to_red, STOPS_RED, x, rgb);
        else
            between(dark_to_bright, STOPS_BRIGHT, x, rgb);
        return;
    }
    for (int c = 0; c < 3; c++)
        rgb[c] = fixed[c];
}

void colours_paint(const kage_film *f, const legend *l, uint8_t *rgba, size_t row_bytes)
{
    const float *v = plane_of(f, l->layer), *order = kage_film_plane(f, "order"),
                *height = kage_film_plane(f, "height");
    const size_t columns = (size_t)kage_film_width(f), rows = (size_t)kage_film_height(f);
    for (size_t k = 0; k < columns * rows; k++) {
        const bool bumped = order[k] >= 0 || height[k] != 0; /* what has no bump has no order, and height 0 */
        uint8_t *to = &rgba[k / columns * row_bytes + 4 * (k % columns)];
        colours_of(l, bumped ? (double)v[k] : (double)NAN, to);
        to[3] = 255;
    }
}
