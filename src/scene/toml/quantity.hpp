// Reads numbers that have the same meaning in every format: "the largest", "one ulp above 3", "2 to the half of emax".
#pragma once

#include <string_view>
#include <vector>

#include "number/format.hpp"
#include "number/real.hpp"
#include "scene/toml/toml_tree.hpp"

namespace lostbits::scene::toml {

/// A power of two by the parameters of a format: `12`, `emax/2 + 1`, `emin - p`, `emax/4`. Quotients are rounded down.
class Exponent {
public:
    Exponent() = default;
    /// Reads a whole number or a string. Throws InputError at `node` for anything else.
    explicit Exponent(const Node& node);
    [[nodiscard]] int value_in(const FloatFormat& format) const;

private:
    struct Term {
        int sign, number;
        enum class SpecialValue { none, emax, emin, p } word;
        int divisor;
    };
    /// Reads a parameter of a format that is at `position`, and moves `position` past it. False if none is there.
    static bool read_special_value(std::string_view text, std::size_t& position, Term& term);

    std::vector<Term> terms_;
};

/// One number of a ray or a primitive: an ordinary number; `nan`, `inf`; `max` (largest finite), `min` (smallest
/// normal), `tiny` (smallest subnormal). Each of these may have a sign, and `+ ulp` or `- ulp` for the neighbour above
/// or below.
class Quantity {
public:
    /// Reads a quantity. `allows_special` allows nan and inf. Throws InputError at `node` for anything else.
    Quantity(const Node& node, bool allows_special);
    /// base·2^exponent rounded once to the format, then moved to its neighbour. `max`, `min` and `tiny` are not
    /// scaled.
    [[nodiscard]] double value_in(const FloatFormat& format, int exponent) const;

private:
    enum class SpecialValue { none, nan, inf, max, min, tiny };
    SpecialValue word_ = SpecialValue::none;
    Real base_;
    bool negative_ = false;
    int ulps_ = 0;
};

}  // namespace lostbits::scene::toml
