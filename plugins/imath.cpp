// Imath 3.1.6, ImathSphere.h:106, Sphere3::intersectT: "the smallest t with t >= 0 so that l(t) is a point on the
// sphere". Its quadratic leaves out a = d.d, so d must have unit length. A Line3 made from two points has such a d.
#include <ImathSphere.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class T>
Answer<T> sphere(const Ray<T>& ray, const Sphere<T>& s) {
    Imath::Line3<T> line;  // its constructor from two points would normalise the direction again
    line.pos.setValue(ray.origin[0], ray.origin[1], ray.origin[2]);
    line.dir.setValue(ray.direction[0], ray.direction[1], ray.direction[2]);
    T t = 0;
    const Imath::Sphere3<T> ball({s.centre[0], s.centre[1], s.centre[2]}, s.radius);
    return ball.intersectT(line, t) ? Answer<T>(t) : miss;
}

constexpr Form contract(Form form) {
    return form.unit_direction()
        .first_root()
        .ignores_end()
        .titled("Sphere3::intersectT of Imath")
        .from("Imath 3.1.6, ImathSphere.h:106, Sphere3::intersectT");
}

LOSTBITS_FORMS(contract(form<sphere<float>>("imath.sphere")), contract(form<sphere<double>>("imath.sphere")))
