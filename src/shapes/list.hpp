// The closed list of shapes: for each a line, with its folder and its struct, and an include. What is included of the
// folder is what `LOSTBITS_SHAPE_FILE(folder)` says, so that there is no `#pragma once`.
// clang-format off
#define LOSTBITS_SHAPES(line) \
    line(sphere, Sphere) \
    line(box, Box) \
    line(triangle, Triangle) \
    line(ellipsoid, Ellipsoid) \
    line(cylinder, Cylinder) \
    line(capsule, Capsule)
// clang-format on

#include LOSTBITS_SHAPE_FILE(sphere)
#include LOSTBITS_SHAPE_FILE(box)
#include LOSTBITS_SHAPE_FILE(triangle)
#include LOSTBITS_SHAPE_FILE(ellipsoid)
#include LOSTBITS_SHAPE_FILE(cylinder)
#include LOSTBITS_SHAPE_FILE(capsule)

#undef LOSTBITS_SHAPE_FILE
