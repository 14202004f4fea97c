/* What can be asked for: the version, the methods, and what is in a scene, also as its text. */
#include "api/api.h"

#include "base/file_writer.h"
#include "yaml/yaml.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void set3(double to[3], vec3 v)
{
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
}

static kage_light_info of_light(const light *l)
{
    static const char *const kinds[] = {"point", "spot", "parallel"};
    kage_light_info x = {.name = l->name, .kind = kinds[l->kind], .fades = l->fade_distance > 0};
    set3(x.at, l->at);
    x.samples[0] = l->samples[0];
    x.samples[1] = l->samples[1];
    return x;
}

static kage_model_info of_model(const shape_spec *f)
{
    const mesh_notes *n = &f->found;
    return (kage_model_info){f->file, f->triangles, n->flat, n->turned, n->bent, n->bare, n->folded, n->spread};
}

static void note_bump(const object *o, kage_object_info *x)
{
    x->bump = o->bump->ops->kind;
    x->map = o->map.file;
    x->map_size[0] = o->map.width;
    x->map_size[1] = o->map.height;
    x->map_range[0] = o->map.low;
    x->map_range[1] = o->map.high;
    x->map_bits = o->map.bits;
    x->map_smooth = o->map.file ? o->bump_spec.layout.smooth : 0;
    x->height[0] = (double)o->bump->Pmin;
    x->height[1] = (double)o->bump->Pmax;
    x->bump_of = o->bump_of ? o->bump_of : o->name;
    x->bump_scale = o->bump_spec.function ? o->bump_spec.scale : fabs(o->bump_spec.layout.scale);
    x->bounded = o->bump->Pmax - o->bump->Pmin < REAL_FAR;
}

static kage_object_info of_object(const scene *s, const object *o, const kage_model_info *model)
{
    const material *m = &s->material[o->material];
    kage_object_info x = {
        .name = o->name,
        .shape = o->shape->ops->kind,
        .copy_of = o->copy_of,
        .transformed = o->moved,
        .material = m->name,
        .color = o->color ? o->color->ops->kind : NULL,
        .mirrors = material_mirrors(m),
        .transparent = material_clear(m),
        .model = o->shape_spec.kind == SHAPE_MESH && !o->copy_of ? model : NULL,
        .copies = o->crowd ? crowd_count(o->crowd, (int32_t)(o - s->object) - o->first) : 0,
    };
    if (o->bump)
        note_bump(o, &x);
    return x;
}

/* One allocation holds the objects, then a model for each. */
static bool note_all(const scene *s, kage_scene_info *x)
{
    const size_t lights = (size_t)s->lights, objects = (size_t)s->objects;
    kage_light_info *l = calloc(lights + 1, sizeof *l);
    kage_object_info *o = calloc(1, (objects + 1) * sizeof *o + objects * sizeof(kage_model_info));
    x->lights = l;
    x->objects = o;
    if (!l || !o)
        return false;
    kage_model_info *model = (kage_model_info *)(void *)&o[objects + 1];
    for (size_t k = 0; k < lights; k++)
        l[k] = of_light(&s->light[k]);
    for (size_t k = 0; k < objects; k++) {
        model[k] = of_model(&s->object[k].shape_spec);
        o[k] = of_object(s, &s->object[k], &model[k]);
    }
    return true;
}

static kage_camera_info of_camera(const scene *s)
{
    const bool flat = s->camera.orthographic;
    kage_camera_info x = {.fov = flat ? 0 : s->view.fov, .width = flat ? s->view.width : 0};
    set3(x.eye, s->camera.from);
    set3(x.at, s->view.at);
    set3(x.up, s->view.up);
    return x;
}

bool scene_note(kage_scene *k)
{
    const scene *s = k->first;
    char *name = malloc(METHOD_NAME_SIZE);
    char *own = malloc(BUMP_SHADOW_NAME_SIZE);
    if (name)
        method_name(s->shadow, name);
    if (own)
        bump_shadow_name(s->bump_shadow, own);
    k->info = (kage_scene_info){
        .path = s->path,
        .text = k->sets ? NULL : s->source,
        .width = s->width,
        .height = s->height,
        .aa = s->aa,
        .aa_threshold = s->aa_threshold,
        .method = name,
        .bump_shadow = own,
        .shifted = s->shifted,
        .guard = s->guard,
        .displaced = s->displaced,
        .self_shadow = s->self_shadow,
        .depth = s->sends ? s->depth : 0,
        .light_count = s->lights,
        .object_count = s->objects,
        .camera = of_camera(s),
    };
    return note_all(s, &k->info) && name && own;
}

void scene_forget(kage_scene *k)
{
    free((void *)k->info.method);
    free((void *)k->info.bump_shadow);
    free((void *)k->info.lights);
    free((void *)k->info.objects);
}

/* Made when it is asked for. */
static void note_text(kage_scene *k)
{
    if (__atomic_load_n(&k->info.text, __ATOMIC_ACQUIRE))
        return;
    pthread_mutex_lock(&k->lock);
    if (!k->info.text) {
        k->text = yaml_edited(k->first->source, k->sets, (const char *const *)k->set);
        __atomic_store_n(&k->info.text, k->text, __ATOMIC_RELEASE);
    }
    pthread_mutex_unlock(&k->lock);
}

const kage_scene_info *kage_scene_get_info(const kage_scene *k)
{
    note_text((kage_scene *)k);
    return &k->info;
}

kage_status kage_scene_write(const kage_scene *k, const char *path, kage_errors **to)
{
    const char *text = kage_scene_get_info(k)->text;
    errors e = {0};
    file_writer f;
    if (!text)
        return error_give(KAGE_NO_MEMORY, to, "out of memory");
    bool good = file_writer_open(&f, path, &e);
    if (good) {
        file_writer_write(&f, text, strlen(text), 0);
        good = file_writer_close(&f, NULL, &e);
    }
    return errors_give(&e, good ? KAGE_OK : KAGE_NOT_WRITTEN, NULL, to);
}

const char *kage_version(void) { return KAGE_VERSION; }

const char *kage_precision(void) { return REAL_NAME; }

int kage_bump_shadow_is_known(const char *name)
{
    bump_shadow b;
    return bump_shadow_parse(name, &b);
}

int kage_method_count(void) { return method_help_count; }

kage_method kage_method_get(int k)
{
    const bool is = k >= 0 && k < method_help_count;
    return (kage_method){is ? method_helps[k].name : NULL, is ? method_helps[k].text : NULL};
}

int kage_method_is_known(const char *name)
{
    method m;
    return method_parse(name, &m);
}
