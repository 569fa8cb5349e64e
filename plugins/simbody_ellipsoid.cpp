// Simbody 3.7 in double: ContactGeometry::Ellipsoid::intersectsRay (ContactGeometry_Ellipsoid.cpp) for an ellipsoid
// around the origin, with a UnitVec3. As in simbody.cpp, the centre is subtracted from the origin before the call.
#include <SimTKmath.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;
using SimTK::Vec3;

Answer<double> ellipsoid(const Ray<double>& r, const Ellipsoid<double>& e) {
    static thread_local SimTK::ContactGeometry::Ellipsoid primitive(Vec3(1));
    primitive.setRadii(Vec3(e.radii[0], e.radii[1], e.radii[2]));
    const Vec3 from(r.origin[0] - e.centre[0], r.origin[1] - e.centre[1], r.origin[2] - e.centre[2]);
    const SimTK::UnitVec3 unit(Vec3(r.direction[0], r.direction[1], r.direction[2]), true);  // is unit
    double t = 0;
    SimTK::UnitVec3 normal;
    return primitive.intersectsRay(from, unit, t, normal) ? Answer<double>(t) : miss;
}

LOSTBITS_FORMS(form<ellipsoid>("simbody.ellipsoid")
                   .unit_direction()
                   .first_root()
                   .origin_exits()
                   .ignores_end()
                   .from("Simbody 3.7, ContactGeometry_Ellipsoid.cpp, intersectsRay"))
