// ODE 0.16.2 in double: dCollide of a ray with a cylinder, ode/src/ray.cpp, dCollideRayCylinder. A cylinder of ODE lies
// along z and has a rotation and a centre, which are computed here. Directions are limited as in ode.cpp.
#include <algorithm>
#include <cmath>
#include <limits>

#include <ode/ode.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

Answer<double> cylinder(const Ray<double>& r, const Cylinder<double>& c) {
    static const bool ready = dInitODE2(0) != 0;
    static thread_local const bool here = ready && dAllocateODEDataForThread(dAllocateMaskAll) != 0;
    static thread_local const dGeomID ray = here ? dCreateRay(nullptr, 1) : nullptr,
                                      tin = dCreateCylinder(nullptr, 1, 1);
    const double d = std::fabs(r.direction[0]) + std::fabs(r.direction[1]) + std::fabs(r.direction[2]);
    double v[3], middle[3];
    for (int k = 0; k < 3; ++k) v[k] = c.top[k] - c.base[k], middle[k] = (c.base[k] + c.top[k]) / 2;
    const double height = length(v);
    if (!(d >= 1e-300 && d < 1e300 && height > 1e-150 && height < 1e150 && c.radius < 1e150)) return miss;
    dMatrix3 turned;
    dRFromZAxis(turned, v[0], v[1], v[2]);
    dGeomCylinderSetParams(tin, c.radius, height);
    dGeomSetRotation(tin, turned), dGeomSetPosition(tin, middle[0], middle[1], middle[2]);
    dGeomRaySetLength(ray, std::min(r.end, std::numeric_limits<double>::max()));
    dGeomRaySet(ray, r.origin[0], r.origin[1], r.origin[2], r.direction[0], r.direction[1], r.direction[2]);
    dContactGeom contact;
    return dCollide(ray, tin, 1, &contact, sizeof contact) != 0 ? Answer<double>(contact.depth) : miss;
}

LOSTBITS_FORMS(form<cylinder>("ode.cylinder")
                   .unit_direction()
                   .first_root()
                   .origin_misses()
                   .titled("dCollide of ODE, ray and cylinder")
                   .from("ODE 0.16.2, ode/src/ray.cpp, dCollideRayCylinder"))
