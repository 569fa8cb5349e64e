// Irrlicht 1.8.5, line3d.h:113, getIntersectionWithSphere: "the distance to the first intersection point" of a line
// through two points, which may lie behind the first of them. And aabbox3d.h:253, intersectsWithLine, which returns a
// bool for the segment between two points. The line is made from the origin and a point on the ray. For a box that
// point lies behind the box.
#include <algorithm>

#include <aabbox3d.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;
using Vector = irr::core::vector3df;

Vector vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

Answer<float> sphere(const Ray<float>& ray, const Sphere<float>& s) {
    double t = 0;
    const irr::core::line3df line(vec(ray.origin), vec(ray.origin) + vec(ray.direction));
    if (!line.getIntersectionWithSphere(vec(s.centre), s.radius, t)) return miss;
    return {float(t)};
}
bool box(const Ray<float>& ray, const Box<float>& b) {
    const irr::core::aabbox3df box(vec(b.lo), vec(b.hi));
    const float length =
        std::min(ray.end, (box.getCenter() - vec(ray.origin)).getLength() + box.getExtent().getLength());
    return box.intersectsWithLine({vec(ray.origin), vec(ray.origin) + vec(ray.direction) * length});
}

LOSTBITS_FORMS(form<sphere>("irrlicht.sphere")
                   .unit_direction()
                   .near_root()
                   .inside_near()
                   .ignores_end()
                   .from("Irrlicht 1.8.5, line3d.h:113, getIntersectionWithSphere"),
               form<box>("irrlicht.box").unit_direction().from("Irrlicht 1.8.5, aabbox3d.h:253, intersectsWithLine"))
