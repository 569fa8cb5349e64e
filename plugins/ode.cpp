// ODE 0.16.2 (double in Debian): dCollide of a ray with a sphere (ode/src/ray.cpp:180) and with a box (:240). The manual
// says of a ray's contact: "depth" is "the distance from the ray's start to the point of contact"; dGeomRaySet
// normalises the direction. A ray that starts inside meets the surface where it leaves: the box is hollow. So that the
// answer is that of a solid box, t is 0 here where dGeomBoxPointDepth says that the origin is not outside.
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <ode/ode.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;
static_assert(sizeof(dReal) == 8, "ODE in double, as Debian has it");

Answer<double> collide(const Ray<double>& r, dGeomID solid) {
    const auto& [o, d] = std::tie(r.origin, r.direction);  // dNormalize3 ends the program on a length of 0 or NaN
    if (!std::isfinite(o[0] + o[1] + o[2]) || !(std::hypot(d[0], d[1], d[2]) > 0)) return miss;
    static const bool ready = dInitODE2(0) != 0;
    static thread_local const bool here = ready && dAllocateODEDataForThread(dAllocateMaskAll) != 0;
    static thread_local const dGeomID ray = here ? dCreateRay(nullptr, 1) : nullptr;
    dGeomRaySetLength(ray, std::min(r.end, std::numeric_limits<double>::max()));
    dGeomRaySet(ray, r.origin[0], r.origin[1], r.origin[2], r.direction[0], r.direction[1], r.direction[2]);
    dContactGeom contact;
    return dCollide(ray, solid, 1, &contact, sizeof contact) != 0 ? Answer<double>(contact.depth) : miss;
}
Answer<double> sphere(const Ray<double>& ray, const Sphere<double>& s) {
    if (s.radius == 0) return miss;  // the normal of the contact would have no length
    static thread_local const dGeomID ball = (dInitODE2(0), dCreateSphere(nullptr, 1));
    dGeomSphereSetRadius(ball, s.radius), dGeomSetPosition(ball, s.centre[0], s.centre[1], s.centre[2]);
    return collide(ray, ball);
}
Answer<double> box(const Ray<double>& ray, const Box<double>& b) {
    static thread_local const dGeomID box = (dInitODE2(0), dCreateBox(nullptr, 1, 1, 1));
    dGeomBoxSetLengths(box, b.hi[0] - b.lo[0], b.hi[1] - b.lo[1], b.hi[2] - b.lo[2]);
    dGeomSetPosition(box, (b.lo[0] + b.hi[0]) / 2, (b.lo[1] + b.hi[1]) / 2, (b.lo[2] + b.hi[2]) / 2);
    if (dGeomBoxPointDepth(box, ray.origin[0], ray.origin[1], ray.origin[2]) >= 0) return {0.0};
    return collide(ray, box);
}

constexpr Form of(Form form, const char* title, const char* where) {
    return form.unit_direction().first_root().titled(title).from(where);
}

LOSTBITS_FORMS(of(form<sphere>("ode.sphere"), "dCollide of ODE, ray and sphere", "ODE 0.16.2, ode/src/ray.cpp:180"),
               of(form<box>("ode.box"), "dCollide of ODE, ray and box", "ODE 0.16.2, ode/src/ray.cpp:240"))
