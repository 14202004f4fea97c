/* Frees a surface of any kind. */
#include "geometry/surface.h"

#include <stdlib.h>

void surface_free(surface *f)
{
    if (f && f->free)
        f->free(f);
    else
        free(f);
}
