/* The table of the limits that a caller may set for what a scene and its files have. The option --limit, manuals and
 * completions come from it.
 */
#include "api/api.h"

#include <math.h>

#include "base/files.h"
#include "expr/program.h"
#include "mesh/mesh_data.h"
#include "patch/patch_file.h"
#include "points/points.h"
#include "yaml/yaml.h"

typedef struct row {
    kage_limit shown;
    const char *by; /* see base/limits.h */
} row;

#define ROW(name, field, most, bytes, text)                                                                            \
    {                                                                                                                  \
        {name, text, most, bytes, offsetof(kage_limits, field)}, " (--limit " name ")"                                 \
    }

static const row rows[LIMIT_KINDS] = {
    [LIMIT_SCENE] = ROW("scene", scene, YAML_MAX_BYTES, 1, "bytes of the scene's text"),
    [LIMIT_NESTING] = ROW("nesting", nesting, YAML_MAX_NESTING, 0, "levels of maps and lists in the scene's text"),
    [LIMIT_EXPRESSION] = ROW("expression", expression, EXPR_MAX_TEXT, 1, "bytes of an expression"),
    [LIMIT_EXPRESSION_NESTING] =
        ROW("expression-nesting", expression_nesting, EXPR_MAX_DEPTH, 0, "levels of nesting of an expression"),
    [LIMIT_PICTURE] = ROW("picture", picture, SCENE_MAX_SIDE, 0, "pixels along a side of the picture"),
    [LIMIT_DEPTH] = ROW("depth", depth, SCENE_MAX_DEPTH, 0, "rays in a row, render.depth"),
    [LIMIT_OBJECTS] = ROW("objects", objects, SCENE_MAX_OBJECTS, 0, "objects"),
    [LIMIT_FILE] = ROW("file", file, FILES_MOST, 1, "bytes of a file that the scene names"),
    [LIMIT_SIDE] = ROW("side", side, IMAGE_MAX_SIDE, 0, "samples along a side of a map or an image"),
    [LIMIT_SAMPLES] = ROW("samples", samples, IMAGE_MAX_PIXELS, 0, "samples of a map or an image"),
    [LIMIT_COPIES] = ROW("copies", copies, POINTS_MOST, 0, "points of a list of copies"),
    [LIMIT_TRIANGLES] = ROW("triangles", triangles, MESH_MOST, 0, "triangles of a model"),
    [LIMIT_PATCHES] = ROW("patches", patches, PATCHES_MAX, 0, "patches of an object"),
};

int kage_limit_count(void) { return LIMIT_KINDS; }

kage_limit kage_limit_get(int k)
{
    return k >= 0 && k < LIMIT_KINDS ? rows[k].shown : (kage_limit){NULL, NULL, 0, 0, 0};
}

static int64_t value_of(const kage_limits *l, int k)
{
    return *(const int64_t *)((const char *)l + rows[k].shown.offset);
}

bool limits_are_good(const kage_limits *l, errors *e)
{
    for (int k = 0; l && k < LIMIT_KINDS; k++) {
        const kage_limit *of = &rows[k].shown;
        const int64_t n = value_of(l, k);
        if (n < 0 || n > of->most)
            return errors_add(e, "a limit of %lld for '%s', %s; expected 1 to %lld, the built-in one, or 0 for that",
                              (long long)n, of->name, of->text, (long long)of->most);
    }
    return !l || (l->seconds >= 0 && l->seconds < HUGE_VAL) ||
           errors_add(e, "a limit of %g seconds, expected a number above 0, or 0 for none", l->seconds);
}

void limits_take(limits *to, const kage_limits *l)
{
    for (int k = 0; l && k < LIMIT_KINDS; k++)
        if (value_of(l, k) > 0)
            to->of[k] = (cap){value_of(l, k), rows[k].by};
}

bool limits_are_tighter(const limits *before, const limits *now)
{
    for (limit_kind k = 0; k < LIMIT_KINDS; k++) {
        const int64_t most = rows[k].shown.most;
        if (limit_of(now, k, most).most < limit_of(before, k, most).most)
            return true;
    }
    return false;
}

int64_t limits_memory(const kage_limits *l)
{
    const int64_t asked = l ? l->memory : 0;
    return asked > 0 ? asked : asked < 0 ? 0 : memory_default();
}
