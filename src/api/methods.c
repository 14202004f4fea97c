/* The methods by name, and the library's version. */
#include "api/api.h"

const char *kage_version(void) { return KAGE_VERSION; }

const char *kage_precision(void) { return REAL_NAME; }

int kage_method_count(void) { return method_help_count; }

kage_method kage_method_get(int k)
{
    const bool is = k >= 0 && k < method_help_count;
    return (kage_method){is ? method_helps[k].name : NULL, is ? method_helps[k].text : NULL};
}

int kage_method_is_known(const char *name)
{
    method m;
    return method_parse(name, &m);
}
