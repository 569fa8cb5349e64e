// Triangles and discs that can be hit from one side or from both, each with a property that fits it or does not.

#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

namespace {

struct Vector {
    double x, y, z;
};
Vector from(const float (&a)[3], const float (&b)[3]) {
    const auto less = [&](int k) { return static_cast<double>(b[k]) - static_cast<double>(a[k]); };
    return {less(0), less(1), less(2)};
}
double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// With s = 1 fronts, with -1 backs, with 0 both.
template <int s>
Answer<float> triangle(const Ray<float>& ray, const Triangle<float>& triangle) {
    const float none[3] = {};
    const Vector d = from(none, ray.direction), e1 = from(triangle.a, triangle.b), e2 = from(triangle.a, triangle.c),
                 o = from(triangle.a, ray.origin);
    const Vector p = cross(d, e2), q = cross(o, e1);
    const double det = dot(e1, p), size = det < 0 ? -det : det, sign = det < 0 ? -1 : 1;
    const double u = sign * dot(o, p), v = sign * dot(d, q), far = sign * dot(e2, q);
    if (s * sign < 0 || size == 0 || u < 0 || v < 0 || u + v > size || far < 0) return miss;
    return static_cast<float>(far / size);
}
/// The same, but the surface on which the ray begins is passed over.
Answer<float> ahead(const Ray<float>& ray, const Triangle<float>& t) {
    const Answer<float> met = triangle<0>(ray, t);
    return met.hit && met.near == 0 ? Answer<float>(miss) : met;
}

template <int s>
Answer<float> disc(const Ray<float>& ray, const Disc<float>& disc) {
    const float none[3] = {};
    const Vector d = from(none, ray.direction), n = from(none, disc.normal), f = from(disc.centre, ray.origin);
    const double m = dot(d, n), t = -dot(f, n) / m;
    if (m == 0 || s * m > 0 || !(t >= 0)) return miss;
    const Vector at{f.x + t * d.x, f.y + t * d.y, f.z + t * d.z};
    const double r2 = dot(at, at), outer = static_cast<double>(disc.outer_radius);
    const double inner = static_cast<double>(disc.inner_radius);
    return r2 <= outer * outer && r2 >= inner * inner ? Answer<float>(static_cast<float>(t)) : miss;
}

/// A ray that lies in the plane hits if `within` is true.
template <bool within>
Answer<float> plane(const Ray<float>& ray, const Plane<float>& plane) {
    const float none[3] = {};
    const Vector d = from(none, ray.direction), n = from(none, plane.normal), f = from(ray.origin, plane.through);
    const double m = dot(d, n), k = dot(f, n);
    if (m == 0) return within && k == 0 ? Answer<float>(0) : miss;
    return k / m >= 0 ? Answer<float>(static_cast<float>(k / m)) : miss;
}

}  // namespace

LOSTBITS_FORMS(form<plane<false>>("word.plane").first_root(),
               form<plane<false>>("word.open_plane").first_root().touching_misses(),
               form<plane<true>>("bad.plane").first_root(), form<triangle<1>>("word.front").first_root().facing_front(),
               form<triangle<-1>>("word.back").first_root().facing_back(), form<triangle<0>>("word.both").first_root(),
               form<ahead>("word.ahead").first_root().origin_misses(), form<ahead>("bad.ahead").first_root(),
               form<disc<1>>("word.disc").first_root().facing_front(), form<triangle<1>>("bad.front").first_root(),
               form<triangle<-1>>("bad.back").first_root(), form<triangle<0>>("bad.both").first_root().facing_front(),
               form<triangle<-1>>("bad.other").first_root().facing_front())
