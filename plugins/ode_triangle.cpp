// ODE 0.16.2, double: dCollide of a ray with a mesh of one two-sided triangle. Debian's library is built with OPCODE
// (OPCODE/OPC_RayTriOverlap.h:16), which computes in float whatever dReal is. The contact's "depth" is the distance.
// Numbers that would lead to an assertion in Debian's library count as a miss, as in ode.cpp.
#include <algorithm>
#include <cmath>
#include <limits>

#include <ode/ode.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

double size(const double (&v)[3]) { return std::fabs(v[0]) + std::fabs(v[1]) + std::fabs(v[2]); }

Answer<double> triangle(const Ray<double>& r, const Triangle<double>& s) {
    static const bool ready = dInitODE2(0) != 0;
    static thread_local const bool here = ready && dAllocateODEDataForThread(dAllocateMaskAll) != 0;
    static thread_local const dGeomID ray = here ? dCreateRay(nullptr, 1) : nullptr;
    static thread_local const dTriMeshDataID data = dGeomTriMeshDataCreate();
    static thread_local const dGeomID mesh = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
    static const dTriIndex order[3] = {0, 1, 2};
    if (!(size(r.origin) + size(s.a) + size(s.b) + size(s.c) < 1e30)) return miss;
    if (!(size(r.direction) >= 1e-300 && size(r.direction) < 1e300)) return miss;
    dGeomTriMeshDataBuildDouble(data, &s, sizeof s.a, 3, order, 3, sizeof order), dGeomTriMeshSetData(mesh, data);
    dGeomRaySetLength(ray, std::min(r.end, double(std::numeric_limits<float>::max())));
    dGeomRaySet(ray, r.origin[0], r.origin[1], r.origin[2], r.direction[0], r.direction[1], r.direction[2]);
    dContactGeom contact;
    return dCollide(ray, mesh, 1, &contact, sizeof contact) != 0 ? Answer<double>(contact.depth) : miss;
}

LOSTBITS_FORMS(form<triangle>("ode.triangle")
                   .unit_direction()
                   .first_root()
                   .from("ODE 0.16.2, OPCODE/OPC_RayTriOverlap.h:16, RayTriOverlap"))
