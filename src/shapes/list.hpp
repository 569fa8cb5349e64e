// All shapes. Each shape has one line, with its folder and its struct, and one include.
// `LOSTBITS_SHAPE_FILE(folder)` says which file of the folder is included, so this header has no `#pragma once`.
// clang-format off
#define LOSTBITS_SHAPES(line) \
    line(sphere, Sphere) \
    line(box, Box) \
    line(triangle, Triangle) \
    line(ellipsoid, Ellipsoid) \
    line(cylinder, Cylinder) \
    line(capsule, Capsule) \
    line(tube, Tube) \
    line(cone, Cone) \
    line(disc, Disc) \
    line(plane, Plane) \
    line(torus, Torus)
// clang-format on

#include LOSTBITS_SHAPE_FILE(sphere)
#include LOSTBITS_SHAPE_FILE(box)
#include LOSTBITS_SHAPE_FILE(triangle)
#include LOSTBITS_SHAPE_FILE(ellipsoid)
#include LOSTBITS_SHAPE_FILE(cylinder)
#include LOSTBITS_SHAPE_FILE(capsule)
#include LOSTBITS_SHAPE_FILE(tube)
#include LOSTBITS_SHAPE_FILE(cone)
#include LOSTBITS_SHAPE_FILE(disc)
#include LOSTBITS_SHAPE_FILE(plane)
#include LOSTBITS_SHAPE_FILE(torus)

#undef LOSTBITS_SHAPE_FILE
