/* What an output must not replace. */
#include "cli/command.h"

#include <stdio.h>
#include <sys/stat.h>

bool outputs_spare_inputs(const scene *s, const char *const *output, int outputs)
{
    for (int k = 0; k < outputs; k++)
        if (files_have_path(&s->made_from, output[k]))
            return usage_error("%s: the scene is made from this file, expected -o with another name", output[k]);
    return true;
}

bool output_is_replaceable(const char *path)
{
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode) || image_png_is_from(path, OUTPUT_SOFTWARE))
        return true;
    return usage_error("%s: kage did not write this file, expected -o with another name, or --overwrite", path);
}
