/* Runs targets on files, without a fuzzer: `fuzz-replay tests/fuzz/finds` runs each file of each folder by the target
 * that the folder is called after, `fuzz-replay scene FILE...` these files by that target. A find ends the program as
 * under the fuzzer; the name of the file is printed before it is run.
 */
#define _GNU_SOURCE /* scandir, asprintf */

#include "fuzz/fuzz.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void run(const fuzz_target *t, const char *path)
{
    size_t size = 0;
    uint8_t *data = fuzz_read(path, &size);
    if (!data) {
        perror(path);
        exit(2);
    }
    printf("%s %s\n", t->name, path);
    fflush(stdout);
    t->run(data, size);
    free(data);
}

static int is_shown(const struct dirent *d) { return d->d_name[0] != '.'; }

/* The target's folder in `top`. Returns the number of files; 0: there is no such folder. */
static int run_folder(const fuzz_target *t, const char *top)
{
    char *folder = NULL, *path = NULL;
    struct dirent **all = NULL;
    HOLDS(asprintf(&folder, "%s/%s", top, t->name) > 0, "out of memory");
    const int n = scandir(folder, &all, is_shown, alphasort);
    for (int k = 0; k < n; k++) {
        HOLDS(asprintf(&path, "%s/%s", folder, all[k]->d_name) > 0, "out of memory");
        run(t, path);
        free(path);
        free(all[k]);
    }
    free(all);
    free(folder);
    return n > 0 ? n : 0;
}

int main(int argc, char **argv)
{
    const fuzz_target *one = argc > 1 ? fuzz_find(argv[1]) : NULL;
    int n = 0;
    for (int k = 2; one && k < argc; k++, n++)
        run(one, argv[k]);
    for (const fuzz_target *t = fuzz_targets; !one && argc == 2 && t->name; t++)
        n += run_folder(t, argv[1]);
    if (n == 0) {
        fprintf(stderr, "usage: fuzz-replay FOLDER, with folders of files called after targets; or TARGET FILE...\n");
        return 2;
    }
    printf("%d inputs, no find\n", n);
    return 0;
}
