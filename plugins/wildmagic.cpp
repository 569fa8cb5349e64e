// Wild Magic 5.17: IntrRay3Sphere3::Find (Wm5IntrRay3Sphere3.cpp:60) and IntrRay3Box3::Find (Wm5IntrRay3Box3.cpp:97),
// for unit directions (Wm5Ray3.h). For the sphere, Find returns the ray parameter. For the box it returns points, from
// which t is computed along the direction. A box is a centre and half its size, both rounded before the call.
#include <Wm5IntrRay3Box3.h>
#include <Wm5IntrRay3Sphere3.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class T>
Wm5::Vector3<T> vec(const T (&v)[3]) {
    return {v[0], v[1], v[2]};
}
template <class T>
Answer<T> sphere(const Ray<T>& r, const Sphere<T>& s) {
    const Wm5::Ray3<T> ray(vec(r.origin), vec(r.direction));
    const Wm5::Sphere3<T> ball(vec(s.centre), s.radius);
    Wm5::IntrRay3Sphere3<T> met(ray, ball);
    return met.Find() ? Answer<T>(met.GetRayParameter(0)) : miss;
}
template <class T>
Wm5::Box3<T> box_of(const Box<T>& b) {
    const Wm5::Vector3<T> lo = vec(b.lo), hi = vec(b.hi), half = (hi - lo) * T(0.5);
    return {(hi + lo) * T(0.5),
            Wm5::Vector3<T>::UNIT_X,
            Wm5::Vector3<T>::UNIT_Y,
            Wm5::Vector3<T>::UNIT_Z,
            half[0],
            half[1],
            half[2]};
}
template <class T>
Answer<T> box(const Ray<T>& r, const Box<T>& b) {
    const Wm5::Ray3<T> ray(vec(r.origin), vec(r.direction));
    const Wm5::Box3<T> primitive = box_of(b);
    Wm5::IntrRay3Box3<T> met(ray, primitive);
    return met.Find() ? Answer<T>((met.GetPoint(0) - ray.Origin).Dot(ray.Direction)) : miss;
}

constexpr Form contract(Form form, const char* where) {
    return form.unit_direction().first_root().ignores_end().from(where);
}
constexpr auto at = "Wild Magic 5.17, Wm5IntrRay3Sphere3.cpp:60, Find",
               at_box = "Wild Magic 5.17, Wm5IntrRay3Box3.cpp:97, Find";

LOSTBITS_FORMS(contract(form<sphere<float>>("wildmagic.sphere"), at).origin_exits(),
               contract(form<sphere<double>>("wildmagic.sphere"), at).origin_exits(),
               contract(form<box<float>>("wildmagic.box"), at_box),
               contract(form<box<double>>("wildmagic.box"), at_box))
