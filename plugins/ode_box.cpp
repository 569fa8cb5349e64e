// ODE 0.16.2 in double: dCollide of a ray with a box, ode/src/ray.cpp:285. ODE's box is hollow: from inside it returns
// the exit. Centre and lengths are rounded before the call. Directions are limited as in ode.cpp.
#include <algorithm>
#include <cmath>
#include <limits>

#include <ode/ode.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

Answer<double> box(const Ray<double>& r, const CentreBox<double>& b) {
    static const bool ready = dInitODE2(0) != 0;
    static thread_local const bool here = ready && dAllocateODEDataForThread(dAllocateMaskAll) != 0;
    static thread_local const dGeomID ray = here ? dCreateRay(nullptr, 1) : nullptr, box = dCreateBox(nullptr, 1, 1, 1);
    const double d = std::fabs(r.direction[0]) + std::fabs(r.direction[1]) + std::fabs(r.direction[2]);
    if (!(d >= 1e-300 && d < 1e300)) return miss;
    dGeomBoxSetLengths(box, 2 * b.half[0], 2 * b.half[1], 2 * b.half[2]);
    dGeomSetPosition(box, b.centre[0], b.centre[1], b.centre[2]);
    dGeomRaySetLength(ray, std::min(r.end, std::numeric_limits<double>::max()));
    dGeomRaySet(ray, r.origin[0], r.origin[1], r.origin[2], r.direction[0], r.direction[1], r.direction[2]);
    dContactGeom contact;
    return dCollide(ray, box, 1, &contact, sizeof contact) != 0 ? Answer<double>(contact.depth) : miss;
}

LOSTBITS_FORMS(form<box>("ode.box")
                   .unit_direction()
                   .first_root()
                   .inside_exit()
                   .titled("dCollide of ODE, ray and box")
                   .from("ODE 0.16.2, ode/src/ray.cpp:285, dCollideRayBox"))
