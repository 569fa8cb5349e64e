// The contract of a form, with which its answers are compared.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "shapes/primitive.hpp"

namespace lostbits::intersect {

/// The direction that a form may expect. `unit` forms receive it normalised and rounded to their format.
enum class Direction { any, unit };

/// The line parameters that a form yields.
enum class Roots {
    both,        ///< near and far
    near_only,   ///< the smaller root alone
    first_only,  ///< the first root with t ≥ 0, near or far; near = far = t
    none,        ///< yields only hit or miss: its t is NaN and has no error
};

/// The answer to a ray that touches the primitive in one point (discriminant exactly zero), by the form's own contract:
/// the point belongs to the closed primitive, but not to the open one (its inside). A ray that ends where it enters
/// does not meet the open primitive either. For a box, the property decides a ray through a corner or along a face;
/// `miss` also means that a box of zero thickness is never hit. For a surface without inside, the property says whether
/// the rim belongs to the surface; a ray may end on it. `AtOrigin` says whether a ray may begin on such a surface.
enum class Touching { hit, miss };

/// Says whether a surface exactly at the ray's origin (t = 0) counts as its first intersection. It always counts for a
/// march, which samples the distance field at t = 0, and for a box whose forms answer 0 from inside.
enum class AtOrigin {
    hit,   ///< t = 0
    miss,  ///< the surface is ignored: the answer is the other root if that lies ahead, otherwise a miss
    exit   ///< an entry at the origin is ignored, an exit is not: the answer is the other root if the ray goes in, 0 if
           ///< it goes out
};

/// The right answer for a ray that starts inside a primitive.
enum class Inside {
    usual,  ///< the exit for a sphere, 0 for a box
    exit,   ///< the t at which the ray leaves
    zero,   ///< t = 0
    near,   ///< the near root, which is behind the origin; nothing lies ahead, so the ray misses
    miss
};
/// The side from which a triangle, a disc or a plane is hit; rays from the other side miss it. The normal points to the
/// front. For a triangle, the front is the side from which a, b, c run counter-clockwise, so d·n < 0 with n = (b − a) ×
/// (c − a). The side is decided in the space of the primitive: a matrix that mirrors does not change it. Source:
/// DirectX Raytracing (DXR) Functional Spec, ray flags.
enum class Facing { both, front, back };
inline constexpr std::array<std::string_view, 5> inside_names{"usual", "exit", "zero", "near", "miss"};
inline constexpr std::array<std::string_view, 3> facing_names{"both", "front", "back"};
inline constexpr std::array<std::string_view, 3> at_origin_names{"hit", "miss", "exit"};

/// The choice of what counts as a hit, in the questions that geometry leaves open. A `Touching` without further
/// properties gives a convention in which t = 0 counts.
struct Convention {
    Touching touching = Touching::hit;
    AtOrigin at_origin = AtOrigin::hit;
    Inside inside = Inside::usual;
    Facing facing = Facing::both;
    bool endless = false;  ///< the ray goes on beyond its stated end
    /// For a set of forms whose contracts differ: the convention of each form, in the order of the shapes. Null if all
    /// primitives have the same convention.
    const Convention* by_shape = nullptr;

    constexpr Convention() = default;
    constexpr Convention(Touching touch, AtOrigin origin = AtOrigin::hit) : touching(touch), at_origin(origin) {}
    constexpr Convention(AtOrigin origin) : at_origin(origin) {}
    friend bool operator==(const Convention&, const Convention&) = default;

    /// The convention for primitives of one shape.
    [[nodiscard]] constexpr Convention for_shape(Shape shape) const {
        return by_shape ? by_shape[static_cast<std::size_t>(shape)] : *this;
    }

    /// True if this convention differs from that of the closed primitive in more than `touching` and an ignored origin,
    /// or if it depends on the shape. Proofs for many rays at a time cover only those two properties.
    [[nodiscard]] constexpr bool is_special() const {
        return inside != Inside::usual || facing != Facing::both || endless || at_origin == AtOrigin::exit ||
               by_shape != nullptr;
    }
};

/// The name, in files and columns, of the convention with which a form is compared: its own, that of the closed
/// primitive (touching is a hit), or that of the open one (touching is a miss). With the latter two, t = 0 counts.
inline constexpr std::string_view convention_name(std::optional<Touching> judged_touching) {
    return !judged_touching ? "own" : *judged_touching == Touching::hit ? "closed" : "open";
}

enum class Formats { all, binary32_only };

struct Info {
    std::string_view name;    ///< `shape.form`, unique
    std::string_view title;   ///< one line, for lists and captions
    std::string_view source;  ///< where the formula is from
    Direction direction = Direction::any;
    Roots roots = Roots::both;
    Touching touching = Touching::hit;
    AtOrigin at_origin = AtOrigin::hit;
    Formats formats = Formats::all;
    Inside inside = Inside::usual;
    Facing facing = Facing::both;
    bool endless = false;  ///< for a form that yields no t: it answers for rays without an end
    bool ranged = false;   ///< it receives the beginning and end of rays, and yields only hits between them
    /// For a triangle: the named operations that are the weights of a, b and c (barycentric coordinates), which give
    /// the hit point. A weight that the form does not compute has an empty name.
    std::array<std::string_view, 3> weights = {};
    /// For a set of forms: their conventions by shape, three times: by their own contracts, as closed primitives, and
    /// as open ones. Null if the convention is the same for all shapes.
    std::array<const Convention*, 3> by_shape = {};

    /// The form's own convention, or that of the closed or open primitive if `judged_touching` names it. The form's own
    /// properties for rays from inside, sides and ends are kept in either case.
    [[nodiscard]] constexpr Convention convention(std::optional<Touching> judged_touching = {}) const {
        Convention result{judged_touching.value_or(touching), judged_touching ? AtOrigin::hit : at_origin};
        result.inside = inside == Inside::near ? Inside::miss : inside;
        result.facing = facing;
        result.endless = endless;
        result.by_shape = by_shape[!judged_touching ? 0 : *judged_touching == Touching::hit ? 1 : 2];
        return result;
    }
};

}  // namespace lostbits::intersect
