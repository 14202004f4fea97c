/* Tables: which sample stands where, in which cell a place is, and bilinear look-up. */
#include "texture/table.h"

#include "support/check.h"
#include "support/random_in.h"

enum { WIDTH = 5, HEIGHT = 3 };

static map_layout layout(map_wrap wrap, bool corners)
{
    return (map_layout){.size = {2, 3}, .offset = {0.25, -0.5}, .wrap = wrap, .corners = corners, .scale = 1};
}

static void check_samples(map_wrap wrap, bool corners, int first, const char *expected)
{
    const map_layout l = layout(wrap, corners);
    for (int k = 0; expected[k]; k++) {
        const int i = first + k;
        if (table_sample(i, 4, &l) != expected[k] - '0')
            fail_msg("sample %d of 4 is %d, expected %c", i, table_sample(i, 4, &l), expected[k]);
    }
}

static void repeated_cells(void **state)
{
    (void)state;
    check_samples(MAP_REPEAT, false, -5, "3012301230123");
}

static void repeated_corners_share_the_last_sample(void **state)
{
    (void)state;
    check_samples(MAP_REPEAT, true, -4, "201201201201");
}

static void mirrored_cells_double_the_edge(void **state)
{
    (void)state;
    check_samples(MAP_MIRROR, false, -5, "33210012332100123");
    check_samples(MAP_MIRROR, false, -4, "3210");
}

static void mirrored_corners_do_not(void **state)
{
    (void)state;
    check_samples(MAP_MIRROR, true, -4, "2321012321012");
}

static void clamped(void **state)
{
    (void)state;
    check_samples(MAP_CLAMP, false, -3, "0000123333");
    check_samples(MAP_CLAMP, true, -3, "0000123333");
}

/* Each sample is a value of its own: 100 row + column. */
static real values[(2 * HEIGHT + 1) * (2 * WIDTH + 1) * TABLE_VALUES];

static table_grid grid_of(map_wrap wrap, bool corners)
{
    const map_layout l = layout(wrap, corners);
    table_grid g;
    assert_true(table_lay(&g, WIDTH, HEIGHT, &l));
    for (int j = 0; j <= g.rows; j++)
        for (int i = 0; i <= g.columns; i++)
            for (int k = 0; k < TABLE_VALUES; k++)
                values[(j * (g.columns + 1) + i) * TABLE_VALUES + k] =
                    (real)((k + 1) * (100 * table_sample(j, HEIGHT, &l) + table_sample(i, WIDTH, &l)));
    return g;
}

static double look_up(const table_grid *g, double u, double w)
{
    const real x = (real)u, y = (real)w;
    int32_t at;
    real a, b, out, second, third;
    table_cells(g, g->columns + 1, 1, &x, &y, &at, &a, &b);
    table_three(g, values, 1, &at, &a, &b, &out, &second, &third);
    return (double)out;
}

static void periods(void **state)
{
    (void)state;
    const struct {
        map_wrap wrap;
        bool corners;
        int columns, rows;
    } want[] = {{MAP_REPEAT, false, 5, 3}, {MAP_REPEAT, true, 4, 2},   {MAP_CLAMP, false, 4, 2},
                {MAP_CLAMP, true, 4, 2},   {MAP_MIRROR, false, 10, 6}, {MAP_MIRROR, true, 8, 4}};
    for (int k = 0; k < 6; k++) {
        const table_grid g = grid_of(want[k].wrap, want[k].corners);
        CHECK(g.columns, ==, want[k].columns);
        CHECK(g.rows, ==, want[k].rows);
    }
}

/* With corners, sample (i,j) is at offset + (i,j) size/(n - 1). */
static void corners_are_at_the_edges(void **state)
{
    (void)state;
    const table_grid g = grid_of(MAP_CLAMP, true);
    for (int j = 0; j < HEIGHT; j++)
        for (int i = 0; i < WIDTH; i++)
            NEAR(look_up(&g, 0.25 + i * 2 / 4., -0.5 + j * 3 / 2.), 100 * j + i, 400 * EPS);
}

/* Otherwise it is in the middle of its cell. */
static void cells_have_their_sample_in_the_middle(void **state)
{
    (void)state;
    const table_grid g = grid_of(MAP_REPEAT, false);
    for (int j = 0; j < HEIGHT; j++)
        for (int i = 0; i < WIDTH; i++)
            NEAR(look_up(&g, 0.25 + (i + 0.5) * 2 / 5., -0.5 + (j + 0.5)), 100 * j + i, 800 * EPS);
}

static void bilinear_between_samples(void **state)
{
    (void)state;
    const table_grid g = grid_of(MAP_CLAMP, true);
    for (int k = 0; k < 200; k++) {
        const double x = random_in(0, 4), y = random_in(0, 2);
        NEAR(look_up(&g, 0.25 + x / 2, -0.5 + 1.5 * y), 100 * y + x, 1000 * EPS); /* the values are linear */
    }
}

static void repeats_after_its_size(void **state)
{
    (void)state;
    const table_grid g = grid_of(MAP_REPEAT, false);
    for (int k = 0; k < 200; k++) {
        const double u = random_in(-1, 1), w = random_in(-1, 1);
        NEAR(look_up(&g, u + 2, w - 3), look_up(&g, u, w), 4000 * EPS);
    }
}

static void mirrors_at_its_edges(void **state)
{
    (void)state;
    for (int corners = 0; corners < 2; corners++) {
        const table_grid g = grid_of(MAP_MIRROR, corners);
        for (int k = 0; k < 200; k++) {
            const double u = random_in(0, 2), w = random_in(0, 3);
            NEAR(look_up(&g, 0.25 - u, -0.5 + w), look_up(&g, 0.25 + u, -0.5 + w), 4000 * EPS);
            NEAR(look_up(&g, 0.25 + u, -0.5 + 3 + w), look_up(&g, 0.25 + u, -0.5 + 3 - w), 4000 * EPS);
        }
    }
}

static void clamps_beyond_its_edges(void **state)
{
    (void)state;
    const table_grid g = grid_of(MAP_CLAMP, true);
    CHECK(look_up(&g, -50, -50), ==, 0);
    CHECK(look_up(&g, 50, -50), ==, 4);
    CHECK(look_up(&g, 50, 50), ==, 204);
}

/* Whatever the coordinates are, the cell is one of the table. */
static void odd_coordinates_stay_in_the_table(void **state)
{
    (void)state;
    const real odd[] = {(real)NAN, (real)INFINITY, (real)-INFINITY, R(1e30), R(-1e30), R(3e9), R(-0.0)};
    enum { ODD = sizeof odd / sizeof *odd };
    for (int wrap = MAP_REPEAT; wrap <= MAP_MIRROR; wrap++) {
        const table_grid g = grid_of((map_wrap)wrap, false);
        for (int i = 0; i < ODD; i++)
            for (int j = 0; j < ODD; j++) {
                int32_t at;
                real a, b;
                table_cells(&g, g.columns + 1, 1, &odd[i], &odd[j], &at, &a, &b);
                BETWEEN(0, at, (g.rows - 1) * (g.columns + 1) + g.columns - 1);
                BETWEEN(0, a, 1);
                BETWEEN(0, b, 1);
            }
    }
}

/* A wave gives the bits of one place at a time; the second and the third value are looked up as the first. */
static void three_values_as_one(void **state)
{
    (void)state;
    const table_grid g = grid_of(MAP_REPEAT, false);
    real u[LANES], w[LANES], a[LANES], b[LANES], x[LANES], y[LANES], z[LANES];
    int32_t at[LANES];
    for (int i = 0; i < LANES; i++) {
        u[i] = (real)random_in(-9, 9);
        w[i] = (real)random_in(-9, 9);
    }
    table_cells(&g, g.columns + 1, LANES, u, w, at, a, b);
    table_three(&g, values, LANES, at, a, b, x, y, z);
    for (int i = 0; i < LANES; i++) {
        CHECK((double)x[i], ==, look_up(&g, (double)u[i], (double)w[i]));
        NEAR(y[i], 2 * x[i], 1000 * EPS);
        NEAR(z[i], 3 * x[i], 2000 * EPS);
    }
}

static void sizes_that_are_refused(void **state)
{
    (void)state;
    const map_layout l = layout(MAP_REPEAT, false);
    table_grid g;
    assert_false(table_lay(&g, 1, 5, &l));
    assert_false(table_lay(&g, 5, 1, &l));
    assert_false(table_lay(&g, 65536, 65536, &l));
    assert_true(table_lay(&g, 2, 2, &l));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(repeated_cells),
        cmocka_unit_test(repeated_corners_share_the_last_sample),
        cmocka_unit_test(mirrored_cells_double_the_edge),
        cmocka_unit_test(mirrored_corners_do_not),
        cmocka_unit_test(clamped),
        cmocka_unit_test(periods),
        cmocka_unit_test(corners_are_at_the_edges),
        cmocka_unit_test(cells_have_their_sample_in_the_middle),
        cmocka_unit_test(bilinear_between_samples),
        cmocka_unit_test(repeats_after_its_size),
        cmocka_unit_test(mirrors_at_its_edges),
        cmocka_unit_test(clamps_beyond_its_edges),
        cmocka_unit_test(odd_coordinates_stay_in_the_table),
        cmocka_unit_test(three_values_as_one),
        cmocka_unit_test(sizes_that_are_refused),
    };
    return cmocka_run_group_tests_name("tables", tests, NULL, NULL);
}
