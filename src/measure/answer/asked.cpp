#include "measure/answer/asked.hpp"

#include <array>
#include <cmath>
#include <span>

#include "intersect/simd/packed.hpp"

namespace lostbits::measure::answer {

std::optional<double> ask_one(const intersect::table::Intersector& row, const Format& format, const Ray<double>& ray,
                              const Solid<double>& solid, double tmax) {
    std::optional<double> answer;
    intersect::simd::with_kernel(row, {row.info, row.native32, row.native64}, format, [&]<class S>(const auto& kernel) {
        const auto& [o, d] = ray;
        const std::array<S, 6> x{static_cast<S>(o.x), static_cast<S>(o.y), static_cast<S>(o.z),
                                 static_cast<S>(d.x), static_cast<S>(d.y), static_cast<S>(d.z)};
        const auto one = [](const S& value) { return std::span(&value, 1); };
        const S end = static_cast<S>(tmax);
        intersect::table::RayBatch<S> rays{one(x[0]), one(x[1]), one(x[2]), one(x[3]), one(x[4]), one(x[5])};
        if (!std::isinf(tmax)) rays.tmax = one(end);
        S t{}, near{}, far{};
        std::uint8_t hit = 0;
        kernel(rays, intersect::Target<S>(transformed(solid, [](double n) { return static_cast<S>(n); })),
               intersect::table::HitBatch<S>{std::span(&t, 1), std::span(&near, 1), std::span(&far, 1),
                                             std::span(&hit, 1)});
        if (hit != 0) answer = static_cast<double>(t);
    });
    return answer;
}

}  // namespace lostbits::measure::answer
