// Simbody 3.7 in double: ContactGeometry::Sphere::intersectsRay (ContactGeometry_Sphere.cpp:84) for a sphere around the
// origin, and OrientedBoundingBox::intersectsRay (OrientedBoundingBox.cpp:258) for a box with one corner at its
// transform. Both take a UnitVec3. t is "the distance from the ray origin to the intersection point". Before the call,
// the centre is subtracted from the ray's origin, and the size of the box is rounded.
#include <SimTKmath.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;
using SimTK::Vec3;

SimTK::UnitVec3 unit(const Ray<double>& r) {
    return SimTK::UnitVec3(Vec3(r.direction[0], r.direction[1], r.direction[2]), true);  // is unit
}
Answer<double> sphere(const Ray<double>& r, const Sphere<double>& s) {
    static thread_local SimTK::ContactGeometry::Sphere ball(1);
    ball.setRadius(s.radius);
    const Vec3 from(r.origin[0] - s.centre[0], r.origin[1] - s.centre[1], r.origin[2] - s.centre[2]);
    double t = 0;
    SimTK::UnitVec3 normal;
    return ball.intersectsRay(from, unit(r), t, normal) ? Answer<double>(t) : miss;
}
Answer<double> box(const Ray<double>& r, const Box<double>& b) {
    const Vec3 lo(b.lo[0], b.lo[1], b.lo[2]);
    const SimTK::OrientedBoundingBox box(SimTK::Transform(lo), Vec3(b.hi[0], b.hi[1], b.hi[2]) - lo);
    double t = 0;
    return box.intersectsRay(Vec3(r.origin[0], r.origin[1], r.origin[2]), unit(r), t) ? Answer<double>(t) : miss;
}

LOSTBITS_FORMS(form<sphere>("simbody.sphere")
                   .unit_direction()
                   .first_root()
                   .origin_exits()
                   .ignores_end()
                   .from("Simbody 3.7, ContactGeometry_Sphere.cpp:84, intersectsRay"),
               form<box>("simbody.box")
                   .unit_direction()
                   .first_root()
                   .ignores_end()
                   .from("Simbody 3.7, OrientedBoundingBox.cpp:258, intersectsRay"))
