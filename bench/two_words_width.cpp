// Compiled once for each register width.
#include "number/wide/wide_pack.hpp"
#include "number/width.hpp"
#include "shapes/sphere/forms/filtered_steps.hpp"
#include "two_words.hpp"

namespace bench {
namespace {

using namespace lostbits;
using P = Pack<double, BuildRegisters>;

[[gnu::flatten]] void sphere_loop(const double* const rays[6], const double* sphere, double* const answers[3],
                                  unsigned char* hit, std::size_t n) {
    const Sphere<P> primitive{{P(sphere[0]), P(sphere[1]), P(sphere[2])}, P(sphere[3])};
    for (std::size_t i = 0; i < n; i += P::lanes) {
        const auto at = [&](int column) { return P::load(rays[column] + i); };
        const Ray<P> ray{{at(0), at(1), at(2)}, {at(3), at(4), at(5)}};
        const auto found = intersect::sphere::filtered::decide_in_wider<number::wide::TwoWords<P>, P>(ray, primitive);
        for (int k = 0; k < 3; ++k) found.t.store(answers[k] + i);
        (found.is_proved && found.hit).store(reinterpret_cast<bool*>(hit + i));
    }
}

}  // namespace

by_hand::OnePrimitive<double> LOSTBITS_WITH_WIDTH_SUFFIX(two_words)() { return sphere_loop; }

}  // namespace bench
