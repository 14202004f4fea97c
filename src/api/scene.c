/* Scenes: reading them, and reading them again with changes, or for another kind of surface. */
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

/* Copy what a further reading needs: of the scene that this is a change of, and of the options. False: out of memory.
 */
static bool keep(kage_scene *k, const kage_scene *before, const char *folder, const kage_load_options *o, memory *m)
{
    const char *reader = o->model_reader ? o->model_reader : before ? before->model_reader : NULL;
    bool good = true;
    k->folder = copy(folder, &good);
    k->model_reader = copy(reader, &good);
    k->threads = o->threads ? o->threads : before ? before->threads : 0;
    k->set = calloc((size_t)o->set_count + (size_t)(before ? before->sets : 0) + 1, sizeof *k->set);
    for (; k->set && before && k->sets < before->sets && good; k->sets++)
        k->set[k->sets] = copy(before->set[k->sets], &good);
    for (int j = 0; k->set && j < o->set_count && good; j++)
        good = before ? sets_put(k, o->sets[j]) : (k->set[k->sets++] = copy(o->sets[j], &good), good);
    return good && k->set && (!before || arrays_add_all(&k->arrays, &before->arrays)) && arrays_take(&k->arrays, o, m);
}

/* A callback of progress may call the library with the scene that is read again. */
static bool init_lock(pthread_mutex_t *lock)
{
    pthread_mutexattr_t again;
    if (pthread_mutexattr_init(&again) != 0)
        return false;
    const bool good =
        pthread_mutexattr_settype(&again, PTHREAD_MUTEX_RECURSIVE) == 0 && pthread_mutex_init(lock, &again) == 0;
    pthread_mutexattr_destroy(&again);
    return good;
}

static kage_scene *new_scene(const kage_scene *before, const kage_limits *l)
{
    kage_scene *k = calloc(1, sizeof *k);
    if (!k || !init_lock(&k->lock)) {
        free(k);
        return NULL;
    }
    k->allowed.budget = before ? budget_share(before->allowed.budget) : budget_open();
    k->allowed.most = before && !(l && l->memory) ? before->allowed.most : limits_memory(l);
    if (before)
        k->allowed.limits = before->allowed.limits;
    limits_take(&k->allowed.limits, l);
    if (k->allowed.budget)
        return k;
    pthread_mutex_destroy(&k->lock);
    free(k);
    return NULL;
}

/* What may be on shelves: of a scene's readings, which live as long as it does, and what it has to spare. Returns how
 * many. */
enum { SHELVES = READINGS + 2 };
static int shelves_of(kage_scene *k, const shelf *all[SHELVES])
{
    int n = 0;
    for (int i = 0; i < READINGS; i++) {
        const scene *s = __atomic_load_n(&k->reading[i], __ATOMIC_ACQUIRE);
        if (s)
            all[n++] = &s->shelf;
    }
    bool kept = false;
    for (int i = 0; i < n; i++)
        kept = kept || all[i] == &k->first->shelf;
    if (!kept) /* it has only what a survey needs */
        all[n++] = &k->first->shelf;
    all[n++] = &k->spare;
    return n;
}

/* Keep what readings other than the first have made, as the changed scene may need it once it is read for them. */
static bool keep_spare(kage_scene *k, const kage_scene *before, const shelf *const *all, int n)
{
    bool good = true;
    for (int i = 0; i + 1 < n; i++)
        for (int j = 0; all[i] != &before->first->shelf && j < all[i]->count; j++)
            if (good && !shelf_has(&before->first->shelf, all[i]->item[j]) && !shelf_has(&k->spare, all[i]->item[j]))
                good = shelf_put_shared(&k->spare, all[i]->item[j]);
    return good;
}

static bool good_options(const kage_load_options *o, errors *e)
{
    if (o->threads < 0 || o->threads > KAGE_MAX_THREADS || o->set_count < 0)
        return errors_add(e, "%d threads and %d changes, expected 0 to %d and 0 or more", o->threads, o->set_count,
                          KAGE_MAX_THREADS);
    return limits_are_good(o->limits, e) && arrays_are_good(o, e);
}

/* Read from->text or the file. before: the scene that this is a change of, or NULL; with tighter limits all is read
 * again. False: errors in *e. */
static bool read_first(kage_scene *k, kage_scene *before, scene_source *from, const kage_load_options *o, errors *e)
{
    const shelf *all[SHELVES];
    if (before && !limits_are_tighter(&before->allowed.limits, &k->allowed.limits))
        from->shelves = shelves_of(before, all);
    memory *m = from->progress->memory;
    char words[MEMORY_WORDS];
    if (!keep(k, before, from->folder, o, m) || !keep_spare(k, before, all, from->shelves))
        return errors_add(e, "%s", memory_words(m, words));
    from->shelf = all;
    from->again = before;
    from->sets = k->sets;
    from->set = (const char *const *)k->set;
    from->threads = k->threads;
    from->model_reader = k->model_reader;
    from->arrays = &k->arrays;
    from->survey = o->survey != 0;
    scene *s = scene_read(from, e);
    if (!s)
        return false;
    k->first = s;
    if (!from->survey || !(scene_wants_truth(s) || scene_wants_horizons(s)))
        k->reading[reading_index((reading){s->displaced, s->shadow, s->bump_shadow})] = s;
    k->from_file = before ? before->from_file : !from->text;
    return !before || !k->from_file || files_add_path(&s->made_from, s->path) || errors_add(e, "out of memory");
}

static kage_status load(kage_scene *before, scene_source *from, const kage_load_options *given, kage_scene **out,
                        kage_errors **to)
{
    const kage_load_options o = given ? *given : (kage_load_options){0};
    errors e = {0};
    *out = NULL;
    if (!good_options(&o, &e))
        return errors_give(&e, KAGE_BAD_OPTION, NULL, to);
    c_locale l = c_locale_begin();
    watch w;
    kage_scene *k = new_scene(before, o.limits);
    const progress p = watch_begin(&w, o.progress, o.user, &l, o.limits, k ? &k->allowed : NULL);
    from->progress = &p;
    const bool good = k && read_first(k, before, from, &o, &e) && !watch_stopped(&w) && scene_describe(k);
    c_locale_end(&l);
    if (good)
        *out = k;
    else
        kage_scene_free(k);
    return errors_give(&e, good ? KAGE_OK : KAGE_BAD_INPUT, &w, to);
}

kage_status kage_scene_change(kage_scene *k, const kage_load_options *options, kage_scene **out, kage_errors **to)
{
    const scene *s = k->first;
    scene_source from = {.path = s->path, .text = s->source, .size = strlen(s->source), .folder = k->folder};
    return load(k, &from, options, out, to);
}

kage_status kage_scene_load(const char *path, const kage_load_options *options, kage_scene **out, kage_errors **to)
{
    scene_source from = {.path = path};
    return load(NULL, &from, options, out, to);
}

kage_status kage_scene_parse(const char *text, size_t size, const char *name, const char *folder,
                             const kage_load_options *options, kage_scene **out, kage_errors **to)
{
    scene_source from = {.path = name ? name : "scene", .text = text, .size = size, .folder = folder ? folder : ""};
    return load(NULL, &from, options, out, to);
}

void kage_scene_free(kage_scene *k)
{
    if (!k)
        return;
    scene_forget(k);
    bool kept = false; /* the first is no reading where it has only what a survey needs */
    for (int i = 0; i < READINGS; i++) {
        kept = kept || k->reading[i] == k->first;
        scene_free(k->reading[i]);
    }
    if (!kept)
        scene_free(k->first);
    for (int i = 0; k->set && i < k->sets; i++)
        free(k->set[i]);
    free(k->set);
    free(k->text);
    free(k->folder);
    free(k->model_reader);
    arrays_free(&k->arrays);
    shelf_free(&k->spare);
    budget_close(k->allowed.budget);
    pthread_mutex_destroy(&k->lock);
    free(k);
}

/* Read the scene's text again, with more changes. */
static scene *read_again(kage_scene *k, reading r, const progress *p, errors *e)
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
    const shelf *all[SHELVES];
    const scene_source from = {
        .path = k->first->path,
        .text = k->first->source,
        .size = strlen(k->first->source),
        .folder = k->folder,
        .sets = k->sets + MORE,
        .set = set,
        .threads = k->threads,
        .model_reader = k->model_reader,
        .progress = p,
        .arrays = &k->arrays,
        .shelves = shelves_of(k, all),
        .shelf = all,
    };
    scene *s = scene_read(&from, e);
    free(set);
    return s;
}

/* Who finds it need not wait for others, who may be reading for long. */
const scene *scene_reading(kage_scene *k, reading r, const progress *p, errors *e)
{
    scene **at = &k->reading[reading_index(r)], *s = __atomic_load_n(at, __ATOMIC_ACQUIRE);
    if (s)
        return s;
    pthread_mutex_lock(&k->lock);
    s = __atomic_load_n(at, __ATOMIC_ACQUIRE);
    scene *made = s ? NULL : read_again(k, r, p, e);
    s = __atomic_load_n(at, __ATOMIC_ACQUIRE);
    if (s) /* a call by the callback of this one was sooner */
        scene_free(made);
    else if ((s = made))
        __atomic_store_n(at, s, __ATOMIC_RELEASE);
    pthread_mutex_unlock(&k->lock);
    return s;
}

int kage_scene_uses_file(const kage_scene *k, const char *path) { return files_have_path(&k->first->made_from, path); }
