// Imath 3.1.6, ImathLineAlgo.h:80, intersect of a line and a triangle: false if "line and plane are nearly parallel
// or ... the triangle's area is very small". It returns a point of the line, which may lie behind the origin. t is
// computed from the point, along the largest component of the direction. The distance is divided by the plane's before
// the point is computed.
#include <ImathLineAlgo.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class T>
Imath::Vec3<T> vec(const T (&v)[3]) {
    return {v[0], v[1], v[2]};
}
template <class T>
Points<T> triangle(const Ray<T>& ray, const Triangle<T>& s) {
    Imath::Line3<T> line;  // its constructor from two points would normalise the direction again
    line.pos = vec(ray.origin), line.dir = vec(ray.direction);
    Imath::Vec3<T> point, weights;
    bool front = false;
    if (!Imath::intersect(line, vec(s.a), vec(s.b), vec(s.c), point, weights, front)) return miss;
    return point;
}

constexpr Form contract(Form form) {
    return form.unit_direction().near_root().ignores_end().from("Imath 3.1.6, ImathLineAlgo.h:80, intersect");
}

LOSTBITS_FORMS(contract(form<triangle<float>>("imath.triangle")), contract(form<triangle<double>>("imath.triangle")))
