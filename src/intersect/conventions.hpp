// The right answer in each case that geometry leaves open. This is the only table of conventions. It decides which
// contracts are refused, docs/truth.md shows it, and a test compares the truth with it in every combination of
// properties.
#pragma once

#include <array>
#include <string>

#include "intersect/info.hpp"
#include "number/error.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect {

/// Place relative to a primitive where a ray begins or ends, if the answer depends on the contract.
enum class Situation : std::uint8_t {
    inside,    ///< begins inside
    entering,  ///< begins on the surface and goes in; crosses a flat primitive; goes toward the axis of a tube
    leaving,   ///< begins on the surface and goes out
    touching_at_origin,  ///< begins on the surface, and its line touches the surface there in one point
    along,               ///< begins on a straight part of the surface (a face, a cap, a side) and runs along it
    touching_ahead,      ///< touches the surface ahead of the origin: a tangent, a face, a rim
    ending_at_surface    ///< ends where it enters, or on a surface without an inside
};
inline constexpr std::array all_situations{
    Situation::inside, Situation::entering,       Situation::leaving,          Situation::touching_at_origin,
    Situation::along,  Situation::touching_ahead, Situation::ending_at_surface};

/// Answer that a contract asks for.
enum class RightAnswer : std::uint8_t {
    origin,  ///< t = 0
    next,    ///< the next point, beyond the origin, at which the ray meets or leaves the primitive
    miss,
    none  ///< no such ray exists
};

/// True if the answer is 0 for a ray from inside.
constexpr bool answers_0_inside(Shape shape, Inside inside) {
    return inside == Inside::zero || (inside == Inside::usual && inside_returns_zero(shape));
}

namespace detail {

/// Answer for a ray that begins on the surface. It is 0 if `at_origin` is `hit`, and also if it is `exit` and `leaves`
/// is true: the ray leaves the primitive there, only touches it, or the primitive is flat. In all other cases the
/// answer is `otherwise`.
constexpr RightAnswer answer_at_origin(AtOrigin at_origin, bool leaves, RightAnswer otherwise) {
    return at_origin == AtOrigin::hit || (at_origin == AtOrigin::exit && leaves) ? RightAnswer::origin : otherwise;
}

/// True if a line may run along the surface.
constexpr bool has_straight_parts(Shape shape) {
    return shape != Shape::sphere && shape != Shape::ellipsoid && shape != Shape::torus;
}

constexpr RightAnswer answer_on_surface(Shape shape, Situation situation, const Convention& convention) {
    const bool exit_is_miss = convention.inside == Inside::miss && has_inside(shape);
    const bool touching_misses = convention.touching == Touching::miss;
    const bool is_touching = situation == Situation::touching_at_origin || situation == Situation::along;
    // A ray that begins where it leaves a box touches it, because the points of a face belong to the box.
    if (touching_misses && (is_touching || (shape == Shape::box && situation == Situation::leaving)))
        return RightAnswer::miss;
    // A surface without an inside is only crossed, and a ray along it does not cross it.
    if (situation == Situation::along && !has_inside(shape)) return RightAnswer::miss;
    if (shape == Shape::box && answers_0_inside(shape, convention.inside)) return RightAnswer::origin;
    if (situation == Situation::entering)
        return answer_at_origin(convention.at_origin, is_flat(shape),
                                exit_is_miss || is_flat(shape) ? RightAnswer::miss : RightAnswer::next);
    if (situation == Situation::leaving && exit_is_miss) return RightAnswer::miss;
    if (situation == Situation::along) return answer_at_origin(convention.at_origin, false, RightAnswer::next);
    return answer_at_origin(convention.at_origin, true, RightAnswer::miss);
}

}  // namespace detail

/// The right answer by a convention, if the ray does not meet the primitive again further on (with a tube or a torus it
/// may).
constexpr RightAnswer right_answer(Shape shape, Situation situation, const Convention& convention) {
    const bool touching_misses = convention.touching == Touching::miss;
    switch (situation) {
        case Situation::inside:
            if (!has_inside(shape)) return RightAnswer::none;
            if (answers_0_inside(shape, convention.inside)) return RightAnswer::origin;
            return convention.inside == Inside::miss ? RightAnswer::miss : RightAnswer::next;
        case Situation::touching_ahead:
            if (shape == Shape::plane) return RightAnswer::none;
            return touching_misses ? RightAnswer::miss : RightAnswer::next;
        case Situation::ending_at_surface:
            return touching_misses && has_inside(shape) ? RightAnswer::miss : RightAnswer::next;
        case Situation::along:
            if (!detail::has_straight_parts(shape)) return RightAnswer::none;
            break;
        case Situation::leaving:
            if (is_flat(shape)) return RightAnswer::none;
            break;
        case Situation::touching_at_origin:
            if (is_flat(shape)) return RightAnswer::none;
            break;
        case Situation::entering: break;
    }
    return detail::answer_on_surface(shape, situation, convention);
}

/// True if the property on the origin changes any answer about a primitive, given the property for rays from inside.
constexpr bool origin_matters(Shape shape, Inside inside) {
    for (const Situation situation : all_situations) {
        Convention convention;
        convention.inside = inside;
        const RightAnswer usual = right_answer(shape, situation, convention);
        for (const AtOrigin property : {AtOrigin::miss, AtOrigin::exit}) {
            convention.at_origin = property;
            if (right_answer(shape, situation, convention) != usual) return true;
        }
    }
    return false;
}

/// Throws InputError if the property on the origin is given but changes no answer about a primitive. `message_prefix`
/// begins the message.
inline void refuse_unused_at_origin(AtOrigin at_origin, Inside inside, Shape shape, const std::string& message_prefix) {
    if (at_origin == AtOrigin::hit || !is_primitive(shape) || origin_matters(shape, inside)) return;
    throw InputError(
        message_prefix + ": at_origin changes no answer about " + with_article(shape) +
        ", because the answer from inside is 0, and the answer at the surface is 0 too; remove at_origin, or set "
        "inside = exit or miss");
}

/// True if no crossing is lost when the range of a ray excludes the first one. So it is for a form that yields both
/// roots or takes the range itself, for a form whose answer has no roots, and for a surface that a line crosses once. A
/// form with a single root loses the crossings behind that root.
constexpr bool yields_next_crossing(const Info& info, Shape shape) {
    return info.ranged || info.roots == Roots::both || info.roots == Roots::none || is_flat(shape) || takes_tmax(shape);
}

}  // namespace lostbits::intersect
