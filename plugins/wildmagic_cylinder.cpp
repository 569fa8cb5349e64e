// Wild Magic 5.17: IntrLine3Cylinder3::Find (Wm5IntrLine3Cylinder3.cpp:83) for a line and a cylinder of finite height
// (Wm5Cylinder3.h: centre, unit axis, radius, height), with unit directions. It builds a frame from the axis and
// transforms the line into it. Centre, axis and height are rounded before the call. If the axis has no length or is not
// finite, an assertion in Debian's library would end the program; here that counts as a miss.
#include <Wm5IntrLine3Cylinder3.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class T>
Answer<T> cylinder(const Ray<T>& r, const Cylinder<T>& c) {
    const Wm5::Vector3<T> base(c.base[0], c.base[1], c.base[2]), top(c.top[0], c.top[1], c.top[2]);
    const Wm5::Vector3<T> origin(r.origin[0], r.origin[1], r.origin[2]);
    Wm5::Vector3<T> axis = top - base;
    const T height = axis.Normalize();
    if (!(height > 0) || !(axis.SquaredLength() < 2)) return miss;
    const Wm5::Cylinder3<T> primitive(Wm5::Line3<T>((base + top) * T(0.5), axis), c.radius, height);
    T t[2] = {};
    const Wm5::Vector3<T> direction(r.direction[0], r.direction[1], r.direction[2]);
    const int met = Wm5::IntrLine3Cylinder3<T>::Find(origin, direction, primitive, t);
    return met == 0 ? Answer<T>(miss) : Answer<T>(t[0], t[met - 1]);
}

constexpr auto at = "Wild Magic 5.17, Wm5IntrLine3Cylinder3.cpp:83, Find";

LOSTBITS_FORMS(form<cylinder<float>>("wildmagic.cylinder").unit_direction().whole_line().ignores_end().from(at),
               form<cylinder<double>>("wildmagic.cylinder").unit_direction().whole_line().ignores_end().from(at))
