// OpenVDB 10.0.1, math/Ray.h:183 and :233, Ray::intersects of a sphere and of a box. It promises the first and second
// intersection. t0 and t1 are clipped to the ray's time span, so from inside t0 is the start of the span. Here the span
// goes from the lowest to the largest number, so that neither root is clipped.
#include <limits>

#include <openvdb/math/BBox.h>
#include <openvdb/math/Ray.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class T>
openvdb::math::Ray<T> whole(const Ray<T>& r) {
    constexpr T most = std::numeric_limits<T>::max();
    return {{r.origin[0], r.origin[1], r.origin[2]}, {r.direction[0], r.direction[1], r.direction[2]}, -most, most};
}
template <class T>
Answer<T> sphere(const Ray<T>& ray, const Sphere<T>& s) {
    T near = 0, far = 0;
    if (!whole(ray).intersects({s.centre[0], s.centre[1], s.centre[2]}, s.radius, near, far)) return miss;
    return {near, far};
}
template <class T>
Answer<T> box(const Ray<T>& ray, const Box<T>& b) {
    T near = 0, far = 0;
    const openvdb::math::BBox<openvdb::math::Vec3<T>> box({b.lo[0], b.lo[1], b.lo[2]}, {b.hi[0], b.hi[1], b.hi[2]});
    return whole(ray).intersects(box, near, far) ? Answer<T>(near, far) : miss;
}

constexpr Form contract(Form form, const char* where) {
    return form.whole_line().ignores_end().titled("math::Ray::intersects of OpenVDB").from(where);
}
constexpr auto at_sphere = "OpenVDB 10.0.1, math/Ray.h:183, Ray::intersects(center, radius, t0, t1)";
constexpr auto at_box = "OpenVDB 10.0.1, math/Ray.h:233, Ray::intersects(bbox, t0, t1)";

LOSTBITS_FORMS(contract(form<sphere<float>>("openvdb.sphere"), at_sphere),
               contract(form<sphere<double>>("openvdb.sphere"), at_sphere),
               contract(form<box<float>>("openvdb.box"), at_box), contract(form<box<double>>("openvdb.box"), at_box))
