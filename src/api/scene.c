/* Scenes: reading them, and reading them again for another kind of surface. */
#include "api/api.h"

#include <stdlib.h>
#include <string.h>

static int reading_index(reading r)
{
    return r.displaced + 2 * (r.shadow.kind == METHOD_EXACT) + 4 * (r.bump_shadow.kind == BUMP_SHADOW_EXACT) +
           8 * (r.bump_shadow.kind == BUMP_SHADOW_HORIZON);
}

static char *copy(const char *text, bool *good)
{
    char *c = text ? strdup(text) : NULL;
    *good = *good && (!text || c);
    return c;
}

/* Copy what a further reading needs. False: out of memory. */
static bool keep(kage_scene *k, const char *folder, const kage_load_options *o)
{
    bool good = true;
    k->folder = copy(folder, &good);
    k->model_reader = copy(o->model_reader, &good);
    k->threads = o->threads;
    k->set = calloc((size_t)o->set_count + 1, sizeof *k->set);
    for (; k->set && k->sets < o->set_count && good; k->sets++)
        k->set[k->sets] = copy(o->sets[k->sets], &good);
    return good && k->set && arrays_take(&k->arrays, o);
}

static kage_status load(scene_source *from, const kage_load_options *given, kage_scene **out, kage_errors **to)
{
    const kage_load_options o = given ? *given : (kage_load_options){0};
    *out = NULL;
    if (o.threads < 0 || o.threads > KAGE_MAX_THREADS || o.set_count < 0)
        return error_give(KAGE_BAD_OPTION, to, "%d threads and %d changes, expected 0 to %d and 0 or more", o.threads,
                          o.set_count, KAGE_MAX_THREADS);
    errors e = {0};
    if (!arrays_are_good(&o, &e))
        return errors_give(&e, KAGE_BAD_OPTION, NULL, to);
    c_locale l = c_locale_begin();
    watch w = {o.progress, o.user, &l, false};
    const progress p = watch_progress(&w);
    kage_scene *k = calloc(1, sizeof *k);
    if (k && pthread_mutex_init(&k->lock, NULL) != 0) {
        free(k);
        k = NULL;
    }
    from->sets = o.set_count;
    from->set = o.sets;
    from->threads = o.threads;
    from->model_reader = o.model_reader;
    from->progress = &p;
    from->arrays = k ? &k->arrays : NULL;
    scene *s = k && keep(k, from->folder, &o) ? scene_read(from, &e) : NULL;
    if (s) {
        k->first = s;
        k->reading[reading_index((reading){s->displaced, s->shadow, s->bump_shadow})] = s;
    }
    const bool good = s && !w.cancelled && scene_note(k);
    c_locale_end(&l);
    if (good)
        *out = k;
    else
        kage_scene_free(k);
    return errors_give(&e, good ? KAGE_OK : KAGE_BAD_INPUT, &w, to);
}

kage_status kage_scene_load(const char *path, const kage_load_options *options, kage_scene **out, kage_errors **to)
{
    scene_source from = {.path = path};
    return load(&from, options, out, to);
}

kage_status kage_scene_parse(const char *text, size_t size, const char *name, const char *folder,
                             const kage_load_options *options, kage_scene **out, kage_errors **to)
{
    scene_source from = {.path = name ? name : "scene", .text = text, .size = size, .folder = folder ? folder : ""};
    return load(&from, options, out, to);
}

void kage_scene_free(kage_scene *k)
{
    if (!k)
        return;
    scene_forget(k);
    for (int i = 0; i < READINGS; i++)
        scene_free(k->reading[i]);
    for (int i = 0; k->set && i < k->sets; i++)
        free(k->set[i]);
    free(k->set);
    free(k->folder);
    free(k->model_reader);
    arrays_free(&k->arrays);
    pthread_mutex_destroy(&k->lock);
    free(k);
}

/* Read the scene's text again, with more changes. */
static scene *read_again(const kage_scene *k, reading r, errors *e)
{
    enum { MORE = 3 };
    char shadow[METHOD_NAME_SIZE + sizeof "render.shadow="] = "render.shadow=";
    char own[BUMP_SHADOW_NAME_SIZE + sizeof "render.bump_shadow="] = "render.bump_shadow=";
    method_name(r.shadow, shadow + strlen(shadow));
    bump_shadow_name(r.bump_shadow, own + strlen(own));
    const char *const more[MORE] = {r.displaced ? "render.surface=displaced" : "render.surface=smooth", shadow, own};
    const char **set = malloc(((size_t)k->sets + MORE) * sizeof *set);
    if (!set) {
        errors_add(e, "out of memory");
        return NULL;
    }
    for (int i = 0; i < k->sets; i++)
        set[i] = k->set[i];
    memcpy(set + k->sets, more, sizeof more);
    const scene *other[READINGS];
    int others = 0;
    for (int i = 0; i < READINGS; i++)
        if (k->reading[i])
            other[others++] = k->reading[i];
    const scene_source from = {
        .path = k->first->path,
        .text = k->first->source,
        .size = strlen(k->first->source),
        .folder = k->folder,
        .sets = k->sets + MORE,
        .set = set,
        .threads = k->threads,
        .model_reader = k->model_reader,
        .arrays = &k->arrays,
        .others = others,
        .other = other,
    };
    scene *s = scene_read(&from, e);
    free(set);
    return s;
}

const scene *scene_reading(kage_scene *k, reading r, errors *e)
{
    scene **at = &k->reading[reading_index(r)];
    pthread_mutex_lock(&k->lock);
    if (!*at)
        *at = read_again(k, r, e);
    const scene *s = *at;
    pthread_mutex_unlock(&k->lock);
    return s;
}

int kage_scene_uses_file(const kage_scene *k, const char *path) { return files_have_path(&k->first->made_from, path); }
