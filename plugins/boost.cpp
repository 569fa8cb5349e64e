// Boost.Math 1.74, tools/roots.hpp:1003, quadratic_roots: "the real roots of a quadratic equation ax^2 + bx + c = 0".
// It returns NaN twice if no root is real. The coefficients of the sphere are the schoolbook's. The discriminant
// (roots.hpp:873) is Kahan's with fma, and the second root is c / q.
#include <cmath>

#include <boost/math/tools/roots.hpp>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class T>
Answer<T> sphere(const Ray<T>& ray, const SphereAtOrigin<T>& s) {
    const T *const f = ray.origin, *const d = ray.direction;
    const T a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const T b = 2 * (f[0] * d[0] + f[1] * d[1] + f[2] * d[2]);
    const T c = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] - s.radius * s.radius;
    const auto roots = boost::math::tools::quadratic_roots(a, b, c);
    if (std::isnan(roots.first)) return miss;
    return {static_cast<T>(roots.first), static_cast<T>(roots.second)};
}

constexpr Form contract(Form form) {
    return form.whole_line()
        .ignores_end()
        .titled("quadratic_roots of Boost.Math")
        .from("Boost 1.74, boost/math/tools/roots.hpp:1003, quadratic_roots");
}

LOSTBITS_FORMS(contract(form<sphere<float>>("boost.sphere")), contract(form<sphere<double>>("boost.sphere")))
