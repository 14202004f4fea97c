/* Lists of copies of an object: places, sizes, turns and materials from a file, as crowds. The opaque materials share a
 * crowd; each transparent one has its own, as its shadows are followed through all copies.
 */
#include "base/threads.h"
#include "points/points.h"
#include "read/parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The largest ratio of the scales of two directions, as in place.c. */
#define STRETCH 1e4

enum { X, Y, Z, SCALE, SX, SY, SZ, TURN, RX, RY, RZ, COLUMNS };

#define PLACES -BIG, BIG, true, "a coordinate from -1e6 to 1e6"
#define SCALES SMALL, BIG, false, "a factor from 1e-6 to 1e6"
#define ANGLES -BIG, BIG, false, "an angle from -1e6 to 1e6 degrees"
static const points_column columns[COLUMNS + 1] = {
    [X] = {"x", PLACES},   [Y] = {"y", PLACES},   [Z] = {"z", PLACES},   [SCALE] = {"scale", SCALES},
    [SX] = {"sx", SCALES}, [SY] = {"sy", SCALES}, [SZ] = {"sz", SCALES}, [TURN] = {"turn", ANGLES},
    [RX] = {"rx", ANGLES}, [RY] = {"ry", ANGLES}, [RZ] = {"rz", ANGLES}, [COLUMNS] = {.name = NULL},
};

/* The rows of the file, and the copies made of some of them. */
typedef struct rows {
    points p;
    const char *name;                           /* of the file */
    affine centre;                              /* from the original's space to its place before its own transform */
    affine placed;                              /* its transform */
    affine after;                               /* the list's */
    int32_t *row;                               /* of each copy */
    int materials, material[POINTS_LABELS + 1]; /* of the list */
    int of_label[POINTS_LABELS];                /* the list's material for each label */
    int kind[POINTS_LABELS + 1];                /* of each material in its crowd */
} rows;

static double value(const rows *k, int column, int32_t row, double otherwise)
{
    return k->p.v[column] ? k->p.v[column][row] : otherwise;
}

/* The place of a material in the list's. */
static int material_of(const rows *k, int32_t row)
{
    return k->p.label && k->p.label[row] >= 0 ? k->of_label[k->p.label[row]] : 0;
}

/* As the steps scale, rotate and translate of a transform. */
static affine map_of(const rows *k, int32_t row)
{
    const double all = value(k, SCALE, row, 1);
    const affine size = {
        {value(k, SX, row, all), 0, 0}, {0, value(k, SY, row, all), 0}, {0, 0, value(k, SZ, row, all)}, {0, 0, 0}};
    const double degrees[3] = {value(k, RX, row, 0), value(k, RY, row, value(k, TURN, row, 0)), value(k, RZ, row, 0)};
    affine m = affine_then(&k->placed, &size), step = affine_identity();
    if (degrees[0] != 0 || degrees[1] != 0 || degrees[2] != 0) {
        step = reader_rotation(degrees);
        m = affine_then(&m, &step);
        step = affine_identity();
    }
    step.o = (vec3){k->p.v[X][row], k->p.v[Y][row], k->p.v[Z][row]};
    m = affine_then(&m, &step);
    m = affine_then(&m, &k->after);
    return affine_then(&k->centre, &m);
}

static affine copy_of(const void *user, int32_t i, int32_t *kind)
{
    const rows *k = user;
    *kind = k->kind[material_of(k, k->row[i])];
    return map_of(k, k->row[i]);
}

/* ---- the file ---- */

static bool one_of(reader *r, const rows *k, int a, const int b[3])
{
    for (int j = 0; j < 3; j++)
        if (k->p.v[a] && k->p.v[b[j]])
            return errors_add(r->e, "%s: columns '%s' and '%s', expected one of them", k->name, columns[a].name,
                              columns[b[j]].name);
    return true;
}

/* The materials of the labels: names, or with a list of `materials` numbers of these from 0 on. False with an error. */
static bool find_materials(reader *r, node *list, const object *o, rows *k)
{
    const int n = list ? yaml_list(r->y, list, "a list of names of materials") : 0, before = r->e->count;
    int number[POINTS_LABELS];
    if (list && n == 0)
        return yaml_error(r->y, list, "an empty list, expected names of materials");
    if (n < 0 || n > POINTS_LABELS)
        return n < 0 || yaml_error(r->y, list, "%d materials, expected at most %d", n, POINTS_LABELS);
    for (int j = 0; j < n; j++)
        number[j] = reader_material(r, yaml_item(list, j));
    k->material[0] = o->material;
    k->materials = 1;
    for (int j = 0; j < k->p.labels && r->e->count == before; j++) {
        char *end, message[256];
        const long at = strtol(k->p.name[j], &end, 10);
        int m = -1;
        if (list && !*end && at >= 0 && at < n)
            m = number[at];
        for (int i = 0; !list && m < 0 && i < r->s->materials; i++)
            m = r->s->material[i].name && strcmp(r->s->material[i].name, k->p.name[j]) == 0 ? i : -1;
        if (m < 0) {
            if (list)
                snprintf(message, sizeof message, "'%s' is no number of a material, expected 0 to %d", k->p.name[j],
                         n - 1);
            else
                snprintf(message, sizeof message, "no material '%s', expected one of those under 'materials'",
                         k->p.name[j]);
            points_error(&k->p, k->name, k->p.first[j], message, r->e);
        }
        k->of_label[j] = k->materials;
        k->material[k->materials++] = m;
    }
    return r->e->count == before;
}

static bool read_file(reader *r, node *at, const object *o, rows *k)
{
    static const int sizes[3] = {SX, SY, SZ}, turns[3] = {RX, RY, RZ};
    node *file = yaml_need(r->y, at, "file", "copies");
    k->name = file ? yaml_text(r->y, file, "a CSV or PLY file") : NULL;
    char *path = k->name ? reader_input(r, file, k->name) : NULL;
    const bool good = path && points_read(path, k->name, columns, "material", r->from->progress, &k->p, r->e);
    free(path);
    return good && one_of(r, k, SCALE, sizes) && one_of(r, k, TURN, turns) &&
           find_materials(r, yaml_get(at, "materials"), o, k);
}

/* ---- the copies ---- */

static double square(const affine *m) { return vec3_dot(m->x, m->x) + vec3_dot(m->y, m->y) + vec3_dot(m->z, m->z); }

/* What is wrong with a copy's place or size; "": nothing. */
static void check(const affine *m, double size, char message[256])
{
    const affine back = affine_back(m);
    const double far = fmax(fabs(m->o.x), fmax(fabs(m->o.y), fabs(m->o.z)));
    const double longest = size * fmax(vec3_length(m->x), fmax(vec3_length(m->y), vec3_length(m->z)));
    *message = 0;
    if (!(far <= BIG))
        snprintf(message, 256, "a coordinate of %.7g scene units after all transforms, expected at most 1000000", far);
    else if (!(longest >= SMALL && longest <= BIG))
        snprintf(message, 256, "a size of %.4g scene units after all transforms, expected 1e-6 to 1e6", longest);
    else if (!(square(m) * square(&back) <= STRETCH * STRETCH))
        snprintf(message, 256, "one direction is scaled more than %g times as much as another, expected less", STRETCH);
}

/* Report the first row whose copy has no good place or size. */
static bool check_rows(reader *r, const surface *from, const rows *k)
{
    double lo[3], hi[3], size = 0;
    char message[256];
    int32_t bad = k->p.n;
    const int threads = threads_of(r->from->threads);
    (void)threads; /* without OpenMP */
    from->ops->box(from, lo, hi);
    for (int a = 0; a < 3; a++)
        size = fmax(size, hi[a] - lo[a]);
#pragma omp parallel for num_threads(threads) reduction(min : bad) private(message)
    for (int32_t row = 0; row < k->p.n; row++) {
        const affine m = map_of(k, row);
        check(&m, size, message);
        bad = *message && row < bad ? row : bad;
    }
    if (bad == k->p.n)
        return true;
    const affine m = map_of(k, bad);
    check(&m, size, message);
    return points_error(&k->p, k->name, bad, message, r->e);
}

/* The surface that the copies are of, and where it is. */
static const surface *original_of(reader *r, object *o, affine *centre)
{
    form_fault fault;
    *centre = affine_identity();
    if (o->shape_spec.kind != SHAPE_CLOSED)
        return o->own;
    const shape_values values = shape_centred(o->shape_spec.form, &o->shape_spec.values, &centre->o);
    return o->centred = reader_made(r, o->shape_spec.form->make(&values, &fault));
}

/* An object for the copies of some materials: `first` itself, or one more. NULL: out of memory. */
static object *add_object(reader *r, int i, int of)
{
    scene *s = r->s;
    copies_list *c = &r->list[r->lists - 1];
    object *o = &s->object[i];
    if (c->used) {
        object *more = realloc(c->more, sizeof *more * (size_t)(c->count + 1));
        if (!reader_made(r, more))
            return NULL;
        c->more = more;
        o = &more[c->count++];
        *o = s->object[i];
        o->name = reader_copy(r, s->object[i].name);
        o->copy_of = s->object[i].copy_of;
        o->shares_bump = true;
        o->centred = o->displaced = NULL;
    }
    c->used = true;
    o->color = NULL;
    o->material = of;
    return o;
}

/* One crowd of the copies whose material is in[]. */
static void make_crowd(reader *r, node *at, int i, const surface *from, const bool *in, rows *k)
{
    crowd_list list = {0, 0, copy_of, k};
    const shape_spec *spec = &r->s->object[i].shape_spec;
    const int32_t parts = spec->kind == SHAPE_MESH ? spec->triangles : from->ops->parts;
    int of[POINTS_LABELS + 1];
    for (int j = 0; j < k->materials; j++)
        if (in[j]) {
            k->kind[j] = list.kinds;
            of[list.kinds++] = k->material[j];
        }
    for (int32_t row = 0; row < k->p.n; row++) {
        k->row[list.n] = row;
        list.n += in[material_of(k, row)];
    }
    if (list.n == 0)
        return;
    if (list.n > crowd_most(parts)) {
        yaml_error(r->y, at, "%d copies of a surface of %d parts, expected at most %d copies", (int)list.n, (int)parts,
                   (int)crowd_most(parts));
        return;
    }
    progress_show(r->from->progress, "building", 0);
    crowd *f = reader_made(r, crowd_new(from, parts, &list, r->from->threads, r->from->progress));
    int first = -1;
    for (int j = 0; f && j < list.kinds; j++) {
        const int before = r->list[r->lists - 1].used ? r->list[r->lists - 1].count : -1;
        object *o = add_object(r, i, of[j]);
        if (!o) {
            if (j == 0)
                surface_free(&f->base);
            break;
        }
        first = j ? first : before + 1;
        o->crowd = f;
        o->shape = &f->base;
        o->first = first; /* a place in the list, until all objects have theirs */
        reader_color_texture(r, at, o);
    }
}

/* Crowds for the materials of the copies. */
static void make_crowds(reader *r, node *at, int i, const surface *from, rows *k)
{
    bool in[POINTS_LABELS + 1] = {false}, used[POINTS_LABELS + 1] = {false};
    for (int32_t row = 0; row < k->p.n; row++)
        used[material_of(k, row)] = true;
    for (int j = 0; j < k->materials; j++)
        in[j] = used[j] && !material_clear(&r->s->material[k->material[j]]);
    make_crowd(r, at, i, from, in, k);
    for (int j = 0; j < k->materials; j++)
        if (used[j] && !in[j]) {
            bool alone[POINTS_LABELS + 1] = {false};
            alone[j] = true;
            make_crowd(r, at, i, from, alone, k);
        }
}

static bool can_be_copied(reader *r, node *at, const object *o, const surface *from)
{
    double lo[3], hi[3];
    from->ops->box(from, lo, hi);
    if (!(hi[0] - lo[0] < HUGE_VAL && hi[1] - lo[1] < HUGE_VAL && hi[2] - lo[2] < HUGE_VAL))
        return yaml_error(r->y, at, "a %s has no end, expected copies of an object that has one", from->ops->kind);
    if (o->bump && scene_wants_truth(r->s))
        return yaml_error(r->y, at,
                          "a list of copies with a bump can't be displaced, expected objects with 'copy' for %s",
                          scene_truth_name(r->s));
    return true;
}

void reader_copies(reader *r, node *v, int i)
{
    object *o = &r->s->object[i];
    node *at = yaml_get(v, "copies"), *transform = yaml_get(v, "transform");
    rows k = {.placed = o->moved ? o->placed : affine_identity(), .after = affine_identity()};
    copies_list *lists = realloc(r->list, sizeof *lists * (size_t)(r->lists + 1));
    if (!reader_made(r, lists))
        return;
    r->list = lists;
    r->list[r->lists++] = (copies_list){.object = i};
    const surface *from = original_of(r, o, &k.centre);
    bool good = from && can_be_copied(r, at, o, from);
    good = (!transform || reader_transform(r, transform, &k.after)) && good;
    good = read_file(r, at, o, &k) && good && check_rows(r, from, &k);
    good = good && r->s->material; /* without materials there is an error already */
    if (good && (k.row = reader_made(r, memory_new(reader_memory(r), sizeof *k.row * (size_t)k.p.n))))
        make_crowds(r, at, i, from, &k);
    memory_free(k.row);
    points_free(&k.p);
}
