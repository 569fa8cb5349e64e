// What a form says of itself: the contract that the laboratory holds it to.
#pragma once

#include <optional>
#include <string_view>

namespace lostbits::intersect {

/// The direction a form is entitled to. `unit` forms receive it normalised and rounded to their format.
enum class Direction { any, unit };

/// Which line parameters a form yields.
enum class Roots {
    both,        ///< near and far
    near_only,   ///< the smaller root; the form has no answer from inside
    first_only,  ///< the first with t ≥ 0, whichever it is; near = far = t
    none,        ///< says only whether it hits: its t is NaN, and no error of it exists
};

/// Where a ray that touches in one point (discriminant exactly zero) belongs by the form's own words. Of a box: whether
/// the form means the closed box (a ray through a corner or along a face is a hit) or the open one (it is a miss, and a
/// box of zero thickness is never hit).
enum class Touching { hit, miss };

/// Whether a sphere's surface exactly at the ray's origin (t = 0) counts as its first intersection. Where it does not,
/// the answer is the other root if that lies ahead, and a miss if not: the first t > 0. A box is a solid, entered at
/// t = 0 by a ray that starts in it, and a march samples the field at t = 0: for their forms t = 0 counts.
enum class AtOrigin { hit, miss };

/// What counts as a hit, in both questions that geometry leaves open. Touching alone names one in which t = 0 counts.
struct Convention {
    Touching touching = Touching::hit;
    AtOrigin at_origin = AtOrigin::hit;

    constexpr Convention() = default;
    constexpr Convention(Touching touch, AtOrigin origin = AtOrigin::hit) : touching(touch), at_origin(origin) {}
    friend bool operator==(const Convention&, const Convention&) = default;
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

    [[nodiscard]] constexpr Convention convention() const { return {touching, at_origin}; }
};

}  // namespace lostbits::intersect
