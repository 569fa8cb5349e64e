// ODE 0.16.2 in double: dCollide of a ray with a sphere, ode/src/ray.cpp:228. The manual: the contact's "depth" is "the
// distance from the start of the ray to the contact point". dGeomRaySet normalises the direction. If a normal cannot be
// normalised, an assertion in Debian's library ends the program. Numbers that would lead there count as a miss.
#include <algorithm>
#include <cmath>
#include <limits>

#include <ode/ode.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;
static_assert(sizeof(dReal) == 8, "ODE in double, as Debian has it");

double size(const double (&v)[3]) { return std::fabs(v[0]) + std::fabs(v[1]) + std::fabs(v[2]); }

Answer<double> sphere(const Ray<double>& r, const Sphere<double>& s) {
    static const bool ready = dInitODE2(0) != 0;
    static thread_local const bool here = ready && dAllocateODEDataForThread(dAllocateMaskAll) != 0;
    static thread_local const dGeomID ray = here ? dCreateRay(nullptr, 1) : nullptr, ball = dCreateSphere(nullptr, 1);
    if (!(size(r.origin) + size(s.centre) + s.radius < 1e150 && s.radius > 1e-160)) return miss;
    if (!(size(r.direction) >= 1e-300 && size(r.direction) < 1e300)) return miss;
    dGeomSphereSetRadius(ball, s.radius), dGeomSetPosition(ball, s.centre[0], s.centre[1], s.centre[2]);
    dGeomRaySetLength(ray, std::min(r.end, std::numeric_limits<double>::max()));
    dGeomRaySet(ray, r.origin[0], r.origin[1], r.origin[2], r.direction[0], r.direction[1], r.direction[2]);
    dContactGeom contact;
    return dCollide(ray, ball, 1, &contact, sizeof contact) != 0 ? Answer<double>(contact.depth) : miss;
}

LOSTBITS_FORMS(form<sphere>("ode.sphere")
                   .unit_direction()
                   .first_root()
                   .titled("dCollide of ODE, ray and sphere")
                   .from("ODE 0.16.2, ode/src/ray.cpp:228, ray_sphere_helper"))
