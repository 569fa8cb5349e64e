// Numbers that mean the same thing in every format: "the largest", "one ulp above 3", "2 to the half of emax".
#pragma once

#include <vector>

#include "number/format.hpp"
#include "number/real.hpp"
#include "scene/toml/toml_tree.hpp"

namespace lostbits::scene::toml {

/// A power of two by the numbers of a format: `12`, `emax/2 + 1`, `emin - p`, `emax/4`. Quotients are rounded down.
class Exponent {
public:
    Exponent() = default;
    /// InputError at `node` for anything else; it may be a whole number or a string.
    explicit Exponent(const Node& node);
    [[nodiscard]] int in(const FloatFormat& f) const;

private:
    struct Term {
        int sign, number;
        enum class Word { none, emax, emin, p } word;
        int divisor;
    };
    std::vector<Term> terms_;
};

/// One number of a ray or solid: a number as everywhere; `nan`, `inf`; `max` (largest finite), `min` (smallest
/// normal), `tiny` (smallest subnormal); any of them with a sign, and with `+ ulp` or `- ulp` the neighbour above or
/// below.
class Quantity {
public:
    /// InputError at `node` for anything else. `special` allows nan and inf.
    Quantity(const Node& node, bool special);
    /// base·2^exponent rounded once to the format, then moved to its neighbour. Words of the format are not scaled.
    [[nodiscard]] double in(const FloatFormat& f, int exponent) const;

private:
    enum class Word { none, nan, inf, max, min, tiny };
    Word word_ = Word::none;
    Real base_;
    bool negative_ = false;
    int step_ = 0;
};

}  // namespace lostbits::scene::toml
