// Ranges of rays that are hard to decide: near the t of a surface, exactly there, and one number beside it.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include "measure/seeded.hpp"
#include "measure/truth/truth.hpp"

namespace lostbits::test {

/// An end at one of these t, beside one, between two, or anywhere among the numbers of a format.
inline double end_about(Seeded& rng, std::span<const double> roots, const FloatFormat& storage) {
    const double root = roots[rng.index(static_cast<int>(roots.size()))];
    const double at = stored(root, storage);
    const auto beside = [&](double towards) {
        if (storage != binary32) return std::nextafter(at, towards);
        return static_cast<double>(std::nextafter(static_cast<float>(at), static_cast<float>(towards)));
    };
    switch (rng.index(6)) {
        case 0: return 0;
        case 1: return beside(HUGE_VAL);
        case 2: return beside(0);
        case 3: return stored(root * rng.uniform(0, 2), storage);
        case 4:
            return stored(rng.magnitude(storage == binary32 ? -149 : -1074, storage == binary32 ? 126 : 1022), storage);
        default: return at;
    }
}

/// A range near these t: some ranges contain one number, some none, some have no end, and each end may be open.
inline Range<double> range_about(Seeded& rng, std::span<const double> roots, const FloatFormat& storage) {
    Range<double> range;
    range.tmin = end_about(rng, roots, storage);
    range.tmax = rng.index(4) == 0 ? HUGE_VAL : end_about(rng, roots, storage);
    if (rng.index(8) == 0) range.tmax = range.tmin;
    if (range.tmin > range.tmax && rng.index(8) != 0) std::swap(range.tmin, range.tmax);
    if (std::isinf(range.tmin)) range.tmin = 0;
    if (rng.index(64) == 0) range.tmin = -range.tmin;
    range.open_ends.tmin = rng.coin();
    range.open_ends.tmax = rng.coin();
    return range;
}

/// A range near the t at which a ray enters a primitive and its line leaves it, or as far again.
inline Range<double> range_about_primitive(Seeded& rng, const Ray<double>& ray, const Primitive<double>& primitive,
                                           const FloatFormat& storage) {
    const measure::truth::Truth truth = measure::truth::find_truth(ray, primitive);
    const double t = truth.is_hit() ? measure::truth::round_truth(truth, ray, primitive, binary64) : 1;
    const double least = storage == binary32 ? 0x1p-149 : 0x1p-1074, most = storage == binary32 ? 0x1p126 : 0x1p1022;
    const auto ends = with_span(ray, primitive, [](const auto& span) { return ends_of(span); });
    const double other = ends && std::isfinite(ends->far) ? std::fabs(ends->far) : 2 * t;
    const std::array roots{std::clamp(t, 0.0, most), std::clamp(other, least, most)};
    return range_about(rng, roots, storage);
}

/// The range as C++ that compiles.
inline std::string paste(const Range<double>& range) {
    std::ostringstream out;
    out << std::hexfloat << "Range<double> range{" << range.tmin << ", " << range.tmax << ", {" << range.open_ends.tmin
        << ", " << range.open_ends.tmax << "}};";
    return out.str();
}

}  // namespace lostbits::test
