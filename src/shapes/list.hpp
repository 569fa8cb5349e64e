// All shapes. Each shape has one line, with its folder and its struct, and one include.
// `LOSTBITS_SHAPE_FILE(folder)` says which file of the folder is included, so this header has no `#pragma once`.
// The list has two parts, so that the forms of each part are compiled by themselves: a change of a form then compiles
// half of the forms. If `LOSTBITS_SHAPE_PART` is 1 or 2, only files of that part are included.
// clang-format off
#define LOSTBITS_FIRST_SHAPES(line) \
    line(sphere, Sphere) \
    line(box, Box) \
    line(triangle, Triangle)
#define LOSTBITS_SECOND_SHAPES(line) \
    line(ellipsoid, Ellipsoid) \
    line(cylinder, Cylinder) \
    line(capsule, Capsule) \
    line(tube, Tube) \
    line(cone, Cone) \
    line(disc, Disc) \
    line(plane, Plane) \
    line(torus, Torus)
#define LOSTBITS_SHAPES(line) LOSTBITS_FIRST_SHAPES(line) LOSTBITS_SECOND_SHAPES(line)
// clang-format on

#if !defined(LOSTBITS_SHAPE_PART) || LOSTBITS_SHAPE_PART == 1
#include LOSTBITS_SHAPE_FILE(sphere)
#include LOSTBITS_SHAPE_FILE(box)
#include LOSTBITS_SHAPE_FILE(triangle)
#endif

#if !defined(LOSTBITS_SHAPE_PART) || LOSTBITS_SHAPE_PART == 2
#include LOSTBITS_SHAPE_FILE(ellipsoid)
#include LOSTBITS_SHAPE_FILE(cylinder)
#include LOSTBITS_SHAPE_FILE(capsule)
#include LOSTBITS_SHAPE_FILE(tube)
#include LOSTBITS_SHAPE_FILE(cone)
#include LOSTBITS_SHAPE_FILE(disc)
#include LOSTBITS_SHAPE_FILE(plane)
#include LOSTBITS_SHAPE_FILE(torus)
#endif

#undef LOSTBITS_SHAPE_FILE
#undef LOSTBITS_SHAPE_PART
