/* A scene to a picture by libkage.
 *
 *     cc render.c -o render $(pkg-config --cflags --libs kage)
 *     ./render scene.yaml picture.png [method]
 */
#include <kage.h>

#include <stdio.h>

static int show(void *user, const char *what, double share)
{
    (void)user;
    fprintf(stderr, "\r%-10s %3.0f %%", what, 100 * share);
    return 0; /* anything else cancels */
}

/* Print what is wrong; it is ours to free. */
static int fail(kage_errors *errors)
{
    for (int k = 0; k < kage_errors_count(errors); k++)
        fprintf(stderr, "%s\n", kage_errors_get(errors, k)->message);
    kage_errors_free(errors);
    return 1;
}

int main(int argc, char **argv)
{
    kage_scene *scene = NULL;
    kage_film *film = NULL;
    kage_errors *errors = NULL;
    kage_render_options options = {0}; /* all as the scene says */
    if (argc < 3) {
        fprintf(stderr, "render SCENE PICTURE.png [METHOD]\n");
        return 2;
    }
    options.method = argc > 3 ? argv[3] : NULL;
    options.progress = show;
    kage_status status = kage_scene_load(argv[1], NULL, &scene, &errors);
    if (status == KAGE_OK)
        status = kage_render(scene, &options, &film, &errors);
    if (status == KAGE_OK)
        status = kage_film_write(film, argv[2], NULL, &errors);
    if (status == KAGE_OK)
        fprintf(stderr, "\r%d x %d pixels in %.2f s\n", kage_film_width(film), kage_film_height(film),
                kage_film_get_stats(film)->seconds);
    kage_film_free(film);
    kage_scene_free(scene);
    return status == KAGE_OK ? 0 : fail(errors);
}
