/* The door for compiled intersectors: a shared library that exports `lostbits_forms` comes under test with
 * `lostbits map SCENE --plugin LIBRARY.so`. C99; nothing to link with.
 *
 * A form answers a batch of rays against a sphere |p - centre| = radius, a box lo <= p <= hi, a triangle, an
 * ellipsoid |(p - centre)/radii| = 1, a cylinder with caps, a capsule, a tube (a cylinder without caps), a cone with
 * caps, a disc, a plane or a torus: the t of p = origin + t direction where the ray first meets the surface, t >= 0.
 * What it may assume and what it promises stands in its `lb_form`; `lostbits plugin check LIBRARY.so` tries whether it
 * is so. */
#ifndef LOSTBITS_PLUGIN_H
#define LOSTBITS_PLUGIN_H

#include <stddef.h>

/* The version of this file. A library returns NULL where it is asked for one that it was not compiled for. */
#define LOSTBITS_PLUGIN_ABI 1

#ifdef __cplusplus
extern "C" {
#endif

enum {
    LB_SPHERE = 0,
    LB_BOX = 1,
    LB_TRIANGLE = 2,
    LB_ELLIPSOID = 3,
    LB_CYLINDER = 4,
    LB_CAPSULE = 5,
    LB_TUBE = 6,
    LB_CONE = 7,
    LB_DISC = 8,
    LB_PLANE = 9,
    LB_TORUS = 10
};                                                                /* lb_form.shape */
enum { LB_F32 = 32, LB_F64 = 64 };                                /* lb_form.format: `float` or `double` */
enum { LB_ANY = 0, LB_UNIT = 1 };                                 /* lb_form.direction */
enum { LB_BOTH = 0, LB_NEAR = 1, LB_FIRST = 2, LB_HIT_ONLY = 3 }; /* lb_form.roots */
enum { LB_HIT = 0, LB_MISS = 1, LB_EXIT = 2 };                    /* lb_form.touching, lb_form.at_origin */

enum {
    /* `hit` says that the whole line meets the solid, in front of the origin or behind: the first t >= 0 of near and
     * far is taken from it. Needs LB_BOTH, or LB_NEAR, whose t < 0 is a miss. */
    LB_LINE = 1,
    /* `ends` is not looked at: what lies beyond is taken away afterwards. Of LB_HIT_ONLY: the ray has no end. */
    LB_NO_END = 2,
    /* One call at a time. */
    LB_ONE_THREAD = 4,
    /* The interval is cut to the ray: near is 0 where the line enters behind the origin. Needs LB_BOTH, and of a sphere
     * at_origin = LB_EXIT or LB_MISS: near = 0 tells no entry at the origin from one behind. */
    LB_CLIPPED = 8,
    /* The answer from inside, one of these. Without: the exit of a sphere, 0 of a box; of LB_NEAR a miss. */
    LB_INSIDE_EXIT = 16, /* where the ray leaves */
    LB_INSIDE_ZERO = 32, /* t = 0 */
    LB_INSIDE_NEAR = 48, /* the near root, t < 0, which the caller looks at; needs LB_NEAR */
    LB_INSIDE_MISS = 64,
    LB_INSIDE = 112, /* the bits of these */
    /* Rays of every shape begin and end: `starts` and `ends` are looked at, t counts where start <= t <= end, both ends
     * included, and where the range begins inside of a solid that answers 0 from inside, t is start. Needs LB_FIRST or
     * LB_HIT_ONLY: of a form that tells near and far the first of them in the range is taken afterwards. */
    LB_RANGE = 128,
    /* The one side that a triangle, a disc or a plane is met from. Without: both. The front is where the normal points
     * to, of a triangle (b - a) x (c - a): seen from there a, b, c run counter-clockwise. */
    LB_FACING_FRONT = 256,
    LB_FACING_BACK = 512,
    LB_FACING = 768 /* the bits of these */
};

/* Numbers are `float` or `double`, as the form's format says, and always finite except for `ends`. */
typedef struct lb_batch {
    size_t size;         /* rays */
    const void* rays;    /* size x 6: origin x y z, direction x y z */
    const void* ends;    /* size: where each ray ends, as t, infinity for nowhere; NULL: no ray ends */
    const void* solids;  /* by shape: centre x y z, radius; lo x y z, hi x y z; the vertices a, b, c; centre x y z,
                            radii x y z; base or start x y z, top or end x y z, radius (of a cone radius of the base,
                            radius of the top); disc: centre x y z, normal x y z, radius, radius of the hole; plane:
                            point x y z, normal x y z; torus: centre x y z, axis x y z, major and minor radius */
    size_t solid_stride; /* numbers from the solid of one ray to that of the next; 0: one for all */
    void* near_far;      /* out, size x 2: where the line enters and leaves. Of LB_NEAR and LB_FIRST, t comes first and
                            the second is not read; of LB_HIT_ONLY neither is; nor where `hit` is 0 */
    unsigned char* hit;  /* out, size: 1 or 0 */
    void* own;           /* lb_form.own */
    const void* starts;  /* of LB_RANGE, size: where each ray begins, as t >= 0; NULL: all at 0 */
} lb_batch;

typedef struct lb_form {
    const char* name;   /* of letters, digits and . _ -, such as "mylib.sphere". Two forms may share one, a format each,
                           where all else that they promise is the same */
    const char* title;  /* a line; or NULL */
    const char* source; /* where the code is: library, version, file, function; or NULL */
    int shape, format;
    int direction; /* LB_UNIT: directions come normalised and rounded to the format, so t is a distance */
    int roots;     /* LB_NEAR: the smaller root alone, t < 0 is a miss. LB_FIRST: the first t >= 0 */
    int touching;  /* LB_HIT: a ray that touches in one point hits. Of a box: the box is closed. LB_MISS: it misses,
                      and so does one that ends where it enters a solid; a tube and what is flat it may end on */
    int at_origin; /* LB_MISS: a surface exactly at the origin (t = 0) is passed over, where the ray goes in and
                      where it goes out. LB_EXIT: where it goes in alone; where it goes out, t = 0 is its exit */
    unsigned flags;
    void* own;
    /* Writes near_far and hit of every ray. NULL, or why it could not: a text that lives until the next call. Called
     * from several threads at once unless LB_ONE_THREAD. */
    const char* (*run)(const lb_batch* batch);
} lb_form;

/* What the library exports. The forms live as long as it is loaded. NULL where `abi` is not LOSTBITS_PLUGIN_ABI. */
#if defined(_WIN32)
__declspec(dllexport)
#elif defined(__GNUC__)
__attribute__((visibility("default")))
#endif
    const lb_form* lostbits_forms(int abi, size_t* count);

#ifdef __cplusplus
}
#endif

#endif
