#include "exact/check.hpp"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <limits>
#include <type_traits>

namespace lostbits::exact {
namespace {

/// x·2^e. If its words are not normal, an enclosed number has no bound.
Enclosed scaled(double x, std::int64_t e, const Enclosed&) {
    if (x == 0) return Enclosed(0);
    if (e < -800 || e > 800) return {x, 0, INFINITY};
    return Enclosed(std::ldexp(x, static_cast<int>(e)));
}
Whole scaled(double x, std::int64_t e, const Whole&) { return Whole(x).scaled(e); }

/// Half way from a number of a format to its lower and upper neighbour; `least` and `largest` are the least and the
/// largest number of the format. Nothing lies below 0, and above the largest number the gap is that below it.
template <class E>
struct Midpoints {
    E before, after;

    Midpoints(double x, double down, double up, double largest) {
        const E one = scaled(1, -1, E());
        if (std::isinf(x)) {
            const double step = largest - down;  // `down` is the number before the largest
            before = E(largest) + one * E(step), after = before;
        } else {
            before = one * (E(x) + E(down));
            after = std::isinf(up) ? E(x) + one * E(x - down) : one * (E(x) + E(up));
        }
    }
};

template <class F>
using Bits = std::conditional_t<sizeof(F) == 4, std::uint32_t, std::uint64_t>;
template <class F>
constexpr F infinite = std::numeric_limits<F>::infinity();

/// True if a number of the format F is t ≥ 0 rounded to nearest, ties to even.
template <class F, class E>
bool is_rounded(double rounded, const First<E>& t) {
    const F x = static_cast<F>(rounded), largest = std::numeric_limits<F>::max();
    if (static_cast<double>(x) != rounded || !(rounded >= 0)) return false;
    const F down = std::nextafter(std::isinf(x) ? largest : x, F(0)), up = std::nextafter(x, infinite<F>);
    const Midpoints<E> middle(rounded, static_cast<double>(down), static_cast<double>(up),
                              static_cast<double>(largest));
    const bool is_even = (std::bit_cast<Bits<F>>(x) & 1) == 0;
    const int from = x == 0 ? 1 : t.side(middle.before), to = std::isinf(x) ? -1 : t.side(middle.after);
    return (from > 0 || (from == 0 && is_even)) && (to < 0 || (to == 0 && is_even));
}

template <class E>
Fault fault_of(const First<E>& right, const Answer& a, double tightness, double slack) {
    if (right.is_hit() != a.hit) return Fault::decision;
    if (!a.hit) return Fault::none;
    if (!(a.bound >= 0) || !(a.bound <= tightness * std::fabs(a.high))) return Fault::tightness;
    const E middle = scaled(a.high, a.exponent, E()) + scaled(a.low, a.exponent, E());
    const E bound = scaled(std::max(a.bound, slack * std::fabs(a.high)), a.exponent, E());
    if (right.side(middle - bound) < 0 || right.side(middle + bound) > 0) return Fault::length;
    if (!std::isnan(a.as_float) && !is_rounded<float>(a.as_float, right)) return Fault::rounded_to_float;
    if (!std::isnan(a.as_double) && !is_rounded<double>(a.as_double, right)) return Fault::rounded_to_double;
    return Fault::none;
}

}  // namespace

const char* words_of(Fault fault) {
    switch (fault) {
        case Fault::none: return "right";
        case Fault::decision: return "hit and miss are confused";
        case Fault::length: return "t is not within its bound";
        case Fault::tightness: return "the bound is too wide";
        case Fault::rounded_to_float: return "t is not rounded to the nearest float";
        case Fault::rounded_to_double: return "t is not rounded to the nearest double";
    }
    return "";
}

Findings check(const ShapeTest& shape, std::span<const Problem> problems, std::span<const Answer> answers,
               double tightness, std::size_t each_exactly) {
    Findings found;
    for (std::size_t i = 0; i < problems.size(); ++i) {
        Fault fault = Fault::none;
        in_doubt = (i + 1) % each_exactly == 0, has_no_first = false;
        if (!in_doubt) fault = fault_of(meet(shape.quickly, problems[i]), answers[i], tightness, 0x1p-80);
        if (in_doubt) {
            ++found.exact_count, has_no_first = false;
            fault = fault_of(meet(shape.exactly, problems[i]), answers[i], tightness, 0);
        }
        ++found.ray_count;
        found.hits += answers[i].hit;
        if (has_no_first) fault = Fault::none;
        if (fault != Fault::none && found.wrong_count++ == 0) found.first_wrong = i, found.fault = fault;
    }
    return found;
}

std::string paste(const ShapeTest& shape, const Problem& problem, const Answer& a) {
    std::string text(shape.name);
    const auto add = [&text](const char* name, double x) {
        char number[64];
        std::snprintf(number, sizeof number, "%s%a", name, x);
        text += number;
    };
    text += ": ray";
    for (const double x : problem.ray) add(" ", x);
    text += ", solid";
    for (const double x : problem.primitive) add(" ", x);
    if (problem.has_transform) {
        text += problem.is_inverse ? ", under the inverse" : ", under";
        for (const double x : problem.matrix) add(" ", x);
    }
    add(", from ", problem.tmin), add(problem.open_tmin ? " (open) to " : " to ", problem.tmax);
    text += problem.open_tmax ? " (open)" : "";
    if (!a.hit) return text + ": a miss";
    add(": a hit at ", a.high), add(" + ", a.low), add(" +- ", a.bound);
    text += " times 2^" + std::to_string(a.exponent);
    add(", as a float ", a.as_float), add(", as a double ", a.as_double);
    return text;
}

}  // namespace lostbits::exact
