/* One target under libFuzzer: the one that the program's name ends in, as in fuzz-scene. */
#include "fuzz/fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const fuzz_target *target;

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    const char *dash = strrchr((*argv)[0], '-');
    target = fuzz_find(dash ? dash + 1 : "");
    if (target)
        return 0;
    fprintf(stderr, "%s: no such target\n", (*argv)[0]);
    exit(2);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    target->run(data, size);
    return 0;
}
