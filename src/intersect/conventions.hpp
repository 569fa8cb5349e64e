// The right answer in the cases that geometry leaves open, one by one: the only table of conventions. Contracts are
// refused by it, docs/truth.md shows it, and a test compares the truth with it in every combination of properties.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "intersect/info.hpp"
#include "number/error.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect {

/// The position of a ray relative to a primitive, where a property of the contract decides. "On the surface" means that
/// the ray begins there.
enum class Situation : std::uint8_t {
    inside,    ///< begins inside
    entering,  ///< begins on the surface and goes in; through a flat piece; toward the axis of a tube
    leaving,   ///< begins on the surface and goes out
    tangent,   ///< begins on the surface where it touches in one point
    along,     ///< begins on a straight part of the surface (a face, a cap, a side) and runs along it
    touching,  ///< touches ahead: a tangent, a face, a rim
    ending     ///< ends where it enters, or on a surface without an inside
};
inline constexpr std::array<std::string_view, 7> situation_names{"inside", "entering", "leaving", "tangent",
                                                                 "along",  "touching", "ending"};
inline constexpr std::array all_situations{Situation::inside,  Situation::entering, Situation::leaving,
                                           Situation::tangent, Situation::along,    Situation::touching,
                                           Situation::ending};

/// `ahead` is the next point, beyond the origin, at which the ray meets or leaves the primitive; `none`: no such ray.
enum class RightAnswer : std::uint8_t { origin, ahead, miss, none };
inline constexpr std::array<std::string_view, 4> answer_names{"0", "next", "miss", "-"};

/// True if the answer is 0 for a ray from inside.
constexpr bool answers_0_inside(Shape shape, Inside inside) {
    return inside == Inside::zero || (inside == Inside::usual && inside_returns_zero(shape));
}

namespace detail {

/// Answer on the surface, by the property on the origin: for an entry, an exit, or both at once (a flat piece, a
/// touch).
constexpr RightAnswer at_surface(AtOrigin said, bool is_exit, RightAnswer behind) {
    return said == AtOrigin::hit || (said == AtOrigin::exit && is_exit) ? RightAnswer::origin : behind;
}

/// True if a line may run along the surface.
constexpr bool has_straight_parts(Shape shape) {
    return shape != Shape::sphere && shape != Shape::ellipsoid && shape != Shape::torus;
}

constexpr RightAnswer right_on_surface(Shape shape, Situation of, const Convention& asked) {
    const bool no_exits = asked.inside == Inside::miss && has_inside(shape);
    const bool opened = asked.touching == Touching::miss;
    const bool touches = of == Situation::tangent || of == Situation::along;
    // A ray that begins where it leaves touches a box, whose points count themselves.
    if (opened && (touches || (shape == Shape::box && of == Situation::leaving))) return RightAnswer::miss;
    // A surface without an inside is crossed, and a ray along it crosses nothing.
    if (of == Situation::along && !has_inside(shape)) return RightAnswer::miss;
    if (shape == Shape::box && answers_0_inside(shape, asked.inside)) return RightAnswer::origin;
    if (of == Situation::entering)
        return at_surface(asked.at_origin, is_flat(shape),
                          no_exits || is_flat(shape) ? RightAnswer::miss : RightAnswer::ahead);
    if (of == Situation::leaving && no_exits) return RightAnswer::miss;
    if (of == Situation::along) return at_surface(asked.at_origin, false, RightAnswer::ahead);
    return at_surface(asked.at_origin, true, RightAnswer::miss);
}

}  // namespace detail

/// The right answer by a convention, if the ray meets nothing of the primitive further on (with a tube or a torus it
/// may).
constexpr RightAnswer right_answer(Shape shape, Situation of, const Convention& asked) {
    const bool opened = asked.touching == Touching::miss;
    switch (of) {
        case Situation::inside:
            if (!has_inside(shape)) return RightAnswer::none;
            if (answers_0_inside(shape, asked.inside)) return RightAnswer::origin;
            return asked.inside == Inside::miss ? RightAnswer::miss : RightAnswer::ahead;
        case Situation::touching:
            if (shape == Shape::plane) return RightAnswer::none;
            return opened ? RightAnswer::miss : RightAnswer::ahead;
        case Situation::ending: return opened && has_inside(shape) ? RightAnswer::miss : RightAnswer::ahead;
        case Situation::along:
            if (!detail::has_straight_parts(shape)) return RightAnswer::none;
            break;
        case Situation::leaving:
            if (is_flat(shape)) return RightAnswer::none;
            break;
        case Situation::tangent:
            if (is_flat(shape)) return RightAnswer::none;
            break;
        case Situation::entering: break;
    }
    return detail::right_on_surface(shape, of, asked);
}

/// True if the property on the origin changes any answer about a primitive when the property for rays from inside is
/// `inside`.
constexpr bool origin_matters(Shape shape, Inside inside) {
    for (const Situation of : all_situations) {
        Convention asked;
        asked.inside = inside;
        const RightAnswer usual = right_answer(shape, of, asked);
        for (const AtOrigin other : {AtOrigin::miss, AtOrigin::exit}) {
            asked.at_origin = other;
            if (right_answer(shape, of, asked) != usual) return true;
        }
    }
    return false;
}

/// Throws InputError if the property on the origin is given and changes no answer about a primitive; `from` begins the
/// message.
inline void require_origin(AtOrigin at_origin, Inside inside, Shape shape, const std::string& from) {
    if (at_origin == AtOrigin::hit || !is_primitive(shape) || origin_matters(shape, inside)) return;
    throw InputError(
        from + ": at_origin changes no answer about " + with_article(shape) +
        ", because the answer from inside is 0, and the answer at the surface is 0 too; remove at_origin, or set "
        "inside = exit or miss");
}

/// True if a form yields the next crossing when the range of a ray excludes its first one: it yields both roots, or it
/// takes the range itself. A form of a single root loses the crossings behind it. A form that answers for all points
/// inside, and a surface that a line crosses once, have no next crossing to lose.
constexpr bool tells_next_crossing(const Info& info, Shape shape) {
    return info.ranged || info.roots == Roots::both || info.roots == Roots::none || is_flat(shape) || takes_tmax(shape);
}

}  // namespace lostbits::intersect
