/* Boxes as user geometry of Embree. Embree traverses its hierarchy and calls the functions here for each box that it
 * reaches. No number that Embree computes reaches a picture, since its rounding differs between processors. */
#include "bvh/bvh.h"

#if KAGE_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "base/bits.h"
#include "base/threads.h"

struct bvh {
    RTCDevice device;
    RTCScene scene;
    bvh_box *box;
    budget *from; /* what Embree's memory is counted in; NULL: nothing */
    int64_t held; /* bytes that it has now */
};

/* What the callbacks need during one traversal. Embree's context comes first, so that a pointer to it points here. */
typedef struct walk {
#if KAGE_EMBREE == 4
    struct RTCRayQueryContext context;
#else
    struct RTCIntersectContext context;
#endif
    bvh_visit *visit;
    bvh_meet *meet; /* for packets */
    float *end;     /* of the packet's rays */
    void *user;
} walk;

static void bounds(const struct RTCBoundsFunctionArguments *a)
{
    const bvh_box *b = &((const bvh *)a->geometryUserPtr)->box[a->primID];
    struct RTCBounds *o = a->bounds_o;
    o->lower_x = b->lo[0], o->lower_y = b->lo[1], o->lower_z = b->lo[2];
    o->upper_x = b->hi[0], o->upper_y = b->hi[1], o->upper_z = b->hi[2];
}

enum { SOME = 8 };

/* bit: one for each ray. */
STAGE static uint32_t bits_of(const int *restrict valid, const unsigned *restrict bit)
{
    uint32_t which = 0;
    for (int i = 0; i < SOME; i++)
        which |= bit[i] & (uint32_t)valid[i];
    return which;
}

STAGE static void set_ends(const int *restrict valid, const float *restrict end, float *restrict tfar)
{
    for (int i = 0; i < SOME; i++) {
        const float last = end[i] < 0 ? -HUGE_VALF : end[i];
        tfar[i] = valid[i] ? last : tfar[i];
    }
}

/* Some rays of a packet, N in Embree's arrays (rtcore_ray.h has functions for these, in C++ only), reach a box: 8 or 16
 * that follow each other, or with old processors 4. No hit is reported, only the new ends of the rays. */
static void met_packet(const struct RTCIntersectFunctionNArguments *a)
{
    const walk *k = (const walk *)(const void *)a->context;
    float *tfar = (float *)(void *)a->rayhit + 8 * a->N;
    const unsigned *bit = (const unsigned *)(const void *)a->rayhit + 10 * a->N; /* Embree calls it id */
    const bool by_some = a->N % SOME == 0 && bit[a->N - 1] == bit[0] << (a->N - 1);
    uint32_t which = 0;
    for (unsigned i = 0; by_some && i < a->N; i += SOME)
        which |= bits_of(a->valid + i, bit + i);
    for (unsigned i = 0; !by_some && i < a->N; i++)
        which |= a->valid[i] ? bit[i] : 0;
    if (!k->meet(k->user, (int32_t)a->primID, which, k->end))
        return;
    for (unsigned i = 0; by_some && i < a->N; i += SOME)
        set_ends(a->valid + i, k->end + lowest_bit(bit[i]), tfar + i);
    for (unsigned i = 0; !by_some && i < a->N; i++)
        if (a->valid[i]) {
            const float end = k->end[lowest_bit(bit[i])];
            tfar[i] = end < 0 ? -HUGE_VALF : end;
        }
}

/* Visits the box without reporting a hit, so that Embree continues with all others. */
static void met(const struct RTCOccludedFunctionNArguments *a)
{
    const walk *k = (const walk *)(const void *)a->context;
    if (a->valid[0])
        k->visit(k->user, (int32_t)a->primID);
}

static bool near_one(struct RTCPointQueryFunctionArguments *a)
{
    const walk *k = a->userPtr;
    k->visit(k->user, (int32_t)a->primID);
    return false; /* the radius stays */
}

/* ---- making one ---- */

typedef struct report {
    const progress *to;
    pthread_t caller;
} report;

/* Embree's threads call it, too; progress is shown in the caller's. */
static bool report_progress(void *user, double share)
{
    const report *r = user;
    if (pthread_equal(r->caller, pthread_self()))
        progress_show(r->to, "building", share);
    return true;
}

enum { MANY = 1 << 14 }; /* boxes; for fewer threads cost more than they save */

/* A limit of addresses, as by ulimit -v. */
static bool is_limited(void)
{
    struct rlimit l;
    return getrlimit(RLIMIT_AS, &l) == 0 && l.rlim_cur != RLIM_INFINITY;
}

/* Where Embree runs out of memory while it builds, TBB may end the process. So whether there is room is tried first:
 * Embree takes up to 160 bytes a box, for few boxes 250. Where addresses are limited, so are the 128 MiB of them that
 * one of the two sets aside. */
static bool has_room(int n)
{
    const size_t mib = (size_t)1 << 20, aside = n >= MANY && is_limited() ? 192 * mib : 16 * mib;
    void *volatile room = malloc(aside + 256 * (size_t)n); /* volatile: else gcc leaves it out */
    const bool good = room;
    free(room);
    return good;
}

/* Bytes that Embree takes for n boxes while it builds, and more. */
static int64_t most_for(int n) { return 256 * (int64_t)n + ((int64_t)1 << 16); }

/* Embree says what it takes and gives back, from any of its threads. Nothing is refused here, as an exception would go
 * through TBB: the most was counted before. */
static bool count_bytes(void *user, ssize_t bytes, bool post)
{
    bvh *b = user;
    (void)post;
    __atomic_add_fetch(&b->held, (int64_t)bytes, __ATOMIC_RELAXED);
    return true;
}

/* NULL: out of memory. */
static RTCDevice device_with(int threads, int n, bvh *b)
{
    char how[32];
    snprintf(how, sizeof how, "threads=%d", n < MANY || is_limited() ? 1 : threads_of(threads));
    RTCDevice d = has_room(n) ? rtcNewDevice(how) : NULL;
    if (d)
        rtcSetDeviceMemoryMonitorFunction(d, count_bytes, b);
    return d;
}

/* Commit the boxes. False: out of memory. */
static bool build(bvh *b, int n, const progress *w)
{
    report to = {w, pthread_self()};
    RTCGeometry g = rtcNewGeometry(b->device, RTC_GEOMETRY_TYPE_USER);
    if (!g)
        return false;
    rtcSetGeometryUserPrimitiveCount(g, (unsigned)n);
    rtcSetGeometryUserData(g, b);
    rtcSetGeometryBoundsFunction(g, bounds, NULL);
    rtcSetGeometryOccludedFunction(g, met);
    rtcSetGeometryIntersectFunction(g, met_packet);
    rtcCommitGeometry(g);
    rtcAttachGeometry(b->scene, g);
    rtcReleaseGeometry(g);
    rtcSetSceneFlags(b->scene, RTC_SCENE_FLAG_ROBUST);
    if (w)
        rtcSetSceneProgressMonitorFunction(b->scene, report_progress, &to);
    rtcCommitScene(b->scene);
    rtcSetSceneProgressMonitorFunction(b->scene, NULL, NULL);
    return rtcGetDeviceError(b->device) == RTC_ERROR_NONE;
}

bvh *bvh_new(int n, const bvh_box *box, int threads, const progress *w)
{
    memory *m = progress_memory(w);
    budget *from = m ? m->from : NULL;
    bvh *b = calloc(1, sizeof *b);
    if (!b || !memory_count(m, from, most_for(n))) {
        free(b);
        return NULL;
    }
    b->box = memory_new(m, sizeof *box * (size_t)(n > 0 ? n : 1));
    if (b->box && n > 0)
        memcpy(b->box, box, sizeof *box * (size_t)n);
    b->device = b->box ? device_with(threads, n, b) : NULL;
    b->scene = b->device ? rtcNewScene(b->device) : NULL;
    const bool good = b->scene && build(b, n, w);
    memory_count(NULL, from, b->held - most_for(n)); /* what it has, in place of the most that it might take */
    b->from = budget_share(from);
    if (good)
        return b;
    bvh_free(b);
    return NULL;
}

void bvh_free(bvh *b)
{
    if (!b)
        return;
    memory_count(NULL, b->from, -b->held);
    if (b->scene)
        rtcReleaseScene(b->scene);
    if (b->device)
        rtcReleaseDevice(b->device);
    budget_close(b->from);
    memory_free(b->box);
    free(b);
}

/* ---- rays ---- */

static struct RTCRay ray_of(const float r[3], const float s[3], float end)
{
    return (struct RTCRay){.org_x = r[0],
                           .org_y = r[1],
                           .org_z = r[2],
                           .dir_x = s[0],
                           .dir_y = s[1],
                           .dir_z = s[2],
                           .tfar = end,
                           .mask = ~0u};
}

void bvh_along(const bvh *b, const float r[3], const float s[3], float end, bvh_visit *visit, void *user)
{
    walk k = {.visit = visit, .user = user};
    struct RTCRay x = ray_of(r, s, end);
#if KAGE_EMBREE == 4
    struct RTCOccludedArguments how;
    rtcInitOccludedArguments(&how);
    rtcInitRayQueryContext(&k.context);
    how.context = &k.context;
    rtcOccluded1(b->scene, &x, &how);
#else
    rtcInitIntersectContext(&k.context);
    rtcOccluded1(b->scene, &k.context, &x);
#endif
}

/* ---- packets ---- */

static void set_rays(const bvh_packet *x, int valid[BVH_PACKET], struct RTCRay16 *y)
{
    memset(y, 0, sizeof *y);
    memcpy(y->org_x, x->at[0], sizeof y->org_x);
    memcpy(y->org_y, x->at[1], sizeof y->org_y);
    memcpy(y->org_z, x->at[2], sizeof y->org_z);
    memcpy(y->dir_x, x->way[0], sizeof y->dir_x);
    memcpy(y->dir_y, x->way[1], sizeof y->dir_y);
    memcpy(y->dir_z, x->way[2], sizeof y->dir_z);
    memcpy(y->tfar, x->end, sizeof y->tfar);
    for (unsigned i = 0; i < BVH_PACKET; i++) {
        y->mask[i] = ~0u;
        y->id[i] = 1u << i;
        valid[i] = x->end[i] >= 0 ? -1 : 0;
    }
}

/* rtcOccluded16 would name three times as many rays that miss the box. */
void bvh_packet_toward(const bvh *b, bvh_packet *x, bvh_meet *visit, void *user)
{
    walk k = {.meet = visit, .end = x->end, .user = user};
    RTC_ALIGN(64) int valid[BVH_PACKET];
    RTC_ALIGN(64) struct RTCRayHit16 y;
    set_rays(x, valid, &y.ray);
    memset(y.hit.geomID, 0xff, sizeof y.hit.geomID); /* no hit */
    memset(y.hit.instID, 0xff, sizeof y.hit.instID);
#if KAGE_EMBREE == 4
    struct RTCIntersectArguments how;
    rtcInitIntersectArguments(&how);
    rtcInitRayQueryContext(&k.context);
    how.context = &k.context;
    how.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect16(valid, b->scene, &y, &how);
#else
    rtcInitIntersectContext(&k.context);
    k.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, b->scene, &k.context, &y);
#endif
}

void bvh_around(const bvh *b, const float p[3], float radius, bvh_visit *visit, void *user)
{
    walk k = {.visit = visit, .user = user};
    struct RTCPointQuery q = {.x = p[0], .y = p[1], .z = p[2], .radius = radius};
    struct RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(b->scene, &q, &context, near_one, &k);
}
