// Sentences about single operations: how often a sum or a difference does not notice one of its operands.
#pragma once

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
    double (*fraction)(const FloatFormat&, double at);
};

/// All rows. Their samples are 4096 significands drawn with one seed, every result correctly rounded in the format.
std::span<const ArithmeticRow> arithmetic_rows();

}  // namespace lostbits::measure::claim
