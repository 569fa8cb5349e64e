// What a form says of itself beside its answer: in which arithmetic it settled a ray, and how far off it may be.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace lostbits::intersect {

/// The arithmetic in which a form that filters settled a ray: its own, the next wider one of one word (double for
/// float), two words, or sums without any rounding.
enum class Way : std::uint8_t { own, wider, two_words, exact };

inline constexpr std::array<std::string_view, 4> way_names{"own", "wider", "two_words", "exact"};

/// Keeps the widest arithmetic that it hears of.
struct WayWatch {
    Way widest = Way::own;
    void operator()(Way way) {
        if (way > widest) widest = way;
    }
};

/// Hears nothing, at no cost.
struct NoWatch {
    void operator()(Way /*way*/) const {}
};

/// A form's answer over `Bounded`: its decision and t, to the bit those of the format; whether the bounds prove the
/// decision; and what t can differ from that of the same formula without rounding, infinity where nothing is known.
struct BoundedAnswer {
    bool hit, proved;
    double t, error;
};

inline constexpr std::array<std::string_view, 2> decision_names{"proved", "undecided"};

}  // namespace lostbits::intersect
