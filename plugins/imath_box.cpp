// Imath 3.1.6, ImathBoxAlgo.h:642, intersects: "true if the ray starts inside the box or if the ray starts outside and
// intersects the box". It returns a bool. And :372, findEntryAndExitPoints, whose points "may be on either side of the
// ray's origin". lostbits_plugin.hpp computes t from these points.
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
Points<T> points(const Ray<T>& ray, const Box<T>& box) {
    Imath::Vec3<T> in, out;
    return find(ray, box, &in, &out) ? Points<T>(in, out) : miss;
}

constexpr auto at = "Imath 3.1.6, ImathBoxAlgo.h:642, intersects";
constexpr auto at_points = "Imath 3.1.6, ImathBoxAlgo.h:372, findEntryAndExitPoints";

LOSTBITS_FORMS(form<meets<float>>("imath.box").ignores_end().from(at),
               form<meets<double>>("imath.box").ignores_end().from(at),
               form<points<float>>("imath.box_points").whole_line().ignores_end().from(at_points),
               form<points<double>>("imath.box_points").whole_line().ignores_end().from(at_points))
