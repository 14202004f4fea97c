/* Where the program kage-import is. In this order: as the caller says, as the environment's KAGE_IMPORT says, beside
 * the file that this code is in (the library or the program) or in ../libexec/kage from there, and where the library
 * was installed.
 */
#define _GNU_SOURCE /* dladdr, secure_getenv */

#include "mesh/find_reader.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef KAGE_LIBEXEC
#define KAGE_LIBEXEC "/usr/local/libexec/kage"
#endif

#define NAME "kage-import"

/* Whether `folder`, n bytes long, with `below` behind it has the program. */
static bool has(const char *folder, size_t n, const char *below, char path[READER_PATH])
{
    const int size = snprintf(path, READER_PATH, "%.*s%s/" NAME, (int)n, folder, below);
    return size > 0 && size < READER_PATH && access(path, X_OK) == 0;
}

static bool is_near(const char *file, char path[READER_PATH])
{
    const char *slash = strrchr(file, '/');
    const size_t n = slash ? (size_t)(slash - file) : 0;
    return slash && (has(file, n, "", path) || has(file, n, "/../libexec/kage", path));
}

/* The file that this code is in. The program's own name is what it was called by, so the system is asked first. */
static bool is_beside(char path[READER_PATH])
{
    static const char here = 0;
    char program[READER_PATH];
    Dl_info about;
    const ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
    program[n > 0 ? n : 0] = 0;
    return (dladdr(&here, &about) != 0 && about.dli_fname && is_near(about.dli_fname, path)) ||
           (n > 0 && is_near(program, path));
}

bool find_reader(const char *asked, char path[READER_PATH], char *why, size_t size)
{
    const char *said = asked ? asked : secure_getenv("KAGE_IMPORT"),
               *by = asked ? "as asked for" : "as KAGE_IMPORT says";
    if (said) {
        const int n = snprintf(path, READER_PATH, "%s", said);
        if (n < READER_PATH && access(path, X_OK) == 0)
            return true;
        snprintf(why, size, "no program %.150s to read models, %s", said, by);
        return false;
    }
    if (is_beside(path) || has(KAGE_LIBEXEC, strlen(KAGE_LIBEXEC), "", path))
        return true;
    snprintf(why, size,
             "no program " NAME " to read models, expected it beside kage, in " KAGE_LIBEXEC
             ", or where KAGE_IMPORT says");
    return false;
}
