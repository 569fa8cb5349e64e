// Wild Magic 5.17: IntrRay3Triangle3::Find (Wm5IntrRay3Triangle3.cpp:98), for unit directions (Wm5Ray3.h). It treats
// |d.n| <= ZERO_TOLERANCE, with n = e1 x e2, as "Ray and triangle are parallel, call it a no intersection".
#include <Wm5IntrRay3Triangle3.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class T>
Wm5::Vector3<T> vec(const T (&v)[3]) {
    return {v[0], v[1], v[2]};
}
template <class T>
Answer<T> triangle(const Ray<T>& r, const Triangle<T>& s) {
    const Wm5::Ray3<T> ray(vec(r.origin), vec(r.direction));
    const Wm5::Triangle3<T> primitive(vec(s.a), vec(s.b), vec(s.c));
    Wm5::IntrRay3Triangle3<T> met(ray, primitive);
    return met.Find() ? Answer<T>(met.GetRayParameter()) : miss;
}

constexpr Form contract(Form form) {
    return form.unit_direction().first_root().ignores_end().from("Wild Magic 5.17, Wm5IntrRay3Triangle3.cpp:98, Find");
}

LOSTBITS_FORMS(contract(form<triangle<float>>("wildmagic.triangle")),
               contract(form<triangle<double>>("wildmagic.triangle")))
