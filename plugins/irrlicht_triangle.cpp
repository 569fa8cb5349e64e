// Irrlicht 1.8.5, triangle3d.h:147, getIntersectionWithLine: the point of a line, "also ... not between the start and
// end point", from the plane in double and three questions on which side of an edge it lies, "border-points count also
// as inside". The point is rounded to float, and t read back along the largest component.
#include <triangle3d.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;
using Vector = irr::core::vector3df;

Vector vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

Points<float> triangle(const Ray<float>& ray, const Triangle<float>& s) {
    const irr::core::triangle3df solid(vec(s.a), vec(s.b), vec(s.c));
    Vector point;
    if (!solid.getIntersectionWithLine(vec(ray.origin), vec(ray.direction), point)) return miss;
    const float at[3] = {point.X, point.Y, point.Z};
    return at;
}

LOSTBITS_FORMS(form<triangle>("irrlicht.triangle")
                   .unit_direction()
                   .near_root()
                   .ignores_end()
                   .from("Irrlicht 1.8.5, triangle3d.h:147, getIntersectionWithLine"))
