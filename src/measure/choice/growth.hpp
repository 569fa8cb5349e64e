// The ways in which a scene or rays are stretched.
#pragma once

#include <array>
#include <string_view>

namespace lostbits::measure::choice {

/// What grows by a factor while the rest stays.
enum class Growth {
    distance,  ///< from the eye to the solids, straight back along the view; a narrower view keeps the picture
    radius,    ///< of each solid, about its point nearest to the eye, which stays where it is
    offset,    ///< eye and solids together move away from the origin, along (1, 11/16, −7/16)
    view       ///< the tangent of half the field of view
};
inline constexpr std::array<std::string_view, 4> growth_names{"distance", "radius", "offset", "view"};
inline constexpr std::array growths{Growth::distance, Growth::radius, Growth::offset, Growth::view};

}  // namespace lostbits::measure::choice
