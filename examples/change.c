/* A height map from memory, and a light that moves: change after change of one scene.
 *
 *     cc change.c -o change $(pkg-config --cflags --libs kage) -lm
 *     ./change pictures
 */
#include <kage.h>

#include <math.h>
#include <stdio.h>

enum { SIDE = 256, FRAMES = 8 };

static const char text[] = "camera: {from: [0, 4, -6], at: [0, 0, 0], fov: 40}\n"
                           "image: {size: [320, 240]}\n"
                           "render: {shadow: 0}\n"
                           "lights:\n"
                           "  lamp: {at: [-4, 3, -2], color: [1, 1, 1]} # moves\n"
                           "materials: {clay: {color: [0.8, 0.7, 0.6], diffuse: 0.8}}\n"
                           "objects:\n"
                           "  cube: {box: {from: [-0.5, 0.4, -0.5], to: [0.5, 1.4, 0.5]}, material: clay}\n"
                           "  ground:\n"
                           "    plane: {origin: [-4, 0, -4], u: [0, 0, 1], w: [1, 0, 0]}\n"
                           "    material: clay\n"
                           "    bump: {map: {file: 'array:rings'}, size: [8, 8], scale: 0.2, zero: 0, sign: up}\n";

static void fill(float *to) /* rings about the middle */
{
    for (int k = 0; k < SIDE * SIDE; k++)
        to[k] = cosf(0.3f * hypotf((float)(k % SIDE - SIDE / 2), (float)(k / SIDE - SIDE / 2)));
}

int main(int argc, char **argv)
{
    static float heights[SIDE * SIDE];
    const kage_image_array rings = {"rings", SIDE, SIDE, 1, KAGE_F32, heights};
    const kage_load_options load = {.images = &rings, .image_count = 1};
    kage_render_options render = {.reuse = NULL};
    kage_scene *scene, *next;
    kage_film *film = NULL;
    char set[80], path[400];
    fill(heights);
    if (argc < 2 || kage_scene_parse(text, sizeof text - 1, "rings", NULL, &load, &scene, NULL) != KAGE_OK)
        return 2;
    for (int k = 0; k < FRAMES; k++) {
        const char *const sets[] = {set};
        snprintf(set, sizeof set, "lights.lamp.at=[%.3f, 3, %.3f]", 4 * sin(0.8 * k), -4 * cos(0.8 * k));
        if (kage_scene_change(scene, &(kage_load_options){.sets = sets, .set_count = 1}, &next, NULL) != KAGE_OK)
            return 1;
        kage_scene_free(scene);
        scene = next;
        render.reuse = film; /* the memory of the picture before */
        snprintf(path, sizeof path, "%s/%d.png", argv[1], k);
        if (kage_render(scene, &render, &film, NULL) != KAGE_OK || kage_film_write(film, path, NULL, NULL) != KAGE_OK)
            return 1;
    }
    snprintf(path, sizeof path, "%s/last.yaml", argv[1]);
    kage_status status = kage_scene_write(scene, path, NULL); /* with the lamp's place, and the comment */
    kage_film_free(film);
    kage_scene_free(scene);
    return status == KAGE_OK ? 0 : 1;
}
