/* Writes rays and the answers of a renderer into a file that `lostbits judge` reads. This header is all that is needed:
 * there is nothing to link with. It works in C99, in C++ and in CUDA, where `lostbits_dump_add` may be called on the
 * device.
 *
 *     lostbits_dump dump;
 *     lostbits_dump_begin(&dump, 1000000, "sphere");         memory for a million rays, each with its sphere
 *     ... in any thread, when a ray has hit or missed a sphere:
 *     lostbits_dump_add(&dump, id, o, d, tmin, tmax, sphere, hit, t);
 *     ... at the end:
 *     lostbits_dump_end(&dump, "rays.npy");
 *
 *     $ lostbits judge rays.npy -o out
 *
 * Rays that do not fit are counted (`dump.count`) but not kept. If the renderer computes in double, define
 * LOSTBITS_DUMP_REAL as double before the include: the type in the file says which arithmetic is judged. */
#ifndef LOSTBITS_DUMP_H
#define LOSTBITS_DUMP_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef LOSTBITS_DUMP_REAL
#define LOSTBITS_DUMP_REAL float
#endif

#if defined(__CUDACC__)
#define LOSTBITS_DUMP_ANYWHERE __host__ __device__ static inline
#else
#define LOSTBITS_DUMP_ANYWHERE static inline
#endif

enum { LOSTBITS_DUMP_MOST = 9 }; /* largest count of numbers of a primitive */

typedef struct lostbits_dump_row {
    LOSTBITS_DUMP_REAL number[8 + LOSTBITS_DUMP_MOST + 1]; /* origin, direction, tmin, tmax, primitive, t */
    unsigned id, hit;
} lostbits_dump_row;

typedef struct lostbits_dump {
    lostbits_dump_row* rows;
    unsigned long long room, count;
    int primitive; /* count of numbers of a primitive */
    const char* shape;
} lostbits_dump;

/* Returns the column names of a shape's numbers, as `lostbits judge` reads them, or NULL for an unknown shape. With
 * "none" there are no such columns: name the primitives to `judge` by --sphere, --scene and so on. */
static inline const char* const* lostbits_dump_columns(const char* shape, int* count) {
    static const char* const columns[][LOSTBITS_DUMP_MOST + 1] = {
        {"none"},
        {"sphere", "cx", "cy", "cz", "radius"},
        {"box", "lox", "loy", "loz", "hix", "hiy", "hiz"},
        {"triangle", "v0x", "v0y", "v0z", "v1x", "v1y", "v1z", "v2x", "v2y", "v2z"},
        {"ellipsoid", "cx", "cy", "cz", "rx", "ry", "rz"},
        {"cylinder", "bx", "by", "bz", "tx", "ty", "tz", "radius"},
        {"capsule", "sx", "sy", "sz", "ex", "ey", "ez", "radius"},
        {"tube", "lox", "loy", "loz", "tx", "ty", "tz", "radius"},
        {"cone", "bx", "by", "bz", "tx", "ty", "tz", "base_radius", "top_radius"},
        {"disc", "cx", "cy", "cz", "nx", "ny", "nz", "outer_radius", "inner_radius"},
        {"plane", "qx", "qy", "qz", "nx", "ny", "nz"},
        {"torus", "cx", "cy", "cz", "ax", "ay", "az", "major_radius", "minor_radius"}};
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; ++i) {
        if (strcmp(shape, columns[i][0]) != 0) continue;
        for (*count = 0; *count < LOSTBITS_DUMP_MOST && columns[i][*count + 1] != NULL;) ++*count;
        return columns[i] + 1;
    }
    return NULL;
}

/* Begins a dump in memory of the caller, which has `room` rows. For CUDA, the rows and the dump itself must lie in
 * memory that the device can access (cudaMallocManaged). Returns 0, or -1 if the shape is unknown. */
static inline int lostbits_dump_begin_in(lostbits_dump* dump, lostbits_dump_row* rows, unsigned long long room,
                                         const char* shape) {
    dump->rows = rows;
    dump->room = room;
    dump->count = 0;
    dump->shape = shape;
    return lostbits_dump_columns(shape, &dump->primitive) != NULL ? 0 : -1;
}

/* Begins a dump and allocates memory for `room` rows, which `lostbits_dump_end` frees. Returns 0, or -1 if there is not
 * enough memory or the shape is unknown. */
static inline int lostbits_dump_begin(lostbits_dump* dump, unsigned long long room, const char* shape) {
    lostbits_dump_row* const rows = (lostbits_dump_row*)malloc((size_t)room * sizeof(lostbits_dump_row));
    return rows == NULL ? -1 : lostbits_dump_begin_in(dump, rows, room, shape);
}

/* Adds a ray. May be called from any thread. `id` is any number of the caller, such as a pixel or a depth; the tables
 * of `judge --rows` repeat it. `tmin` and `tmax` are the range of the ray (0 and infinity if it has none). `primitive`
 * has the numbers of the primitive. t is ignored if `hit` is 0. */
LOSTBITS_DUMP_ANYWHERE void lostbits_dump_add(lostbits_dump* dump, unsigned id, const LOSTBITS_DUMP_REAL* o,
                                              const LOSTBITS_DUMP_REAL* d, LOSTBITS_DUMP_REAL tmin,
                                              LOSTBITS_DUMP_REAL tmax, const LOSTBITS_DUMP_REAL* primitive, int hit,
                                              LOSTBITS_DUMP_REAL t) {
#if defined(__CUDA_ARCH__)
    const unsigned long long place = atomicAdd(&dump->count, 1ULL);
#else
    const unsigned long long place = __atomic_fetch_add(&dump->count, 1ULL, __ATOMIC_RELAXED);
#endif
    if (place >= dump->room) return;
    lostbits_dump_row* const row = dump->rows + place;
    for (int k = 0; k < 3; ++k) row->number[k] = o[k];
    for (int k = 0; k < 3; ++k) row->number[3 + k] = d[k];
    row->number[6] = tmin;
    row->number[7] = tmax;
    for (int k = 0; k < dump->primitive; ++k) row->number[8 + k] = primitive[k];
    row->number[8 + LOSTBITS_DUMP_MOST] = hit ? t : 0;
    row->id = id;
    row->hit = hit ? 1 : 0;
}

/* Writes the rays that were kept as an .npy file. Returns 0, or -1 if the file could not be written. */
static inline int lostbits_dump_write(const lostbits_dump* dump, const char* path) {
    static const char* const of_ray[] = {"ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax"};
    const int bits = (int)sizeof(LOSTBITS_DUMP_REAL);
    const unsigned long long rows = dump->count < dump->room ? dump->count : dump->room;
    int count = 0;
    const char* const* const names = lostbits_dump_columns(dump->shape, &count);
    FILE* const file = fopen(path, "wb");
    if (file == NULL) return -1;
    /* magic, version 1.0, the header's length, and the header, which ends with a line break at a multiple of 64 bytes
     */
    char header[1024];
    size_t n = (size_t)sprintf(header, "{'descr': [");
    for (int k = 0; k < 8 + count; ++k)
        n += (size_t)sprintf(header + n, "('%s', '<f%d'), ", k < 8 ? of_ray[k] : names[k - 8], bits);
    n += (size_t)sprintf(header + n,
                         "('t', '<f%d'), ('hit', '|u1'), ('id', '<u4')], 'fortran_order': False, 'shape': (%llu,), }",
                         bits, rows);
    while ((10 + n + 1) % 64 != 0) header[n++] = ' ';
    header[n++] = '\n';
    const unsigned char start[10] = {
        0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, (unsigned char)(n & 255), (unsigned char)(n >> 8)};
    size_t wrong = fwrite(start, 1, 10, file) != 10 || fwrite(header, 1, n, file) != n;
    for (unsigned long long i = 0; i < rows; ++i) {
        const lostbits_dump_row* const row = dump->rows + i;
        const unsigned char hit = (unsigned char)row->hit;
        wrong += fwrite(row->number, (size_t)bits, (size_t)(8 + count), file) != (size_t)(8 + count);
        wrong += fwrite(row->number + 8 + LOSTBITS_DUMP_MOST, (size_t)bits, 1, file) != 1;
        wrong += fwrite(&hit, 1, 1, file) != 1;
        wrong += fwrite(&row->id, 4, 1, file) != 1;
    }
    return fclose(file) != 0 || wrong != 0 ? -1 : 0;
}

/* Writes the file and frees the memory of `lostbits_dump_begin`. Returns what `lostbits_dump_write` returns. */
static inline int lostbits_dump_end(lostbits_dump* dump, const char* path) {
    const int written = lostbits_dump_write(dump, path);
    free(dump->rows);
    dump->rows = NULL;
    return written;
}

#endif
