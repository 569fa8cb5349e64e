// Sentences about single operations: how often a sum or a difference does not notice one of its operands.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "number/format.hpp"

namespace lostbits::measure::claim {

/// A row of the table "arithmetic": a share of seeded samples, mostly of those whose result an operand does not
/// influence.
struct ArithmeticRow {
    std::string_view name;
    std::string_view argument;  ///< what `at` stands for
    std::string_view meaning;
    int samples;  ///< significands that it draws; 0: it is about one number, or about none
    double (*fraction)(const FloatFormat&, double at, std::uint64_t seed);
};

/// All rows; every result is correctly rounded in the format.
std::span<const ArithmeticRow> arithmetic_rows();

}  // namespace lostbits::measure::claim
