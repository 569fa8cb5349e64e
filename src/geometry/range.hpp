// Which part of a ray counts.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace lostbits {

/// Which ends of a range do not belong to it.
struct OpenEnds {
    bool tmin = false, tmax = false;
    friend auto operator<=>(const OpenEnds&, const OpenEnds&) = default;
};

/// As files and the command line name them.
inline constexpr std::array<std::pair<std::string_view, OpenEnds>, 4> open_ends_names{
    {{"none", {}}, {"tmin", {.tmin = true}}, {"tmax", {.tmax = true}}, {"both", {.tmin = true, .tmax = true}}}};
inline constexpr std::string_view name_of(OpenEnds open) {
    return open_ends_names[(open.tmin ? 1U : 0U) + (open.tmax ? 2U : 0U)].first;
}
/// Of a name that is one of these.
inline constexpr OpenEnds open_ends_named(std::string_view name) {
    for (const auto& [known, open] : open_ends_names)
        if (known == name) return open;
    return {};
}

/// Those t of a ray that count: tmin ≤ t ≤ tmax, with < at an end that is open. A ray looks ahead, so that tmin is
/// finite and at least 0; a tmax of infinity is nowhere.
template <class T>
struct Range {
    T tmin = 0;
    T tmax = std::numeric_limits<T>::infinity();
    OpenEnds open = {};

    /// The same numbers of this format as a range with both ends: t > tmin is t ≥ the next number above tmin. Infinity
    /// stays the end of what has none.
    [[nodiscard]] Range closed() const {
        constexpr T nowhere = std::numeric_limits<T>::infinity();
        Range all{tmin, tmax};
        if (open.tmin) all.tmin = std::nextafter(tmin, nowhere);
        if (open.tmax && tmax < nowhere) all.tmax = std::nextafter(tmax, -nowhere);
        return all;
    }
    /// All that lies ahead.
    [[nodiscard]] bool is_whole() const {
        return tmin == 0 && tmax == std::numeric_limits<T>::infinity() && !open.tmin;
    }
    /// Whether any t is in it; none is where a number is NaN.
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
