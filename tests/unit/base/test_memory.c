/* Budgets: what is counted, refused and given back, and the words that tell it. */
#include "support/check.h"

#include <string.h>

#include "base/memory.h"

static void test_blocks_are_counted_until_they_are_freed(void **state)
{
    (void)state;
    memory m = {.from = budget_open(), .limit = 1000};
    char *a = memory_new(&m, 400), *b = memory_zeroed(&m, 500);
    assert_non_null(a);
    assert_non_null(b);
    assert_int_equal((uintptr_t)a % 64, 0);
    assert_int_equal((uintptr_t)b % 64, 0);
    for (int k = 0; k < 500; k++)
        assert_int_equal(b[k], 0);
    assert_int_equal(budget_used(m.from), 900);
    memory_free(a);
    assert_int_equal(budget_used(m.from), 500);
    memory_free(b);
    assert_int_equal(budget_used(m.from), 0);
    assert_int_equal(budget_peak(m.from), 900);
    budget_close(m.from);
}

static void test_what_passes_the_limit_is_refused(void **state)
{
    (void)state;
    char words[MEMORY_WORDS];
    memory m = {.from = budget_open(), .limit = 2048};
    char *a = memory_new(&m, 2048);
    assert_non_null(a);
    assert_string_equal(memory_words(&m, words), "there is not enough memory");
    assert_null(memory_new(&m, 1));
    assert_null(memory_zeroed(&m, (size_t)3 << 30));
    assert_int_equal(budget_used(m.from), 2048);
    assert_int_equal(m.wanted, 2049); /* the first one counts */
    memory_free(a);
    m.wanted = 0;
    assert_null(memory_aligned(&m, 1 << 12, (size_t)3 << 29));
    assert_string_equal(memory_words(&m, words),
                        "there is not enough memory: it needs 1.5 GB, more than the limit of 2 kB (--max-memory)");
    assert_int_equal(budget_used(m.from), 0);
    budget_close(m.from);
}

static void test_a_block_outlives_the_budgets_owners(void **state)
{
    (void)state;
    memory m = {.from = budget_open()};
    budget *second = budget_share(m.from);
    char *a = memory_new(&m, 100);
    assert_non_null(a);
    budget_close(m.from);
    budget_close(second);
    memory_free(a); /* the sanitizers see that the budget is freed now, and not before */
}

static void test_a_block_with_another_size(void **state)
{
    (void)state;
    memory m = {.from = budget_open(), .limit = 3000};
    char *a = memory_resize(&m, NULL, 1000);
    assert_non_null(a);
    memset(a, 7, 1000);
    char *b = memory_resize(&m, a, 1500);
    assert_non_null(b);
    for (int k = 0; k < 1000; k++)
        assert_int_equal(b[k], 7);
    assert_int_equal(budget_used(m.from), 1500);
    assert_null(memory_resize(&m, b, 2000)); /* both are there for a moment */
    assert_int_equal(b[999], 7);
    memory_free(b);
    budget_close(m.from);
}

static void test_without_a_budget_nothing_is_refused(void **state)
{
    (void)state;
    memory none = {.limit = 1};
    char *a = memory_new(NULL, 1000), *b = memory_new(&none, 1000);
    assert_non_null(a);
    assert_non_null(b);
    memory_free(a);
    memory_free(b);
    memory_free(NULL);
    assert_true(memory_count(NULL, NULL, 1));
}

static void test_sizes_in_words(void **state)
{
    (void)state;
    char text[MEMORY_SIZE];
    assert_string_equal(memory_size(1023, text), "1023 bytes");
    assert_string_equal(memory_size(1024, text), "1 kB");
    assert_string_equal(memory_size(1025, text), "1.1 kB");
    assert_string_equal(memory_size((int64_t)4 << 30, text), "4 GB");
    assert_true(memory_default() > (int64_t)1 << 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_blocks_are_counted_until_they_are_freed),
        cmocka_unit_test(test_what_passes_the_limit_is_refused),
        cmocka_unit_test(test_a_block_outlives_the_budgets_owners),
        cmocka_unit_test(test_a_block_with_another_size),
        cmocka_unit_test(test_without_a_budget_nothing_is_refused),
        cmocka_unit_test(test_sizes_in_words),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
