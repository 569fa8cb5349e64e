// Imath 3.1.6. ImathSphere.h:115, Sphere3::intersectT: "the smallest t with t >= 0 so that l(t) is a point on the
// sphere"; it leaves a = d.d out, so d is of unit length. ImathBoxAlgo.h:642, intersects: "true if the ray starts inside
// the box or if the ray starts outside and intersects the box", as a yes or no; and :372, findEntryAndExitPoints, whose
// points "may be on either side of the ray's origin". Their t is read along the largest component of the direction.
#include <cmath>

#include <ImathBoxAlgo.h>
#include <ImathSphere.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class T>
Imath::Line3<T> line(const Ray<T>& ray) {
    Imath::Line3<T> l;  // of two points it would make a direction of its own
    l.pos.setValue(ray.origin[0], ray.origin[1], ray.origin[2]);
    l.dir.setValue(ray.direction[0], ray.direction[1], ray.direction[2]);
    return l;
}
template <class T>
Imath::Box<Imath::Vec3<T>> box(const Box<T>& b) {
    return {{b.lo[0], b.lo[1], b.lo[2]}, {b.hi[0], b.hi[1], b.hi[2]}};
}
template <class T>
Answer<T> sphere(const Ray<T>& ray, const Sphere<T>& s) {
    T t = 0;
    const Imath::Sphere3<T> ball({s.centre[0], s.centre[1], s.centre[2]}, s.radius);
    return ball.intersectT(line(ray), t) ? Answer<T>(t) : miss;
}
template <class T>
bool meets_box(const Ray<T>& ray, const Box<T>& b) {
    return Imath::intersects(box(b), line(ray));
}
template <class T>
Answer<T> box_points(const Ray<T>& ray, const Box<T>& b) {
    Imath::Vec3<T> in, out;
    if (!Imath::findEntryAndExitPoints(line(ray), box(b), in, out)) return miss;
    int k = std::fabs(ray.direction[1]) > std::fabs(ray.direction[0]) ? 1 : 0;
    if (std::fabs(ray.direction[2]) > std::fabs(ray.direction[k])) k = 2;
    return {(in[k] - ray.origin[k]) / ray.direction[k], (out[k] - ray.origin[k]) / ray.direction[k]};
}

constexpr Form of_sphere(Form form) {
    return form.unit_direction().first_root().ignores_end().titled("Sphere3::intersectT of Imath").from(
        "Imath 3.1.6, ImathSphere.h:97, Sphere3::intersectT");
}
constexpr Form of_box(Form form) {
    return form.titled("intersects of Imath").from("Imath 3.1.6, ImathBoxAlgo.h:642, intersects");
}
constexpr Form of_points(Form form) {
    return form.whole_line().ignores_end().titled("findEntryAndExitPoints of Imath").from(
        "Imath 3.1.6, ImathBoxAlgo.h:372, findEntryAndExitPoints");
}

LOSTBITS_FORMS(of_sphere(form<sphere<float>>("imath.sphere")), of_sphere(form<sphere<double>>("imath.sphere")),
               of_box(form<meets_box<float>>("imath.box")), of_box(form<meets_box<double>>("imath.box")),
               of_points(form<box_points<float>>("imath.box_points")),
               of_points(form<box_points<double>>("imath.box_points")))
