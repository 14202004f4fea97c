/* Files that scenes name: maps as PNG and EXR, also as images in colour, control points of patches, lists of copies. */
#include "fuzz/fuzz.h"

#include <stdio.h>
#include <string.h>

#define HEAD                                                                                                           \
    "camera: {from: [0.3, 0.5, -4], at: [0, 0, 0], fov: 50}\n"                                                         \
    "image: {size: [8, 6]}\n"                                                                                          \
    "lights: {lamp: {at: [-4, 5, -2]}}\n"

#define SQUARE "objects:\n  it: {rectangle: {origin: [-1, 1, 0], u: [2, 0, 0], w: [0, -2, 0.5]}, material: it"

static const char heights[] = HEAD "render: {shadow: 2}\nmaterials: {it: {}}\n" SQUARE
                                   ", bump: {map: {file: %s}, scale: 0.1, zero: 0.5, sign: up}}\n";

static const char smoothed[] = HEAD "render: {shadow: exact}\nmaterials: {it: {}}\n" SQUARE
                                    ", bump: {map: {file: %s}, scale: 0.1, zero: 0.5, sign: down, smooth: 1.5, samples:"
                                    " corners, wrap: mirror}}\n";

static const char one_channel[] =
    HEAD "materials: {it: {}}\n" SQUARE ", bump: {map: {file: %s, channel: R}, scale: 0.1, zero: 0.5, sign: up}}\n";

static const char colours[] = HEAD "materials: {it: {color: {image: {file: %s}}}}\n" SQUARE "}\n";

static const char patches[] =
    HEAD "render: {shadow: 1}\nmaterials: {it: {}}\n"
         "objects: {it: {patches: {file: %s}, material: it, bump: {function: 0.01*sin(9*u)}}}\n";

static const char copies[] = HEAD "materials: {it: {}, a: {color: [1, 0, 0]}, b: {filter: 0.5}}\n"
                                  "objects:\n  it: {sphere: {center: [0, 0, 0], radius: 0.2}, material: it}\n"
                                  "  all: {copies: {of: it, file: %s}}\n";

static const char coloured_copies[] =
    HEAD "materials: {it: {}, a: {color: [1, 0, 0]}, b: {filter: 0.5}}\n"
         "objects:\n  it: {sphere: {center: [0, 0, 0], radius: 0.2}, material: it}\n"
         "  all: {copies: {of: it, file: %s, materials: [a, b]}, transform: [{scale: 0.5}]}\n";

/* Pixels that the file says it has; 0: unknown. Large ones take long, and are refused elsewhere. */
static double pixels_of_png(const uint8_t *d, size_t size)
{
    double side[2] = {0, 0};
    for (size_t k = 0; k < 8 && size >= 24; k++)
        side[k / 4] = side[k / 4] * 256 + d[16 + k];
    return side[0] * side[1];
}

static double pixels_of_exr(const uint8_t *d, size_t size)
{
    static const char key[] = "dataWindow\0box2i";
    for (size_t k = 0; k + sizeof key + 20 <= size; k++)
        if (memcmp(d + k, key, sizeof key) == 0) {
            int32_t x[4];
            memcpy(x, d + k + sizeof key + 4, sizeof x);
            return ((double)x[2] - x[0] + 1) * ((double)x[3] - x[1] + 1);
        }
    return 0;
}

static void read_as_map(const uint8_t *data, size_t size, const char *path, bool in_colour)
{
    fuzz_write(path, data, size);
    fuzz_scene_of_file(heights, path);
    fuzz_scene_of_file(colours, path);
    fuzz_scene_of_file(in_colour ? one_channel : smoothed, path);
    kage_file_is_picture(path);
}

void fuzz_png(const uint8_t *data, size_t size)
{
    if (pixels_of_png(data, size) <= 1 << 16)
        read_as_map(data, size, fuzz_path("in.png"), false);
}

void fuzz_exr(const uint8_t *data, size_t size)
{
    if (pixels_of_exr(data, size) <= 1 << 16)
        read_as_map(data, size, fuzz_path("in.exr"), true);
}

void fuzz_patch(const uint8_t *data, size_t size)
{
    fuzz_write(fuzz_path("in.txt"), data, size);
    fuzz_scene_of_file(patches, fuzz_path("in.txt"));
}

void fuzz_points(const uint8_t *data, size_t size)
{
    const char *path = fuzz_path(size >= 3 && memcmp(data, "ply", 3) == 0 ? "in.ply" : "in.csv");
    fuzz_write(path, data, size);
    fuzz_scene_of_file(copies, path);
    fuzz_scene_of_file(coloured_copies, path);
}
