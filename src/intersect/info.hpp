// What a form says of itself: the contract that the laboratory holds it to.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "shapes/solid.hpp"

namespace lostbits::intersect {

/// The direction a form is entitled to. `unit` forms receive it normalised and rounded to their format.
enum class Direction { any, unit };

/// Which line parameters a form yields.
enum class Roots {
    both,        ///< near and far
    near_only,   ///< the smaller root alone
    first_only,  ///< the first with t ≥ 0, whichever it is; near = far = t
    none,        ///< says only whether it hits: its t is NaN, and no error of it exists
};

/// Where a ray that touches in one point (discriminant exactly zero) belongs by the form's own words: whether it means
/// the closed solid or the open one, its inside, of which a ray that ends where it enters meets nothing either. Of a
/// box: a ray through a corner or along a face is a hit or a miss, and where it is that a box of zero thickness is
/// never hit. Of what has no inside: whether its rim belongs to it; a ray may end on it. Whether a ray may begin on a
/// surface that has one is said by `AtOrigin`.
enum class Touching { hit, miss };

/// Whether a surface exactly at the ray's origin (t = 0) counts as its first intersection. A march samples the field at
/// t = 0, where it counts; so it does for a box whose forms answer 0 from inside.
enum class AtOrigin {
    hit,   ///< t = 0
    miss,  ///< it is passed over: the answer is the other root if that lies ahead, and a miss if not
    exit   ///< an entry there is passed over, an exit is not: the other root where the ray goes in, 0 where it goes out
};

/// The true answer for a ray that starts inside of a solid.
enum class Inside {
    usual,  ///< the exit of a sphere, 0 of a box
    exit,   ///< where it leaves
    zero,   ///< t = 0
    near,   ///< the near root, behind it: nothing ahead, so a miss
    miss
};
/// The side that a triangle, a disc or a plane is met from; to a ray from the other side it is not there. The front is
/// where the normal points to, of a triangle the side from which a, b, c run counter-clockwise, so that d·n < 0 with
/// n = (b − a) × (c − a). It is decided in the space of the solid: a matrix that mirrors does not turn it. Source of
/// that: DirectX Raytracing (DXR) Functional Spec, ray flags.
enum class Facing { both, front, back };
inline constexpr std::array<std::string_view, 5> inside_names{"usual", "exit", "zero", "near", "miss"};
inline constexpr std::array<std::string_view, 3> facing_names{"both", "front", "back"};
inline constexpr std::array<std::string_view, 3> at_origin_names{"hit", "miss", "exit"};

/// What counts as a hit, in the questions that geometry leaves open. Touching alone names one in which t = 0 counts.
struct Convention {
    Touching touching = Touching::hit;
    AtOrigin at_origin = AtOrigin::hit;
    Inside inside = Inside::usual;
    Facing facing = Facing::both;
    bool endless = false;  ///< the ray goes on where it is said to end
    /// Of a set of forms whose words differ: what each says, in the order of the shapes. Null: the same of all solids.
    const Convention* by_shape = nullptr;

    constexpr Convention() = default;
    constexpr Convention(Touching touch, AtOrigin origin = AtOrigin::hit) : touching(touch), at_origin(origin) {}
    constexpr Convention(AtOrigin origin) : at_origin(origin) {}
    friend bool operator==(const Convention&, const Convention&) = default;

    /// That of solids of one shape.
    [[nodiscard]] constexpr Convention of(Shape shape) const {
        return by_shape ? by_shape[static_cast<std::size_t>(shape)] : *this;
    }

    /// Whether it differs from the closed solid's in more than touching and an origin that is passed over, or from
    /// shape to shape. What is proved many rays at a time knows those two alone.
    [[nodiscard]] constexpr bool is_special() const {
        return inside != Inside::usual || facing != Facing::both || endless || at_origin == AtOrigin::exit ||
               by_shape != nullptr;
    }
};

/// By whose word a form is judged, as files and columns name it: its own, the closed solid's (touching is a hit), the
/// open one's (a miss). By the latter two, t = 0 counts.
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
    bool endless = false;  ///< of a form that tells no t: it answers for rays without an end
    bool ranged = false;   ///< it is told where rays begin and end, and answers within
    /// Of a triangle: the named operations that are the weights of a, b and c, of which the point is made that the ray
    /// meets (barycentric coordinates); empty for a weight that the form leaves out.
    std::array<std::string_view, 3> weights = {};
    /// Of a set of forms: their conventions by shape, by their own words, as closed solids and as open ones; null where
    /// these are the same of all shapes.
    std::array<const Convention*, 3> by_shape = {};

    /// The form's own, or the solid's that `judged` names: from inside, of sides and of ends, it is asked what it says.
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
