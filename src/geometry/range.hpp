// The range of a ray in which hits count.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace lostbits {

/// Ends of a range that do not belong to it.
struct OpenEnds {
    bool tmin = false, tmax = false;
    friend auto operator<=>(const OpenEnds&, const OpenEnds&) = default;
};

/// Names of the open ends in files and on the command line.
inline constexpr std::array<std::pair<std::string_view, OpenEnds>, 4> open_ends_names{
    {{"none", {}}, {"tmin", {.tmin = true}}, {"tmax", {.tmax = true}}, {"both", {.tmin = true, .tmax = true}}}};
inline constexpr std::string_view name_of(OpenEnds open) {
    return open_ends_names[(open.tmin ? 1U : 0U) + (open.tmax ? 2U : 0U)].first;
}
/// Converts a name; it must be one of the above.
inline constexpr OpenEnds open_ends_named(std::string_view name) {
    for (const auto& [known, open] : open_ends_names)
        if (known == name) return open;
    return {};
}

/// The t at which hits of a ray count: tmin ≤ t ≤ tmax, with < at an open end. A ray looks ahead, so tmin is finite and
/// at least 0. If tmax is infinity, the ray has no end.
template <class T>
struct Range {
    T tmin = 0;
    T tmax = std::numeric_limits<T>::infinity();
    OpenEnds open = {};

    /// The same numbers of this format as a range with both ends closed: t > tmin becomes t ≥ the next number above
    /// tmin. A tmax of infinity stays infinity.
    [[nodiscard]] Range closed() const {
        constexpr T nowhere = std::numeric_limits<T>::infinity();
        Range all{tmin, tmax};
        if (open.tmin) all.tmin = std::nextafter(tmin, nowhere);
        if (open.tmax && tmax < nowhere) all.tmax = std::nextafter(tmax, -nowhere);
        return all;
    }
    /// True if the range holds everything ahead of the origin.
    [[nodiscard]] bool is_whole() const {
        return tmin == 0 && tmax == std::numeric_limits<T>::infinity() && !open.tmin;
    }
    /// True if some t is in the range; false if an end is NaN.
    [[nodiscard]] bool holds_any() const {
        if (!(tmin >= 0 && tmin < std::numeric_limits<T>::infinity())) return false;
        return tmin < tmax || (tmin == tmax && !open.tmin && !open.tmax);
    }
    [[nodiscard]] bool is_before(const T& t) const { return open.tmin ? t <= tmin : t < tmin; }
    [[nodiscard]] bool is_after(const T& t) const {
        return open.tmax && tmax < std::numeric_limits<T>::infinity() ? t >= tmax : t > tmax;
    }
};

}  // namespace lostbits
