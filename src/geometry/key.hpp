// Names and limits of a shape's numbers, as used in all files, options and tables.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace lostbits {

/// One key of a primitive in a scene file, in world units: a point, a direction, one length, or one length per axis.
struct Key {
    enum class Kind { point, direction, length, lengths };
    /// A condition on the numbers of a key, besides being finite.
    enum class Limit {
        none,
        positive,                     ///< greater than 0
        not_negative,                 ///< 0 or more
        non_negative_below_previous,  ///< 0 or more, and less than the previous length
        positive_below_previous,      ///< greater than 0, and less than the previous length
        not_zero,                     ///< a direction whose length is not 0
        at_least_previous,            ///< at least the previous key in each component
        not_collinear_with_previous,  ///< a point that does not lie on one line with the two previous keys
        differs_from_previous         ///< a point that differs from the previous key
    };

    std::string_view name;        ///< such as `centre`: the key in TOML tables, paths and shaders
    std::string_view short_name;  ///< such as `c` or `lo`: ray files have columns cx, cy, cz; options read CX,CY,CZ
    Kind kind = Kind::point;
    Limit limit = Limit::none;
    std::array<std::string_view, 2> aliases = {};  ///< other common spellings of the name
    bool is_optional = false;                      ///< 0 if left out

    [[nodiscard]] constexpr std::size_t count() const { return kind == Kind::length ? 1 : 3; }
    [[nodiscard]] constexpr bool is_length() const { return kind == Kind::length || kind == Kind::lengths; }
};

/// How many numbers a primitive of type S has.
template <class S>
inline constexpr std::size_t number_count = [] {
    std::size_t count = 0;
    for (const Key& key : S::keys) count += key.count();
    return count;
}();

/// Phrases about a shape and its special cases, for messages and texts.
struct ShapeTexts {
    std::string_view simplest;      ///< the simplest primitive, all of which lies within 2 of the origin
    std::string_view touching_ray;  ///< a ray that only touches the primitive
    std::string_view degenerate;    ///< a primitive no larger than a point
    /// The points that determine the position of the primitive, in the plural, such as `centres`.
    std::string_view anchor_points;
};

}  // namespace lostbits
