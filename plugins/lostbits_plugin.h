/* The interface for compiled intersectors. A shared library that exports `lostbits_forms` can be tested with
 * `lostbits map SCENE --plugin LIBRARY.so`. It needs C99, and there is nothing to link with.
 *
 * A form is a function that intersects a batch of rays with one kind of primitive: a sphere |p - centre| = radius, a
 * box lo <= p <= hi, a triangle, an ellipsoid |(p - centre)/radii| = 1, a cylinder with caps, a capsule, a tube (a
 * cylinder without caps), a cone with caps, a disc, a plane or a torus. It returns the t of p = origin + t direction at
 * which the ray first hits the surface, t >= 0. Its `lb_form` states what it may assume and what it promises; `lostbits
 * plugin check LIBRARY.so` tests that. */
#ifndef LOSTBITS_PLUGIN_H
#define LOSTBITS_PLUGIN_H

#include <stddef.h>

/* The version of this interface. A library returns NULL if it is called with another version than its own. */
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
    /* `hit` is 1 if the whole line hits the primitive, in front of the origin or behind it. The caller then takes the
     * first t >= 0 of near and far. Needs LB_BOTH, or LB_NEAR, where t < 0 is a miss. */
    LB_LINE = 1,
    /* The form ignores `ends`. The caller removes hits beyond the end. With LB_HIT_ONLY, rays have no end. */
    LB_NO_END = 2,
    /* `run` must not be called by several threads at once. */
    LB_ONE_THREAD = 4,
    /* The interval is clipped to the ray: near is 0 if the line enters behind the origin. Needs LB_BOTH. For a sphere
     * it also needs at_origin = LB_EXIT or LB_MISS, since near = 0 does not distinguish an entry at the origin from one
     * behind it. */
    LB_CLIPPED = 8,
    /* The answer to a ray that starts inside, one of the following. Without any, it is the exit for a sphere, 0 for a
     * box, and a miss with LB_NEAR. */
    LB_INSIDE_EXIT = 16, /* the t at which the ray leaves */
    LB_INSIDE_ZERO = 32, /* t = 0 */
    LB_INSIDE_NEAR = 48, /* the near root, t < 0, which the caller checks; needs LB_NEAR */
    LB_INSIDE_MISS = 64,
    LB_INSIDE = 112, /* mask of these bits */
    /* The form takes the range of each ray from `starts` and `ends`, for every shape: a hit needs start <= t <= end,
     * both ends included. If the range starts inside a primitive whose answer from inside is 0, t is start. Needs
     * LB_FIRST or LB_HIT_ONLY. For a form that returns near and far, the caller takes the first of them in the range
     * afterwards. */
    LB_RANGE = 128,
    /* A triangle, a disc or a plane is hit from one side only. Without these flags it is hit from both. The front is
     * the side that the normal points to. For a triangle the normal is (b - a) x (c - a): seen from the front, a, b, c
     * run counter-clockwise. */
    LB_FACING_FRONT = 256,
    LB_FACING_BACK = 512,
    LB_FACING = 768 /* mask of these bits */
};

/* Numbers are `float` or `double`, as the form's format says, and always finite except for `ends`. */
typedef struct lb_batch {
    size_t size;            /* rays */
    const void* rays;       /* size x 6: origin x y z, direction x y z */
    const void* ends;       /* size: the t at which each ray ends, or infinity; NULL: no ray ends */
    const void* primitives; /* numbers of the primitives. Sphere: centre x y z, radius. Box: lo x y z, hi x y z.
                           Triangle: vertices a, b, c. Ellipsoid: centre x y z, radii x y z. Cylinder, capsule, tube:
                           base or start x y z, top or end x y z, radius. Cone: the same, with radius of the base and
                           radius of the top. Disc: centre x y z, normal x y z, radius, radius of the hole. Plane: point
                           x y z, normal x y z. Torus: centre x y z, axis x y z, major and minor radius */
    size_t
        primitive_stride; /* count of numbers from the primitive of one ray to that of the next; 0: one for all rays */
    void* near_far;     /* out, size x 2: t of entry and exit of the line. With LB_NEAR and LB_FIRST the first is t, and
                           the second is not read. With LB_HIT_ONLY, or if `hit` is 0, neither is read */
    unsigned char* hit; /* out, size: 1 or 0 */
    void* own;          /* lb_form.own */
    const void* starts; /* size, with LB_RANGE: the t >= 0 at which each ray starts; NULL: all start at 0 */
} lb_batch;

typedef struct lb_form {
    const char* name;   /* letters, digits and . _ -, such as "mylib.sphere". Two forms of different formats may share a
                           name if everything else that they promise is the same */
    const char* title;  /* one line, or NULL */
    const char* source; /* library, version, file and function of the code, or NULL */
    int shape, format;
    int direction; /* LB_UNIT: directions are normalised and rounded to the format, so t is a distance */
    int roots;     /* LB_NEAR: only the smaller root; t < 0 is a miss. LB_FIRST: the first t >= 0 */
    int touching;  /* LB_HIT: a ray that touches in one point hits, and a box is closed. LB_MISS: such a ray misses. So
                      does one that ends where it enters a primitive, except on a tube or a flat one */
    int at_origin; /* LB_MISS: a surface exactly at the origin (t = 0) is not hit, whether the ray enters or leaves
                      there. LB_EXIT: it is not hit where the ray enters; where the ray leaves, its exit is t = 0 */
    unsigned flags;
    void* own;
    /* Writes near_far and hit of every ray. Returns NULL, or the reason for a failure: a text that must stay valid
     * until the next call. Called from several threads at once unless LB_ONE_THREAD is set. */
    const char* (*run)(const lb_batch* batch);
} lb_form;

/* The function that the library exports. It returns `count` forms, which stay valid while the library is loaded, or
 * NULL if `abi` is not LOSTBITS_PLUGIN_ABI. */
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
