// Imath 3.1.6, ImathBoxAlgo.h:642, intersects: "true if the ray starts inside the box or if the ray starts outside and
// intersects the box", as a yes or no; and :372, findEntryAndExitPoints, whose points "may be on either side of the
// ray's origin". Of those, t is read back along the largest component of the direction.
#include <cmath>

#include <ImathBoxAlgo.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class T>
bool find(const Ray<T>& r, const Box<T>& b, Imath::Vec3<T>* in, Imath::Vec3<T>* out) {
    Imath::Line3<T> line;
    line.pos.setValue(r.origin[0], r.origin[1], r.origin[2]);
    line.dir.setValue(r.direction[0], r.direction[1], r.direction[2]);
    const Imath::Box<Imath::Vec3<T>> box({b.lo[0], b.lo[1], b.lo[2]}, {b.hi[0], b.hi[1], b.hi[2]});
    return in ? Imath::findEntryAndExitPoints(line, box, *in, *out) : Imath::intersects(box, line);
}
template <class T>
bool meets(const Ray<T>& ray, const Box<T>& box) {
    return find<T>(ray, box, nullptr, nullptr);
}
template <class T>
Answer<T> points(const Ray<T>& ray, const Box<T>& box) {
    Imath::Vec3<T> in, out;
    if (!find(ray, box, &in, &out)) return miss;
    int k = std::fabs(ray.direction[1]) > std::fabs(ray.direction[0]) ? 1 : 0;
    if (std::fabs(ray.direction[2]) > std::fabs(ray.direction[k])) k = 2;
    return {(in[k] - ray.origin[k]) / ray.direction[k], (out[k] - ray.origin[k]) / ray.direction[k]};
}

constexpr auto at = "Imath 3.1.6, ImathBoxAlgo.h:642, intersects";
constexpr auto at_points = "Imath 3.1.6, ImathBoxAlgo.h:372, findEntryAndExitPoints";

LOSTBITS_FORMS(form<meets<float>>("imath.box").from(at), form<meets<double>>("imath.box").from(at),
               form<points<float>>("imath.box_points").whole_line().ignores_end().from(at_points),
               form<points<double>>("imath.box_points").whole_line().ignores_end().from(at_points))
