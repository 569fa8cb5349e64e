// Boost.Math 1.74, boost/math/tools/roots.hpp:873 and :886, quadratic_roots: NaN twice is to mean that there are no
// real roots. It also comes where 4 a c overflows; and where b b and 4 a c vanish, two wrong roots come without a word.
// The same equation times a power of two has them right.
//   g++ boost_roots.cpp && ./a.out
#include <cmath>
#include <cstdio>
#include <initializer_list>

#include <boost/math/tools/roots.hpp>

/// quadratic_roots of the equation over the largest power of two in it: exact, and none of the squares overflows.
std::pair<double, double> mended(double a, double b, double c) {
    const int k = -std::ilogb(std::fmax(std::fabs(a), std::fmax(std::fabs(b), std::fabs(c))));
    return boost::math::tools::quadratic_roots(std::scalbn(a, k), std::scalbn(b, k), std::scalbn(c, k));
}

int main() {
    for (const double scale : {1.0, 0x1p520, 0x1p-540}) {  // x^2 - 3 x + 2
        const auto [x0, x1] = boost::math::tools::quadratic_roots(scale, -3 * scale, 2 * scale);
        const auto [m0, m1] = mended(scale, -3 * scale, 2 * scale);
        std::printf("%g (x^2 - 3 x + 2): expected 1 2, got %.17g %.17g, mended %g %g\n", scale, x0, x1, m0, m1);
    }
    const auto [x0, x1] = boost::math::tools::quadratic_roots(1.0, 5e-324, 0.0);  // x^2 + b x
    std::printf("x^2 + 5e-324 x: expected -4.94066e-324 0, got %g %g\n", x0, x1);
}
