// A stranger's program: one ray, one form in float, the certified truth, and the bits between them.
#include <cstdio>

#include <lostbits/intersect/catalogue.hpp>
#include <lostbits/measure/truth/lost_bits.hpp>
#include <lostbits/measure/truth/truth.hpp>

#if __has_include("number/error.hpp") || __has_include(<measure/truth/truth.hpp>)
#error "a header of ours is found under a name that is anybody's"
#endif

int main() {
    using namespace lostbits;
    using namespace lostbits::measure::truth;
    const Ray<float> ray{{0, 0, 5}, {0, 0, -1}};
    const Sphere<float> sphere{{0, 0, 0}, 1};
    const Hit<float> hit = intersect::sphere::Unified::intersect(ray, sphere);

    const Sphere<double> exact_sphere{{0, 0, 0}, 1};
    const Truth truth = find_truth({{0, 0, 5}, {0, 0, -1}}, exact_sphere);
    const double ulps = ulp_error(hit.t, truth.t, binary32);
    std::printf("t = %g, lost bits = %g\n", static_cast<double>(hit.t), lost_bits(ulps, 24));
    return hit.hit ? 0 : 1;
}
