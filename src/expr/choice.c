/* Operations whose result, with its partials, is one of their operands: min, max, select, clamp. */
#include "base/real.h"
#include "expr/operation.h"

/* z = x where d < 0, y where d >= 0, NaN where d is NaN. */
STAGE static void stage_choose(int n, double *restrict z, const double *restrict d, const double *x, const double *y)
{
    for (int i = 0; i < n; i++) {
        double left = x[i], right = y[i];
        right = d[i] >= 0 ? right : KM_NAN;
        z[i] = d[i] < 0 ? left : right;
    }
}

/* For choose: -1 where x < y, 1 where x >= y, NaN where either is NaN. */
STAGE static void stage_compare(int n, double *restrict d, const double *x, const double *y)
{
    for (int i = 0; i < n; i++) {
        double right = x[i] >= y[i] ? 1 : KM_NAN;
        d[i] = x[i] < y[i] ? -1 : right;
    }
}

/* For choose: -1 where x = 0, 1 elsewhere, NaN where x is. */
STAGE static void stage_compare_zero(int n, double *restrict d, const double *restrict x)
{
    for (int i = 0; i < n; i++) {
        double right = x[i] == x[i] ? 1 : x[i];
        d[i] = x[i] == 0 ? -1 : right;
    }
}

static void choose(int n, expr_view z, const double *d, expr_view x, expr_view y)
{
    for (int p = 0; p < PARTS; p++)
        if (expr_part(z, p))
            stage_choose(n, expr_part(z, p), d, expr_part_or_zeros(x, p), expr_part_or_zeros(y, p));
}

/* ---- min, max ---- */

static void run_min(int n, expr_view z, const expr_view *x, double k)
{
    double d[EXPR_BATCH];
    (void)k;
    stage_compare(n, d, expr_part(x[0], PART_V), expr_part(x[1], PART_V));
    choose(n, z, d, x[0], x[1]);
}

static void run_max(int n, expr_view z, const expr_view *x, double k)
{
    double d[EXPR_BATCH];
    (void)k;
    stage_compare(n, d, expr_part(x[0], PART_V), expr_part(x[1], PART_V));
    choose(n, z, d, x[1], x[0]);
}

static interval min_value(const expr_ranges *r)
{
    const interval a = r->x[0], b = r->x[1];
    return (interval){lesser(a.lo, b.lo), lesser(a.hi, b.hi)};
}

static interval max_value(const expr_ranges *r)
{
    const interval a = r->x[0], b = r->x[1];
    return (interval){greater(a.lo, b.lo), greater(a.hi, b.hi)};
}

static int min_reached(const expr_ranges *r) { return (r->x[0].lo <= r->x[1].hi) | (r->x[1].lo <= r->x[0].hi) << 1; }
static int max_reached(const expr_ranges *r) { return (r->x[0].hi >= r->x[1].lo) | (r->x[1].hi >= r->x[0].lo) << 1; }

/* ---- select ---- */

/* b where a < 0, else c */
static void run_select(int n, expr_view z, const expr_view *x, double k)
{
    (void)k;
    choose(n, z, expr_part(x[0], PART_V), x[1], x[2]);
}

/* b where a < 0, c where a = 0, d where a > 0 */
static void run_select4(int n, expr_view z, const expr_view *x, double k)
{
    double is_zero[EXPR_BATCH], else_part[EXPR_BATCH];
    (void)k;
    stage_compare_zero(n, is_zero, expr_part(x[0], PART_V));
    for (int p = 0; p < PARTS; p++)
        if (expr_part(z, p)) {
            stage_choose(n, else_part, is_zero, expr_part_or_zeros(x[2], p), expr_part_or_zeros(x[3], p));
            stage_choose(n, expr_part(z, p), expr_part(x[0], PART_V), expr_part_or_zeros(x[1], p), else_part);
        }
}

static int select_reached(const expr_ranges *r) { return (r->x[0].lo < 0) << 1 | (r->x[0].hi >= 0) << 2; }
static int select4_reached(const expr_ranges *r)
{
    return (r->x[0].lo < 0) << 1 | interval_has(r->x[0], 0) << 2 | (r->x[0].hi > 0) << 3;
}

/* Of the branches that are reached; there is always one. */
static interval hull_of(int reached, const interval *x)
{
    int k = 1;
    while (!(reached >> k & 1))
        k++;
    interval z = x[k];
    for (k++; k < EXPR_OPERANDS; k++)
        if (reached >> k & 1)
            z = interval_hull(z, x[k]);
    return z;
}

static interval select_value(const expr_ranges *r) { return hull_of(select_reached(r), r->x); }
static interval select4_value(const expr_ranges *r) { return hull_of(select4_reached(r), r->x); }

static const expr_op select4 = {.operands = 4,
                                .deciding = 1,
                                .run = run_select4,
                                .value = select4_value,
                                .reached = select4_reached,
                                .pov = "select"};
static const expr_op select3 = {
    .operands = 3, .deciding = 1, .run = run_select, .value = select_value, .reached = select_reached, .pov = "select"};

static operand build_select(emitter *e, int n, const operand *arg)
{
    return expr_emit(e, n == 4 ? &select4 : &select3, n, arg);
}

/* ---- the table ---- */

#define CHAIN .least = 2, .most = EXPR_ANY_NUMBER, .operands = 2

static const expr_op minimum = {"min", CHAIN, .run = run_min, .value = min_value, .reached = min_reached, .pov = "min"};
static const expr_op maximum = {"max", CHAIN, .run = run_max, .value = max_value, .reached = max_reached, .pov = "max"};

/* clamp(x, lo, hi) */
static operand build_clamp(emitter *e, int n, const operand *arg)
{
    (void)n;
    const operand raised = expr_emit(e, &maximum, 2, arg);
    return expr_emit(e, &minimum, 2, (operand[]){raised, arg[2]});
}

const expr_op *const expr_choices[] = {
    &minimum,
    &maximum,
    &(const expr_op){.name = "clamp", .least = 3, .most = 3, .build = build_clamp},
    &(const expr_op){.name = "select", .least = 3, .most = 4, .build = build_select},
    NULL,
};
