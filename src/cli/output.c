/* What an output must not replace. */
#include "cli/command.h"

#include <string.h>
#include <sys/stat.h>

bool has_ending(const char *path, const char *ending)
{
    const size_t n = strlen(path), m = strlen(ending);
    return n > m && strcmp(path + n - m, ending) == 0;
}

bool outputs_spare_inputs(const kage_scene *s, const char *const *output, int outputs)
{
    for (int k = 0; k < outputs; k++)
        if (kage_scene_uses_file(s, output[k]))
            return usage_error("%s: the scene is made from this file, expected -o with another name", output[k]);
    return true;
}

bool output_is_replaceable(const char *path)
{
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode) || kage_file_is_picture(path))
        return true;
    return usage_error("%s: kage did not write this file, expected -o with another name, or --overwrite", path);
}
