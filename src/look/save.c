/* Saves the picture and the changed scene. */
#include "look/save.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "look/changes.h"

#ifndef PATH_MAX
#define PATH_MAX 4096
#endif

int save_stem(const char *path)
{
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path, *dot = strrchr(base, '.');
    return (int)(dot && dot > base ? dot - path : (long)strlen(path));
}

/* Whether no file has the name. */
static bool is_free(const char *path)
{
    struct stat about;
    return lstat(path, &about) != 0 && errno == ENOENT;
}

/* The first free pair of names. False: there is none. */
static bool find_names(const char *path, char scene[PATH_MAX], char picture[PATH_MAX])
{
    const int most = 100000, n = save_stem(path);
    for (int k = 1; k < most; k++) {
        const int a = snprintf(scene, PATH_MAX, "%.*s-view-%d.yaml", n, path, k);
        const int b = snprintf(picture, PATH_MAX, "%.*s-view-%d.png", n, path, k);
        if (a >= PATH_MAX || b >= PATH_MAX)
            return false;
        if (is_free(scene) && is_free(picture))
            return true;
    }
    return false;
}

static kage_status write_scene(const save_order *o, const char *path, kage_errors **errors)
{
    changes c;
    kage_scene *changed = NULL;
    changes_make(&c, o->look, kage_scene_get_info(o->scene), true);
    const kage_load_options how = {
        .sets = c.list, .set_count = c.count, .threads = o->threads, .progress = o->progress, .user = o->user};
    kage_status status = kage_scene_change(o->scene, &how, &changed, errors);
    if (status == KAGE_OK)
        status = kage_scene_write(changed, path, errors);
    kage_scene_free(changed);
    return status;
}

/* The picture is made from the file, so that it is what `kage render` makes of it, with the same notes in it. */
static kage_status write_picture(const save_order *o, const char *scene, const char *path, kage_errors **errors)
{
    kage_scene *s = NULL;
    kage_film *f = NULL;
    const kage_load_options how = {
        .threads = o->threads, .progress = o->progress, .user = o->user, .limits = o->limits};
    const kage_render_options render = {.threads = o->threads, .progress = o->progress, .user = o->user};
    const kage_write_options write = {.threads = o->threads, .progress = o->progress, .user = o->user};
    kage_status status = kage_scene_load(scene, &how, &s, errors);
    if (status == KAGE_OK)
        status = kage_render(s, &render, &f, errors);
    if (status == KAGE_OK)
        status = kage_film_write(f, path, &write, errors);
    kage_film_free(f);
    kage_scene_free(s);
    return status;
}

static const char *base_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

bool save_picture(const save_order *o, char text[SAVE_TEXT])
{
    char scene[PATH_MAX], picture[PATH_MAX];
    kage_errors *e = NULL;
    if (!find_names(o->path, scene, picture)) {
        snprintf(text, SAVE_TEXT, "not saved: no name is free beside the scene");
        return false;
    }
    kage_status status = write_scene(o, scene, &e);
    if (status == KAGE_OK) {
        status = write_picture(o, scene, picture, &e);
        if (status != KAGE_OK) /* both, or none */
            remove(scene);
    }
    const kage_error *first = kage_errors_get(e, 0);
    if (status == KAGE_OK)
        snprintf(text, SAVE_TEXT, "saved %.200s and %.200s", base_of(scene), base_of(picture));
    else
        snprintf(text, SAVE_TEXT, "not saved: %s", first ? first->text : "cancelled");
    kage_errors_free(e);
    return status == KAGE_OK;
}
