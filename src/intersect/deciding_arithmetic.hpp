// The arithmetic in which a form decided a ray, and the bound on its error. Both are reported beside the answer.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace lostbits::intersect {

/// The arithmetic in which a form that filters decided a ray: its own, the next wider one of one word (double for
/// float), two words, or sums without any rounding.
enum class DecidingArithmetic : std::uint8_t { own, wider, two_words, exact };

inline constexpr std::array<std::string_view, 4> arithmetic_names{"own", "wider", "two_words", "exact"};

/// Keeps the widest arithmetic that is passed to it.
struct ArithmeticWatch {
    DecidingArithmetic widest = DecidingArithmetic::own;
    void operator()(DecidingArithmetic arithmetic) {
        if (arithmetic > widest) widest = arithmetic;
    }
};

/// Ignores the arithmetic, at no cost.
struct NoWatch {
    void operator()(DecidingArithmetic /*arithmetic*/) const {}
};

/// A form's answer over `Bounded`: its decision and t, with the bits of the format; whether the bounds prove the
/// decision; and `error`, a bound on the distance of t from the t of the same formula without rounding (infinity if
/// nothing is known).
struct BoundedAnswer {
    bool hit, proved;
    double t, error;
};

inline constexpr std::array<std::string_view, 2> decision_names{"proved", "undecided"};

}  // namespace lostbits::intersect
