/* Objects: their shapes, materials, bumps and transforms, and copies of other objects. */
#include "base/spelling.h"
#include "displaced/displaced.h"
#include "read/parts.h"

#include <stdlib.h>
#include <string.h>

/* The name of thing i: each is a struct of `size` bytes that begins with its name, or NULL. */
static const char *name_of(const void *things, size_t size, int i)
{
    return *(char *const *)(const void *)((const char *)things + (size_t)i * size);
}

/* The index of the thing that the node names. `what`: "the name of a material"; `among`: the key of the things. -1 with
 * an error. */
static int find(reader *r, node *at, const char *what, const char *among, const void *things, size_t size, int n)
{
    const char *name = yaml_text(r->y, at, what), *thing = strrchr(what, ' ') + 1;
    char near[64], *names;
    size_t length = 1;
    if (!name)
        return -1;
    for (int i = 0; i < n; i++) {
        const char *its = name_of(things, size, i);
        if (its && strcmp(name, its) == 0)
            return i;
        length += its ? strlen(its) + 1 : 0;
    }
    if ((names = calloc(1, length)))
        for (int i = 0; i < n; i++)
            if (name_of(things, size, i))
                strcat(strcat(names, *names ? " " : ""), name_of(things, size, i));
    spelling_nearest(name, names ? names : "", near, sizeof near);
    yaml_error(r->y, at, "no %s '%.60s'%s%s%s%s", thing, name,
               *near ? ", did you mean '" : ", expected one of those under '", *near ? near : among, "'",
               *near ? "?" : "");
    free(names);
    return -1;
}

/* Objects are read in order, but an object is read before its copies. */
typedef struct queue {
    node *at;
    char *state; /* of each object */
} queue;

enum { WAITING, BEGUN, DONE };

static void read_object(reader *r, const queue *q, int i);

/* The object that object i copies; reads it first if need be. NULL with an error. */
static const object *read_original(reader *r, const queue *q, node *copy, int i)
{
    const scene *s = r->s;
    const int k = find(r, copy, "the name of an object", "objects", s->object, sizeof *s->object, s->objects);
    if (k == i)
        yaml_error(r->y, copy, "'%s' copies itself, expected another object", s->object[i].name);
    else if (k >= 0 && q->state[k] == BEGUN)
        yaml_error(r->y, copy, "'%s' is itself a copy of this object, expected one that is not", s->object[k].name);
    if (k < 0 || q->state[k] == BEGUN)
        return NULL;
    if (q->state[k] == WAITING)
        read_object(r, q, k);
    return &s->object[k];
}

/* Copy shape, material and bump of another object. The copy's own keys later replace them. */
static void take(object *o, const object *from)
{
    char *name = o->name;
    *o = *from;
    o->name = name;
    o->copy_of = from->copy_of ? from->copy_of : from->name;
    o->shape = from->own;
    o->centred = o->displaced = NULL;
    o->shares_bump = true;
}

/* Make another surface than the object's own if a transform or true displacement needs one. */
static void place(reader *r, node *v, object *o)
{
    node *transform = yaml_get(v, "transform"), *copy = yaml_get(v, "copy");
    if (transform) {
        if (!reader_transform(r, transform, &o->placed))
            return;
        o->moved = true;
    }
    const bool truth = o->bump && scene_wants_truth(r->s);
    if (o->own && (o->moved || (truth && !displaced_has_form(o->own))))
        reader_place(r, transform ? transform : copy ? copy : v, o);
}

static void read_own_bump(reader *r, node *at, object *o)
{
    o->shares_bump = false;
    o->map = (map_note){0};
    o->bump_spec = (bump_spec){0};
    o->bump = reader_bump(r, at, o);
    if (o->bump && scene_wants_truth(r->s) && !displaced_has_bounds(o->bump))
        yaml_error(r->y, at,
                   "no bounds of P or of its slope are known, expected them for %s: a function that is bounded, "
                   "without jumps, over the whole surface",
                   scene_truth_name(r->s));
}

static void read_object(reader *r, const queue *q, int i)
{
    scene *s = r->s;
    object *o = &s->object[i];
    node *key, *v = yaml_pair(q->at, i, &key), *m, *at_bump, *copy;
    int k;
    q->state[i] = BEGUN;
    o->placed = affine_identity();
    if (yaml_map(r->y, v, "an object", READER_SHAPES " material bump transform copy")) {
        if ((copy = yaml_get(v, "copy"))) {
            const object *from = reader_no_shape(r, v) ? read_original(r, q, copy, i) : NULL;
            if (from)
                take(o, from);
        } else
            o->shape = o->own = reader_shape(r, v, &o->shape_spec);
        m = copy ? yaml_get(v, "material") : yaml_need(r->y, v, "material", "an object");
        if (m && s->material) { /* without materials there is an error already */
            k = find(r, m, "the name of a material", "materials", s->material, sizeof *s->material, s->materials);
            o->material = k < 0 ? 0 : k;
        }
        o->color = NULL;
        if ((m || copy) && o->own && s->material)
            reader_color_texture(r, m ? m : copy, o);
        if ((at_bump = yaml_get(v, "bump")) && o->own)
            read_own_bump(r, at_bump, o);
        place(r, v, o);
        if (o->shape && o->bump && scene_wants_truth(s) && displaced_has_form(o->shape))
            o->displaced = reader_made(r, displaced_new(o->shape, o->bump));
    }
    q->state[i] = DONE;
}

void reader_objects(reader *r)
{
    scene *s = r->s;
    queue q = {reader_named(r, "objects", sizeof *s->object, &s->object, &s->objects), NULL};
    node *key;
    if (!q.at)
        return;
    if (!(q.state = reader_made(r, calloc((size_t)s->objects + 1, 1))))
        return;
    for (int i = 0; i < s->objects; i++) {
        yaml_pair(q.at, i, &key);
        s->object[i].name = reader_name(r, q.at, key);
    }
    for (int i = 0; i < s->objects; i++) {
        if (!progress_show(r->from->progress, PROGRESS_OBJECTS, (double)i / s->objects)) {
            errors_add(r->e, "cancelled");
            break;
        }
        if (q.state[i] == WAITING)
            read_object(r, &q, i);
    }
    free(q.state);
}
