// The range of t in which hits of a ray count.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace lostbits {

/// Says which ends of a range do not belong to it.
struct OpenEnds {
    bool tmin = false, tmax = false;
    friend auto operator<=>(const OpenEnds&, const OpenEnds&) = default;
};

/// Names of the open ends in files and on the command line.
inline constexpr std::array<std::pair<std::string_view, OpenEnds>, 4> open_ends_names{
    {{"none", {}}, {"tmin", {.tmin = true}}, {"tmax", {.tmax = true}}, {"both", {.tmin = true, .tmax = true}}}};
inline constexpr std::string_view name_of(OpenEnds open_ends) {
    return open_ends_names[(open_ends.tmin ? 1U : 0U) + (open_ends.tmax ? 2U : 0U)].first;
}
/// Finds the open ends with one of the names above; none for any other name.
inline constexpr OpenEnds open_ends_named(std::string_view name) {
    for (const auto& [known_name, open_ends] : open_ends_names)
        if (known_name == name) return open_ends;
    return {};
}

/// The t at which hits of a ray count: tmin ≤ t ≤ tmax, with < at an open end. A ray only goes forward, so tmin is
/// finite and at least 0. If tmax is infinity, the ray has no end.
template <class T>
struct Range {
    T tmin = 0;
    T tmax = std::numeric_limits<T>::infinity();
    OpenEnds open_ends = {};

    /// Returns the range with both ends closed that holds the same numbers of this format: t > tmin becomes t ≥ the
    /// next number above tmin. A tmax of infinity is not changed.
    [[nodiscard]] Range with_closed_ends() const {
        constexpr T infinity = std::numeric_limits<T>::infinity();
        Range result{tmin, tmax};
        if (open_ends.tmin) result.tmin = std::nextafter(tmin, infinity);
        if (open_ends.tmax && tmax < infinity) result.tmax = std::nextafter(tmax, -infinity);
        return result;
    }
    /// True if the range holds every t ≥ 0.
    [[nodiscard]] bool is_whole() const {
        return tmin == 0 && tmax == std::numeric_limits<T>::infinity() && !open_ends.tmin;
    }
    /// True if some t is in the range; false if an end is NaN.
    [[nodiscard]] bool holds_any() const {
        if (!(tmin >= 0 && tmin < std::numeric_limits<T>::infinity())) return false;
        return tmin < tmax || (tmin == tmax && !open_ends.tmin && !open_ends.tmax);
    }
    [[nodiscard]] bool is_before(const T& t) const { return open_ends.tmin ? t <= tmin : t < tmin; }
    [[nodiscard]] bool is_after(const T& t) const {
        return open_ends.tmax && tmax < std::numeric_limits<T>::infinity() ? t >= tmax : t > tmax;
    }
};

}  // namespace lostbits
