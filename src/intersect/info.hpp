// The contract of a form, by which it is judged.
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
    first_only,  ///< the first with t ≥ 0, whichever it is; near = far = t
    none,        ///< says only whether it hits: its t is NaN and has no error
};

/// The answer to a ray that touches in one point (discriminant exactly zero), by the form's own contract: the closed
/// primitive counts it, the open one (its inside) does not. A ray that ends where it enters does not meet the open
/// primitive either. For a box, the property decides a ray through a corner or along a face; as a miss, it also means
/// that a box of zero thickness is never hit. For a surface without inside, it says whether the rim belongs to it; a
/// ray may end on it. `AtOrigin` says whether a ray may begin on such a surface.
enum class Touching { hit, miss };

/// Says if a surface exactly at the ray's origin (t = 0) counts as its first intersection. A march samples the field at
/// t = 0, so there it counts; it also counts for a box whose forms answer 0 from inside.
enum class AtOrigin {
    hit,   ///< t = 0
    miss,  ///< it is passed over: the answer is the other root if that lies ahead, and a miss if not
    exit   ///< an entry there is passed over, an exit is not: the other root if the ray goes in, 0 if it goes out
};

/// The true answer for a ray that starts inside a primitive.
enum class Inside {
    usual,  ///< the exit for a sphere, 0 for a box
    exit,   ///< the t at which the ray leaves
    zero,   ///< t = 0
    near,   ///< the near root, behind the origin: nothing ahead, so a miss
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

/// The choice of what counts as a hit, in the questions that geometry leaves open. `Touching` alone means a convention
/// in which t = 0 counts.
struct Convention {
    Touching touching = Touching::hit;
    AtOrigin at_origin = AtOrigin::hit;
    Inside inside = Inside::usual;
    Facing facing = Facing::both;
    bool endless = false;  ///< the ray goes on beyond its stated end
    /// For a set of forms whose contracts differ: the convention of each, in the order of the shapes. Null: the same
    /// for all primitives.
    const Convention* by_shape = nullptr;

    constexpr Convention() = default;
    constexpr Convention(Touching touch, AtOrigin origin = AtOrigin::hit) : touching(touch), at_origin(origin) {}
    constexpr Convention(AtOrigin origin) : at_origin(origin) {}
    friend bool operator==(const Convention&, const Convention&) = default;

    /// The convention for primitives of one shape.
    [[nodiscard]] constexpr Convention of(Shape shape) const {
        return by_shape ? by_shape[static_cast<std::size_t>(shape)] : *this;
    }

    /// True if it differs from the closed primitive's in more than touching and an origin that is passed over, or from
    /// shape to shape. Proofs for many rays at a time know those two alone.
    [[nodiscard]] constexpr bool is_special() const {
        return inside != Inside::usual || facing != Facing::both || endless || at_origin == AtOrigin::exit ||
               by_shape != nullptr;
    }
};

/// The convention by which a form is judged, as files and columns name it: its own, the closed primitive's (touching is
/// a hit), or the open one's (a miss). With the latter two, t = 0 counts.
inline constexpr std::string_view convention_name(std::optional<Touching> judged) {
    return !judged ? "own" : *judged == Touching::hit ? "closed" : "open";
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
    bool ranged = false;   ///< it receives the beginning and end of rays, and answers within
    /// For a triangle: the named operations that are the weights of a, b and c (barycentric coordinates), which give
    /// the point that the ray meets. Empty for a weight that the form leaves out.
    std::array<std::string_view, 3> weights = {};
    /// For a set of forms: their conventions by shape, by their own contracts, as closed primitives and as open ones.
    /// Null if these are the same for all shapes.
    std::array<const Convention*, 3> by_shape = {};

    /// The form's own, or the closed or open primitive's if `judged` names it. For rays from inside, sides and ends the
    /// form's own properties stay.
    [[nodiscard]] constexpr Convention convention(std::optional<Touching> judged = {}) const {
        Convention asked{judged.value_or(touching), judged ? AtOrigin::hit : at_origin};
        asked.inside = inside == Inside::near ? Inside::miss : inside;
        asked.facing = facing;
        asked.endless = endless;
        asked.by_shape = by_shape[!judged ? 0 : *judged == Touching::hit ? 1 : 2];
        return asked;
    }
};

}  // namespace lostbits::intersect
