/* kage_scene_write_povray: the scene as a file for POV-Ray. */
#include "api/api.h"

#include "povray/povray.h"

kage_status kage_scene_write_povray(kage_scene *k, const char *path, const kage_povray_options *given,
                                    kage_povray_report *report, kage_errors **to)
{
    const kage_povray_options o = given ? *given : (kage_povray_options){0};
    const bool displaced = o.displaced == KAGE_AS_SCENE ? k->first->displaced : o.displaced == KAGE_YES;
    errors e = {0};
    pov_report r = {0};
    kage_status status = KAGE_BAD_INPUT;
    c_locale l = c_locale_begin();
    watch w;
    const progress show = watch_begin(&w, o.progress, o.user, &l, o.limits, &k->allowed);
    const scene *s = scene_reading(k, (reading){displaced, k->first->shadow, k->first->bump_shadow}, &show, &e);
    bool good = limits_are_good(o.limits, &e) && s && pov_possible(s, &e);
    if (good) {
        const pov_options how = {
            .command = o.command ? o.command : "libkage", .no_cast = o.no_cast != 0, .progress = &show};
        status = KAGE_NOT_WRITTEN;
        good = pov_write(s, &how, path, &r, &e);
    }
    c_locale_end(&l);
    if (report)
        *report = (kage_povray_report){.coarse = good ? r.coarse : NULL, .height = r.height, .pixels = r.pixels};
    return errors_give(&e, good ? KAGE_OK : status, &w, to);
}
