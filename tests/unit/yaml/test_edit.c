/* Changes in a scene's text: what is replaced and what stays, byte by byte; and for texts and changes at random, that
 * the new text says what the changed document says.
 */
#include "support/check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/random_in.h"
#include "yaml/yaml.h"

static void expect(const char *text, const char *set, const char *expected)
{
    char *new = yaml_edited(text, 1, &set);
    assert_non_null(new);
    if (strcmp(new, expected) != 0)
        fail_msg("%s\nin\n%s\ngives\n%s\nnot\n%s", set, text, new, expected);
    free(new);
}

static void values_are_replaced_where_they_stand(void **state)
{
    (void)state;
    expect("a: 1 # one\nb: 2\n", "a=3", "a: 3 # one\nb: 2\n");
    expect("a: \"1 # one\" # two\n", "a=3", "a: 3 # two\n");
    expect("a: 'it''s'\n", "a=\"x\"", "a: \"x\"\n");
    expect("# head\na: {b: [1, 2], c: x} # end\n", "a.b=[3]", "# head\na: {b: [3], c: x} # end\n");
    expect("a: [1, {b: 2}, 3]", "a.1.b= 5 # five", "a: [1, {b: 5}, 3]");
    expect("a: [1, 2]", "a.0=x", "a: [x, 2]");
    expect("a:\n- 1\n- b: 2 # two\n  c: 3\n", "a.1.b=9", "a:\n- 1\n- b: 9 # two\n  c: 3\n");
    expect("a:\n- 1\n- b: 2\n  c: 3\n# end\n", "a.1=9", "a:\n- 1\n- 9\n# end\n");
    expect("\"a\": {\"b\":1}", "a.b=2", "\"a\": {\"b\": 2}");
    expect("a: plain\n  and more\nb: 1\n", "a=0", "a: 0\nb: 1\n");
    expect("a: !!str 5\nb: &x {c: 1}\n", "b.c=2", "a: !!str 5\nb: &x {c: 2}\n");
    expect("a: !!str 5\nb: &x {c: 1}\n", "a=2", "a: 2\nb: &x {c: 1}\n");
    expect("a: !!str 5\nb: &x {c: 1}\n", "b=2", "a: !!str 5\nb: 2\n");
    expect("%YAML 1.2\n---\na: 1\n...\n", "a=2", "%YAML 1.2\n---\na: 2\n...\n");
    expect("\xc3\xa4\xe2\x82\xac: {\xc3\xa4: \xc3\xa4, b: 1} # \xc3\xa4\na: 1\n", "a=\xc3\xbc",
           "\xc3\xa4\xe2\x82\xac: {\xc3\xa4: \xc3\xa4, b: 1} # \xc3\xa4\na: \xc3\xbc\n");
    expect("a: 1\r\nb: 2\r\n", "b=3", "a: 1\r\nb: 3\r\n");
}

static void values_of_several_lines_are_replaced(void **state)
{
    (void)state;
    expect("a: # what\n  # why\n  b: 1\n  c: 2\n\n# end\nd: 1\n", "a=5", "a: 5 # what\n\n# end\nd: 1\n");
    expect("a:\n- 1\n- 2\nd: 1\n", "a=[3]", "a: [3]\nd: 1\n");
    expect("a: |\n  one\n  two\n\nb: 1\n", "a=x", "a: x\n\nb: 1\n");
    expect("a: >- # | folded\n  one\nb: 1\n", "a=x", "a: x\nb: 1\n");
    expect("a: [1,\n  2] # two\nb: 1", "a=x", "a: x # two\nb: 1");
    expect("a: \"one\n  two\"\nb: 1", "a=x", "a: x\nb: 1");
    expect("a: &n\n  b: 1\nc: 2\n", "a=x", "a: x\nc: 2\n");
}

static void missing_values_are_written(void **state)
{
    (void)state;
    expect("a:\nb: 1\n", "a=2", "a: 2\nb: 1\n");
    expect("a: # none\nb: 1\n", "a=2", "a: 2 # none\nb: 1\n");
    expect("{a, b: 1}", "a=2", "{a: 2, b: 1}");
    expect("{a: , b: 1}", "a=2", "{a: 2 , b: 1}");
}

static void missing_names_are_inserted(void **state)
{
    (void)state;
    expect("a:\n  b: 1 # one\n\n  # last\nc: 2\n", "a.d=3", "a:\n  b: 1 # one\n  d: 3\n\n  # last\nc: 2\n");
    expect("a: {b: 1 }", "a.d=3", "a: {b: 1, d: 3 }");
    expect("a: {b: 1, }", "a.d=3", "a: {b: 1, d: 3, }");
    expect("a: {}", "a.d=3", "a: {d: 3}");
    expect("a: {b}", "a.d=3", "a: {b, d: 3}");
    expect("a: {b: [1,\n  2] # two\n  } # end", "a.d=3", "a: {b: [1,\n  2], d: 3 # two\n  } # end");
    expect("l:\n  - b: 1\n  - c: 2", "l.0.d=3", "l:\n  - b: 1\n    d: 3\n  - c: 2");
    expect("l: [b: 1, 2]", "l.0.d=3", "l: [{b: 1, d: 3}, 2]");
    expect("a: 1", "c=3", "a: 1\nc: 3");
    expect("a: 1\r\nb:\r\n  c: 1\r\n", "b.d=3", "a: 1\r\nb:\r\n  c: 1\r\n  d: 3\r\n");
    expect("a: |\n  one\n\n# end\n", "c=3", "a: |\n  one\nc: 3\n\n# end\n");
    expect("a:\n", "c=3", "a:\nc: 3\n");
    expect("a: 1\n", "render.aa=3", "a: 1\nrender: {aa: 3}\n");
    expect("{a: 1}\n", "render.aa=3", "{a: 1, render: {aa: 3}}\n");
}

static void values_fit_their_place(void **state)
{
    (void)state;
    expect("a: 1\nb: {c: 1}\n", "a=max(u, w)", "a: max(u, w)\nb: {c: 1}\n");
    expect("a: 1\nb: {c: 1}\n", "b.c=max(u, w)", "a: 1\nb: {c: 'max(u, w)'}\n");
    expect("b: {c: 1}\n", "b.c=it's [x]", "b: {c: 'it''s [x]'}\n");
    expect("a: 1\n", "a=f: max(u, w)", "a: {f: 'max(u, w)'}\n");
    expect("a: 1\n", "a=- - 1", "a: [[1]]\n");
    expect("a: 1\n", "a=- b: {c: 1}", "a: [{b: {c: 1}}]\n");
    expect("a: 1\n", "a=&n 5 # five", "a: &n 5\n");
    expect("a: 1\n", "a=\"# no {comment\"", "a: \"# no {comment\"\n");
}

/* ---- at random ---- */

static const char *const texts[] = {
    "a: 1\n",
    "# c\n{a: {b: [1, 2, {c: x}], \"d\": \"y\"}, e: []}\n",
    ("%YAML 1.2\n--- # start\na:\n  b: # b\n  # b, too\n    c: 1\n    d: [1,\n      2]\n\n"
     "  e:\n  - 1\n  - f: 'x'\n    g: y\n...\n"),
    ("a: |\n  one\n  # no comment\nb: >+\n  two\n\n  three\n\n"
     "c: {d: &x {e: 1}, f: !!str g}\nh:\n- - 1\n  - 2\n- {i: [j: 1, k]}\n"),
    "a:\r\n  b: \"x\\\r\n    y\"\r\n  c: plain\r\n    more # c\r\nd:\r\n- 1\r\n-\r\n  e: 1\r\n",
    "\"a\":\n    'b':   {\"c\":1,'d':2}\n    e:    \xc3\xa4 \xe2\x82\xac # \xc3\xa4\n    f:\ng: {h: , i}\n",
};

static const char *const values[] = {"5",
                                     "[1, 2, 3]",
                                     "{p: 1, q: [x, y]}",
                                     "r: max(u, w)",
                                     "- 1",
                                     "- s: 1",
                                     "\"q: #, {\"",
                                     "'it''s'",
                                     "~",
                                     "words, with [commas]",
                                     "x # note",
                                     "  spaced  ",
                                     "\xc3\xa4\xe2\x82\xac",
                                     "{}",
                                     "[]",
                                     "- - 1",
                                     "t: 'a'",
                                     "&n 5",
                                     "\"\"",
                                     "a#b"};

static int below(int n) { return (int)random_in(0, n) % n; }

/* Names that a path may have. */
static int is_name(const char *text)
{
    return text && *text && strlen(text) < 60 &&
           !text[strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-")];
}

/* A random path in the document: of what is there, or of something new in a map. False: there is none. */
static int path_in(yaml *y, char path[400])
{
    node *at = yaml_root(y);
    *path = 0;
    for (;;) {
        const int map = yaml_is_map(at), n = map ? yaml_size(at) : yaml_is_list(at) ? yaml_list(y, at, "") : 0;
        const size_t used = strlen(path);
        if ((map && below(5) == 0) || (map && n == 0)) {
            snprintf(path + used, 400 - used, "%snew%d", used ? "." : "", below(3));
            return 1;
        }
        if (n == 0 || (used && below(4) == 0))
            return used > 0;
        const int k = below(n);
        node *key = NULL, *next = map ? yaml_pair(at, k, &key) : yaml_item(at, k);
        const char *name = key ? yaml_text(y, key, "") : "";
        if (map && (!is_name(name) || yaml_get(at, name) != next))
            return 0;
        if (map)
            snprintf(path + used, 400 - used, "%s%s", used ? "." : "", name);
        else
            snprintf(path + used, 400 - used, "%s%d", used ? "." : "", k);
        at = next;
    }
}

static int same(yaml *x, node *a, yaml *y, node *b)
{
    if (!a || !b)
        return a == b;
    if (yaml_is_map(a) != yaml_is_map(b) || yaml_is_list(a) != yaml_is_list(b))
        return 0;
    if (yaml_is_map(a)) {
        int good = yaml_size(a) == yaml_size(b);
        for (int k = 0; good && k < yaml_size(a); k++) {
            node *p, *q, *v = yaml_pair(a, k, &p), *w = yaml_pair(b, k, &q);
            good = same(x, p, y, q) && same(x, v, y, w);
        }
        return good;
    }
    if (yaml_is_list(a)) {
        const int n = yaml_list(x, a, "");
        int good = n == yaml_list(y, b, "");
        for (int k = 0; good && k < n; k++)
            good = same(x, yaml_item(a, k), y, yaml_item(b, k));
        return good;
    }
    const char *s = yaml_text(x, a, ""), *t = yaml_text(y, b, "");
    return s && t ? strcmp(s, t) == 0 : s == t;
}

/* Some changes one after another. Returns how many were possible. */
static int try_changes(const char *text)
{
    enum { MOST = 5, SIZE = 512 };
    char path[400], all[MOST][SIZE];
    const char *set[MOST];
    const int n = 1 + below(MOST);
    int made = 0;
    for (int k = 0; k < n; k++) {
        errors e = {0};
        yaml *y = yaml_open("t", text, strlen(text), made, set, "image render", NULL, &e);
        if (!y)
            fail_msg("%s\n%s", text, e.text);
        if (path_in(y, path)) {
            snprintf(all[made], SIZE, "%s=%s", path, values[below((int)(sizeof values / sizeof *values))]);
            set[made] = all[made];
            made++;
        }
        yaml_close(y);
        errors_free(&e);
    }
    errors e = {0};
    char *new = yaml_edited(text, made, set);
    assert_non_null(new);
    yaml *x = yaml_open("t", text, strlen(text), made, set, "image render", NULL, &e);
    assert_int_equal(e.count, 0);
    yaml *y = yaml_open("t", new, strlen(new), 0, NULL, "image render", NULL, &e);
    if (!y || !same(x, yaml_root(x), y, yaml_root(y)))
        fail_msg("%s\n%s%s%s\ngive\n%s\n%s", text, set[0], made > 1 ? "\n" : "", made > 1 ? set[1] : "", new,
                 e.text ? e.text : "");
    yaml_close(x);
    yaml_close(y);
    errors_free(&e);
    free(new);
    return made;
}

static void texts_say_what_changed_documents_say(void **state)
{
    (void)state;
    int made = 0;
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
        for (int round = 0; round < 400; round++)
            made += try_changes(texts[k]);
    CHECK(made, >, 4000);
}

static void so_do_those_of_scenes(void **state)
{
    (void)state;
    static const char *const scenes[] = {
        "cube",           "sphere",         "terrain",       "torus",        "waves",         "gallery/bricks",
        "gallery/column", "gallery/copper", "gallery/dunes", "gallery/golf", "gallery/quilt", "gallery/shell",
        "gallery/spot",   "gallery/teapot", "gallery/tiles", "gallery/wall", "gallery/water"};
    static char text[1 << 16];
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        char path[200];
        snprintf(path, sizeof path, KAGE_TESTS_DIR "/../scenes/%s.yaml", scenes[k]);
        FILE *f = fopen(path, "rb");
        assert_non_null(f);
        text[fread(text, 1, sizeof text - 1, f)] = 0;
        fclose(f);
        for (int round = 0; round < 60; round++)
            try_changes(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_replaced_where_they_stand),
        cmocka_unit_test(values_of_several_lines_are_replaced),
        cmocka_unit_test(missing_values_are_written),
        cmocka_unit_test(missing_names_are_inserted),
        cmocka_unit_test(values_fit_their_place),
        cmocka_unit_test(texts_say_what_changed_documents_say),
        cmocka_unit_test(so_do_those_of_scenes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
