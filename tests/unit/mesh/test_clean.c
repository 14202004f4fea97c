/* What mesh_clean does to the triangles of a file: numbers, areas, normals and creases. */
#include <stdlib.h>
#include <string.h>

#include "mesh/mesh_data.h"
#include "support/check.h"

/* n times the same triangle, with z as the normal of each corner. */
static mesh_data triangles(int n)
{
    static const float corners[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh_data d = {.n = n,
                   .at = memory_new(NULL, sizeof *d.at * (size_t)n),
                   .skin = memory_zeroed(NULL, (size_t)n * sizeof *d.skin)};
    assert_non_null(d.at);
    assert_non_null(d.skin);
    for (int k = 0; k < n; k++) {
        memcpy(d.at[k], corners, sizeof corners);
        for (int i = 0; i < 3; i++)
            d.skin[k].normal[i][2] = 1;
    }
    return d;
}

static void refused(mesh_data *d, const char *expected)
{
    char why[MESH_WHY];
    assert_false(mesh_clean(d, MESH_NORMALS_FILE, 40, 1e6, 2, NULL, why));
    assert_string_equal(why, expected);
    mesh_data_free(d);
}

static void clean(mesh_data *d)
{
    char why[MESH_WHY];
    if (!mesh_clean(d, MESH_NORMALS_FILE, 40, 1e6, 2, NULL, why))
        fail_msg("%s", why);
}

static void a_vertex_that_is_no_number_is_refused(void **state)
{
    (void)state;
    mesh_data d = triangles(3);
    d.at[1][2][1] = NAN;
    refused(&d, "a vertex has the coordinate nan, expected -1e+06 to 1e+06");
}

static void a_vertex_too_far_is_refused(void **state)
{
    (void)state;
    mesh_data d = triangles(3);
    d.at[1][2][1] = 2e6f;
    refused(&d, "a vertex has the coordinate 2e+06, expected -1e+06 to 1e+06");
}

static void an_infinite_texture_coordinate_is_refused(void **state)
{
    (void)state;
    mesh_data d = triangles(3);
    d.skin[2].uv[1][0] = INFINITY;
    refused(&d, "a texture coordinate is inf, expected -1e+06 to 1e+06");
}

static void triangles_without_an_area_are_removed(void **state)
{
    (void)state;
    mesh_data d = triangles(3);
    memcpy(d.at[0][2], d.at[0][1], sizeof d.at[0][2]); /* a line */
    memset(d.at[1], 0, sizeof d.at[1]);                /* a point */
    clean(&d);
    assert_int_equal(d.n, 1);
    assert_int_equal(d.notes.flat, 2);
    CHECK(d.at[0][1][0], ==, 1);
    mesh_data_free(&d);
}

static void no_triangle_with_an_area_is_refused(void **state)
{
    (void)state;
    mesh_data d = triangles(1);
    memset(d.at[0], 0, sizeof d.at[0]);
    refused(&d, "no triangles with an area, expected at least one");
}

static void normals_are_z(const mesh_data *d, float z)
{
    for (int k = 0; k < d->n; k++)
        for (int i = 0; i < 3; i++)
            CHECK(d->skin[k].normal[i][2], ==, z);
}

static void normals_become_unit_vectors(void **state)
{
    (void)state;
    mesh_data d = triangles(1);
    for (int i = 0; i < 3; i++)
        d.skin[0].normal[i][2] = 3;
    clean(&d);
    normals_are_z(&d, 1);
    mesh_data_free(&d);
}

static void normals_that_are_no_numbers_are_replaced(void **state)
{
    (void)state;
    mesh_data d = triangles(1);
    for (int i = 0; i < 3; i++)
        d.skin[0].normal[i][0] = NAN;
    clean(&d);
    normals_are_z(&d, 1);
    mesh_data_free(&d);
}

static void normals_of_the_other_side_flip_the_triangle(void **state)
{
    (void)state;
    mesh_data d = triangles(1);
    for (int i = 0; i < 3; i++)
        d.skin[0].normal[i][2] = -3;
    d.skin[0].uv[1][0] = 0.25f;
    clean(&d);
    assert_int_equal(d.notes.turned, 1);
    normals_are_z(&d, -1);
    CHECK(d.at[0][2][0], ==, 1); /* the second and the third corner change places, with all that they have */
    CHECK(d.skin[0].uv[2][0], ==, 0.25);
    mesh_data_free(&d);
}

static void normals_that_face_away_are_replaced(void **state)
{
    (void)state;
    mesh_data d = triangles(1);
    for (int i = 0; i < 2; i++) { /* along the triangle */
        d.skin[0].normal[i][i] = 1;
        d.skin[0].normal[i][2] = 0;
    }
    clean(&d);
    assert_int_equal(d.notes.bent, 2);
    assert_int_equal(d.notes.turned, 0);
    normals_are_z(&d, 1);
    mesh_data_free(&d);
}

static void triangles_without_a_texture_are_counted(void **state)
{
    (void)state;
    mesh_data d = triangles(3);
    d.skin[1].uv[2][1] = NAN;
    clean(&d);
    assert_int_equal(d.notes.bare, 1);
    mesh_data_free(&d);
}

/* A cube's corners, of two triangles a side, without normals: below its angle of 90 degrees each side is flat, above it
 * a corner's normal is the mean of three sides, however these are cut into triangles. */
static void check_cube(double crease, bool smooth)
{
    mesh_data d = {
        .n = 12, .at = memory_new(NULL, sizeof *d.at * 12), .skin = memory_zeroed(NULL, 12 * sizeof *d.skin)};
    char why[MESH_WHY];
    for (int k = 0; k < 12; k++)
        for (int i = 0; i < 3; i++) {
            static const int square[2][3] = {{0, 1, 2}, {0, 2, 3}};
            const int axis = k / 4, high = k / 2 % 2, at = square[k % 2][i], b = at == 1 || at == 2, c = at >= 2;
            d.at[k][i][axis] = (float)(2 * high - 1);
            d.at[k][i][(axis + 1) % 3] = (float)(2 * (high ? b : c) - 1);
            d.at[k][i][(axis + 2) % 3] = (float)(2 * (high ? c : b) - 1);
        }
    assert_true(mesh_clean(&d, MESH_NORMALS_FILE, crease, 1e6, 2, NULL, why));
    for (int k = 0; k < 12; k++)
        for (int i = 0; i < 3; i++)
            for (int a = 0; a < 3; a++) {
                const double along = a == k / 4, p = (double)d.at[k][i][a];
                NEAR(d.skin[k].normal[i][a], smooth ? p / sqrt(3) : along * p, 1e-6);
            }
    mesh_data_free(&d);
}

static void a_crease_below_the_angle_keeps_edges(void **state)
{
    (void)state;
    check_cube(89, false);
}

static void a_crease_above_the_angle_smooths_them(void **state)
{
    (void)state;
    check_cube(91, true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_vertex_that_is_no_number_is_refused),
        cmocka_unit_test(a_vertex_too_far_is_refused),
        cmocka_unit_test(an_infinite_texture_coordinate_is_refused),
        cmocka_unit_test(triangles_without_an_area_are_removed),
        cmocka_unit_test(no_triangle_with_an_area_is_refused),
        cmocka_unit_test(normals_become_unit_vectors),
        cmocka_unit_test(normals_that_are_no_numbers_are_replaced),
        cmocka_unit_test(normals_of_the_other_side_flip_the_triangle),
        cmocka_unit_test(normals_that_face_away_are_replaced),
        cmocka_unit_test(triangles_without_a_texture_are_counted),
        cmocka_unit_test(a_crease_below_the_angle_keeps_edges),
        cmocka_unit_test(a_crease_above_the_angle_smooths_them),
    };
    return cmocka_run_group_tests_name("cleaning of meshes", tests, NULL, NULL);
}
