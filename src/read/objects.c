/* Objects: their shapes, materials, bumps and transforms, and copies of other objects. */
#include "displaced/displaced.h"
#include "read/parts.h"

#include <stdlib.h>
#include <string.h>

/* Objects are read in order, but an object is read before its copies. */
typedef struct queue {
    node **key, **at; /* of each object */
    char *state;
    names names;
} queue;

enum { WAITING, BEGUN, DONE };

static void read_object(reader *r, const queue *q, int i);

/* The object that object i copies; reads it first if need be. NULL with an error. */
static const object *read_original(reader *r, const queue *q, node *copy, int i)
{
    const scene *s = r->s;
    const char *name = yaml_text(r->y, copy, "the name of an object");
    int k = name ? names_find(&q->names, s->object, name) : -1;
    if (name && k < 0)
        reader_find(r, copy, "the name of an object", "objects", s->object, sizeof *s->object, s->objects);
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
    o->bump_of = from->bump_of ? from->bump_of : from->name;
    o->shape = from->own;
    o->centred = o->displaced = NULL;
    o->hidden = false;
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
    o->bump_of = NULL;
    o->map = (map_note){0};
    o->bump_spec = (bump_spec){0};
    r->now = at;
    o->bump = reader_bump(r, at, o);
    if (o->bump && scene_wants_truth(r->s) && !displaced_has_bounds(o->bump))
        yaml_error(r->y, at,
                   "no bounds of P or of its slope are known, expected them for %s: a function that is bounded, "
                   "without jumps, over the whole surface",
                   scene_truth_name(r->s));
}

/* Where the shape is wrong, a square stands for it, so that the bump's own errors are told with the shape's. */
static void read_bump_alone(reader *r, node *at, object *o)
{
    surface *square = reader_made(r, plane_new((vec3){0, 0, 0}, (vec3){1, 0, 0}, (vec3){0, 0, 1}, true));
    o->own = square;
    if (square)
        read_own_bump(r, at, o);
    o->own = NULL;
    surface_free(square);
}

/* Whether the object that is copied is not itself a list of copies. */
static bool is_single(reader *r, node *at, const object *from)
{
    for (int k = 0; k < r->lists; k++)
        if (&r->s->object[r->list[k].object] == from)
            return yaml_error(r->y, at, "'%s' is a list of copies, expected an object of one shape", from->name);
    return true;
}

/* The object's original under `copy`, or in a list of copies; NULL: neither. */
static node *original_at(reader *r, node *v)
{
    node *copy = yaml_get(v, "copy"), *copies = yaml_get(v, "copies");
    if (!copies)
        return copy;
    if (copy)
        yaml_error(r->y, copies, "'copies' beside 'copy', expected one of them");
    return yaml_map(r->y, copies, "copies", "of file materials") ? yaml_need(r->y, copies, "of", "copies") : NULL;
}

static void read_object(reader *r, const queue *q, int i)
{
    scene *s = r->s;
    object *o = &s->object[i];
    node *v = q->at[i], *m, *at_bump, *copy;
    int k;
    q->state[i] = BEGUN;
    r->now = v;
    o->placed = affine_identity();
    if (yaml_map(r->y, v, "an object", READER_SHAPES " material bump transform copy copies hidden")) {
        node *hidden = yaml_get(v, "hidden");
        if ((copy = original_at(r, v))) {
            const object *from = reader_no_shape(r, v) ? read_original(r, q, copy, i) : NULL;
            if (from && is_single(r, copy, from))
                take(o, from);
        } else if (!yaml_get(v, "copies"))
            o->shape = o->own = reader_shape(r, v, &o->shape_spec);
        m = copy ? yaml_get(v, "material") : yaml_need(r->y, v, "material", "an object");
        if (m && s->material) { /* without materials there is an error already */
            k = reader_material(r, m);
            o->material = k < 0 ? 0 : k;
        }
        o->color = NULL;
        if ((m || copy) && o->own && s->material)
            reader_color_texture(r, m ? m : copy, o);
        if ((at_bump = yaml_get(v, "bump")) && o->own)
            read_own_bump(r, at_bump, o);
        else if (at_bump && !copy)
            read_bump_alone(r, at_bump, o);
        if (hidden)
            yaml_bool(r->y, hidden, "true or false", &o->hidden);
        if (!yaml_get(v, "copies"))
            place(r, v, o);
        else if (o->own)
            reader_copies(r, v, i);
        if (o->shape && !o->crowd && o->bump && scene_wants_truth(s) && displaced_has_form(o->shape) &&
            !r->from->survey)
            o->displaced = reader_displaced(r, v, o);
    }
    q->state[i] = DONE;
    r->now = NULL;
}

/* Copy object i and those that its list adds to `to`, the first of which is to[at]. Returns how many. */
static int put_object(const object *from, const copies_list *list, object *to, int at)
{
    int n = at;
    to[n++] = *from;
    for (int k = 0; list && k < list->count; k++)
        to[n++] = list->more[k];
    for (int k = at; k < n; k++)
        to[k].first = to[k].crowd ? at + to[k].first : k;
    return n - at;
}

/* Number the insides of all objects and copies. */
static void number_insides(reader *r)
{
    scene *s = r->s;
    int64_t next = s->kept;
    for (int k = 0; k < s->kept; k++) {
        object *o = &s->object[k];
        o->inside = !o->crowd ? k : o->first == k ? (int32_t)next : s->object[o->first].inside;
        next += o->crowd && o->first == k ? o->crowd->n : 0;
        if (next > INT32_MAX) {
            errors_add(r->e, "%s: %lld objects and copies, expected at most %d", s->path, (long long)next, INT32_MAX);
            return;
        }
    }
}

/* Without memory for an array of all objects: free those that lists add, and leave the others in theirs. */
static void drop_added(reader *r)
{
    for (int i = 0; i < r->s->objects; i++)
        r->s->object[i].first = i;
    for (int k = 0; k < r->lists; k++)
        for (int j = 0; j < r->list[k].count; j++) {
            object *o = &r->list[k].more[j];
            if (o->first == j + 1) /* places in the list; the scene's own object has place 0 */
                surface_free(o->shape);
            color_texture_free(o->color);
            free(o->name);
        }
}

/* Put the objects that lists add behind the first of their list, and hidden objects last. */
static void arrange(reader *r)
{
    scene *s = r->s;
    const int n = s->objects;
    size_t all = (size_t)n + 1;
    for (int k = 0; k < r->lists; k++)
        all += (size_t)r->list[k].count;
    object *to = reader_made(r, malloc(sizeof *to * all));
    copies_list **list = reader_made(r, calloc((size_t)n + 1, sizeof(copies_list *)));
    if (to && list) {
        for (int k = 0; k < r->lists; k++)
            list[r->list[k].object] = &r->list[k];
        s->kept = 0;
        for (int hidden = 0; hidden < 2; hidden++) {
            for (int i = 0; i < n; i++)
                if (s->object[i].hidden == hidden)
                    s->kept += put_object(&s->object[i], list[i], to, s->kept);
            s->objects = hidden ? s->objects : s->kept;
        }
        free(s->object);
        s->object = to;
        to = NULL;
        number_insides(r);
    } else
        drop_added(r);
    for (int k = 0; k < r->lists; k++)
        free(r->list[k].more);
    free(r->list);
    free(list);
    free(to);
}

static void read_names(reader *r, queue *q)
{
    scene *s = r->s;
    for (int i = 0; i < s->objects; i++) {
        s->object[i].name = reader_plain_name(r, q->key[i]);
        if (s->object[i].name && !names_add(&q->names, s->object, i))
            reader_second(r, q->key[i], s->object[i].name);
    }
}

void reader_objects(reader *r)
{
    scene *s = r->s;
    const cap most = reader_limit(r, LIMIT_OBJECTS, SCENE_MAX_OBJECTS);
    node *at = reader_named(r, "objects", most, sizeof *s->object, &s->object, &s->objects);
    const size_t n = (size_t)s->objects + 1;
    s->kept = s->objects;
    if (!at)
        return;
    queue q = {.key = malloc(n * sizeof(node *)), .at = malloc(n * sizeof(node *)), .state = calloc(n, 1)};
    if (reader_made(r, q.key) && reader_made(r, q.at) && reader_made(r, q.state) &&
        (names_begin(&q.names, s->objects) || reader_made(r, NULL))) {
        yaml_pairs(at, q.key, q.at);
        read_names(r, &q);
        for (int i = 0; i < s->objects; i++) {
            if (!progress_show(r->from->progress, PROGRESS_OBJECTS, (double)i / s->objects)) {
                errors_add(r->e, "cancelled");
                break;
            }
            if (q.state[i] == WAITING)
                read_object(r, &q, i);
        }
    }
    free(q.key);
    free(q.at);
    free(q.state);
    names_free(&q.names);
    arrange(r);
}
