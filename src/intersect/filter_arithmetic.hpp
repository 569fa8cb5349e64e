// The arithmetic in which a form settled a ray, and the bound on its error: reports beside the answer.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace lostbits::intersect {

/// The arithmetic in which a form that filters settled a ray: its own, the next wider one of one word (double for
/// float), two words, or sums without any rounding.
enum class FilterArithmetic : std::uint8_t { own, wider, two_words, exact };

inline constexpr std::array<std::string_view, 4> filter_arithmetic_names{"own", "wider", "two_words", "exact"};

/// Keeps the widest arithmetic that it hears of.
struct ArithmeticWatch {
    FilterArithmetic widest = FilterArithmetic::own;
    void operator()(FilterArithmetic way) {
        if (way > widest) widest = way;
    }
};

/// Hears nothing, at no cost.
struct NoWatch {
    void operator()(FilterArithmetic /*way*/) const {}
};

/// A form's answer over `Bounded`: its decision and t, to the bit those of the format; whether the bounds prove the
/// decision; and a bound on the distance of t from that of the same formula without rounding, infinity if nothing is
/// known.
struct BoundedAnswer {
    bool hit, proved;
    double t, error;
};

inline constexpr std::array<std::string_view, 2> decision_names{"proved", "undecided"};

}  // namespace lostbits::intersect
