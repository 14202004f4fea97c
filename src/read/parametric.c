/* Surfaces without closed forms: three functions of u and w, and Bezier patches. */
#include "read/parts.h"

#include "base/files.h"

#include "patch/patch_file.h"
#include "patch/surface.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An end of a range: a number, or an expression without u and w, such as 2*pi, so that the surface can close
 * exactly. */
static bool read_end(reader *r, node *at, double *x)
{
    const double u[2] = {0.3, 0.7}, w[2] = {0.6, 0.2};
    expr_jets z;
    expr *e = reader_expr(r, at, "an end of the range, a number or such as 2*pi");
    if (!e)
        return false;
    expr_eval(e, 2, u, w, 0, &z);
    expr_free(e);
    *x = z.v[0];
    if (isnan(z.v[0]) && isnan(z.v[1]))
        return yaml_error(r->y, at, "an end of a range without a value, expected -1000000 to 1000000");
    if (z.v[0] != z.v[1])
        return yaml_error(r->y, at, "an end of a range with u or w in it, expected a number or such as 2*pi");
    if (!(fabs(*x) <= BIG))
        return yaml_error(r->y, at, "the range ends at %g, expected -1000000 to 1000000", *x);
    return true;
}

static bool read_range(reader *r, node *at, const char *key, double x[2])
{
    static const char expected[] = "the range [from, to]";
    node *v = yaml_need(r->y, at, key, "parametric");
    const int n = v ? yaml_list(r->y, v, expected) : -1;
    if (n >= 0 && n != 2)
        return yaml_error(r->y, v, "%d value%s, expected %s", n, n == 1 ? "" : "s", expected);
    bool good = n == 2 && read_end(r, yaml_item(v, 0), &x[0]);
    good = n == 2 && read_end(r, yaml_item(v, 1), &x[1]) && good;
    if (good && !(x[1] - x[0] >= SMALL))
        return yaml_error(r->y, v, "a range from %g to %g, expected the second end above the first", x[0], x[1]);
    return good;
}

/* The patch as a surface, which owns the patch and is kept under the key. NULL with an error: `what` if the patch has
 * no bounds or no size. */
static surface *search(reader *r, node *at, patch *q, const char *what, const char *key)
{
    if (q)
        q->threads = r->from->threads;
    bool bounded = true;
    surface *f = q ? patch_surface_new_bounded(q, r->from->progress, &bounded) : NULL;
    if (!bounded)
        yaml_error(r->y, at, "%s", what);
    else if (!f)
        reader_made(r, NULL);
    return reader_keep_surface(r, key, f);
}

static char *key_of_functions(reader *r, node *at, const double u[2], const double w[2])
{
    const char *x = yaml_text(r->y, yaml_get(at, "x"), "x"), *y = yaml_text(r->y, yaml_get(at, "y"), "y"),
               *z = yaml_text(r->y, yaml_get(at, "z"), "z");
    return x && y && z
               ? reader_key(r, "parametric %.17g %.17g %.17g %.17g\n%s\n%s\n%s", u[0], u[1], w[0], w[1], x, y, z)
               : NULL;
}

/* All bits of the control points. */
static char *key_of_points(reader *r, int patches, const vec3 *point)
{
    enum { DIGITS = 16, COORDINATES = 48 };
    const size_t n = (size_t)patches * COORDINATES;
    const double *x = &point->x;
    char *key = reader_made(r, malloc(sizeof "patches" + n * DIGITS));
    char *at = key ? key + sprintf(key, "patches") : NULL;
    for (size_t k = 0; key && k < n; k++) {
        unsigned long long bits;
        memcpy(&bits, x + k, sizeof bits);
        at += sprintf(at, "%016llx", bits);
    }
    return key;
}

surface *reader_parametric(reader *r, node *at, shape_spec *spec)
{
    static const char *const keys[] = {"x", "y", "z"};
    expr *e[3] = {NULL, NULL, NULL};
    double u[2] = {0, 1}, w[2] = {0, 1};
    if (!yaml_map(r->y, at, "parametric", "x y z u w"))
        return NULL;
    bool good = true;
    for (int k = 0; k < 3; k++) {
        node *v = yaml_need(r->y, at, keys[k], "parametric");
        e[k] = v ? reader_expr(r, v, "a function of u and w") : NULL;
        good = e[k] && good;
    }
    good = read_range(r, at, "u", u) && good;
    good = read_range(r, at, "w", w) && good;
    *spec = (shape_spec){.kind = SHAPE_PATCH};
    if (!good) {
        for (int k = 0; k < 3; k++)
            expr_free(e[k]);
        return NULL;
    }
    char *key = key_of_functions(r, at, u, w);
    surface *f = reader_found_surface(r, key);
    for (int k = 0; f && k < 3; k++)
        expr_free(e[k]);
    if (!f)
        f = search(r, at, patch_function_new("parametric", e, u, w),
                   "the surface has no bounds, or is all in one place; expected x, y and z that are finite, and not "
                   "all constant, over the range of u and w",
                   key);
    free(key);
    return f;
}

/* ---- patches ---- */

/* The 16 control points of a patch. */
static bool read_patch(reader *r, node *at, vec3 p[16])
{
    static const char expected[] = "a patch: a list of 16 control points [x, y, z]";
    const int n = yaml_list(r->y, at, expected);
    if (n < 0)
        return false;
    if (n != 16)
        return yaml_error(r->y, at, "%d point%s, expected %s", n, n == 1 ? "" : "s", expected);
    bool good = true;
    for (int k = 0; k < 16; k++) {
        double v[3] = {0, 0, 0};
        good = yaml_numbers(r->y, yaml_item(at, k), 3, -BIG, BIG, "a control point [x, y, z]", v) && good;
        p[k] = (vec3){v[0], v[1], v[2]};
    }
    return good;
}

static vec3 *read_points(reader *r, node *at, int *patches)
{
    static const char expected[] = "a list of patches, each of 16 control points [x, y, z]";
    *patches = yaml_list(r->y, at, expected);
    if (*patches < 0)
        return NULL;
    const cap most = reader_limit(r, LIMIT_PATCHES, PATCHES_MAX);
    if (*patches < 1 || *patches > most.most) {
        yaml_error(r->y, at, "%d patches, expected 1 to %d%s", *patches, (int)most.most, most.by);
        return NULL;
    }
    vec3 *point = reader_made(r, malloc(sizeof *point * 16 * (size_t)*patches));
    bool good = point;
    for (int k = 0; point && k < *patches; k++)
        good = read_patch(r, yaml_item(at, k), point + 16 * k) && good;
    if (!good) {
        free(point);
        return NULL;
    }
    return point;
}

static vec3 *read_file(reader *r, node *at, int *patches)
{
    const char *name = yaml_text(r->y, at, "the file of the patches");
    char *path = name ? reader_input(r, at, name) : NULL;
    vec3 *point = NULL;
    const char *why = NULL;
    FILE *there = path ? files_open_input(path, &why) : NULL;
    if (there) {
        fclose(there);
        point = patch_file_read(path, path, BIG, reader_limit(r, LIMIT_PATCHES, PATCHES_MAX), patches, r->e);
    } else if (path)
        yaml_error(r->y, at, "'%s' can't be used: %s", name, why);
    free(path);
    return point;
}

surface *reader_patches(reader *r, node *at, shape_spec *spec)
{
    if (!yaml_map(r->y, at, "patches", "file points"))
        return NULL;
    node *file = yaml_get(at, "file");
    int n = 0;
    if (!reader_either(r, at, "patches", "file", "points"))
        return NULL;
    *spec = (shape_spec){.kind = SHAPE_PATCH};
    vec3 *point = file ? read_file(r, file, &n) : read_points(r, yaml_get(at, "points"), &n);
    if (!point)
        return NULL;
    char *key = key_of_points(r, n, point);
    surface *f = reader_found_surface(r, key);
    if (!f)
        f = search(r, at, patch_bezier_new(n, point), "the patches are all in one place, expected points that differ",
                   key);
    free(point);
    free(key);
    return f;
}
