// Irrlicht 1.8.5, triangle3d.h:147, getIntersectionWithLine: the point of a line, "also ... not between the start and
// end point". It intersects with the plane in double, then tests three times on which side of an edge the point lies,
// where "border-points count also as inside". The point is rounded to float. t is computed from it along the largest
// component of the direction.
#include <triangle3d.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;
using Vector = irr::core::vector3df;

Vector vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

Points<float> triangle(const Ray<float>& ray, const Triangle<float>& s) {
    const irr::core::triangle3df primitive(vec(s.a), vec(s.b), vec(s.c));
    Vector point;
    if (!primitive.getIntersectionWithLine(vec(ray.origin), vec(ray.direction), point)) return miss;
    const float at[3] = {point.X, point.Y, point.Z};
    return at;
}

LOSTBITS_FORMS(form<triangle>("irrlicht.triangle")
                   .unit_direction()
                   .near_root()
                   .ignores_end()
                   .from("Irrlicht 1.8.5, triangle3d.h:147, getIntersectionWithLine"))
