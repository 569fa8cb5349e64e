// What a shape says of its numbers, from which every file, option and table that names them follows.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace lostbits {

/// One key of a solid, as a scene's file has it, in world units: a point, a direction, one length, or one length for
/// each axis.
struct Key {
    enum class Kind { point, direction, length, lengths };
    /// What its numbers must be, beside finite.
    enum class Limit {
        none,
        positive,          ///< greater than 0
        not_negative,      ///< 0 or more
        below_before,      ///< 0 or more, and less than the length before it
        within_before,     ///< greater than 0, and less than the length before it
        not_zero,          ///< a direction of some length
        at_least_before,   ///< in each component at least the key before it
        off_line_before,   ///< a point that does not lie on one line with the two keys before it
        apart_from_before  ///< a point that is not the key before it
    };

    std::string_view name;    ///< `centre`: of TOML tables, paths and shaders
    std::string_view letter;  ///< `c`: files of rays have cx, cy, cz, options CX,CY,CZ
    Kind kind = Kind::point;
    Limit limit = Limit::none;
    std::array<std::string_view, 2> aliases = {};  ///< as other people write the name
    bool optional = false;                         ///< 0 where it is left out

    [[nodiscard]] constexpr std::size_t count() const { return kind == Kind::length ? 1 : 3; }
    [[nodiscard]] constexpr bool is_length() const { return kind == Kind::length || kind == Kind::lengths; }
};

/// What texts call a shape and what can be seen of it.
struct ShapeWords {
    std::string_view plainest;  ///< the one that reaches 2 from the origin
    std::string_view touching;  ///< a ray that only touches it
    std::string_view point;     ///< one that is no larger than a point
    std::string_view places;    ///< what its points are: the centres
};

}  // namespace lostbits
