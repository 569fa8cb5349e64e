// Table of strategies. A strategy is a rule for the start of a new ray: one function and one row of strategy.cpp.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "measure/offset/leaving.hpp"
#include "number/counted.hpp"
#include "number/with_number.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::offset {

struct Strategy {
    std::string_view name;    ///< `offset.integer`
    std::string_view title;   ///< the new origin, in one line
    std::string_view source;  ///< publication of the rule
    bool keeps_point;  ///< true if the new origin is p itself, so that the rule only limits what the ray is tested
                       ///< against
    StrategyOutput<float> (*respawn_in_float)(const StrategyInput<float>&);
    StrategyOutput<double> (*respawn_in_double)(const StrategyInput<double>&);
    StrategyOutput<RoundedAny> (*respawn_in_any)(const StrategyInput<RoundedAny>&);
    StrategyOutput<Counted<float>> (*respawn_counted)(const StrategyInput<Counted<float>>&);

    template <class T>
    [[nodiscard]] StrategyOutput<T> respawn(const StrategyInput<T>& input) const {
        if constexpr (std::is_same_v<T, float>) return respawn_in_float(input);
        else if constexpr (std::is_same_v<T, double>) return respawn_in_double(input);
        else return respawn_in_any(input);
    }
    /// Returns the number of operations for one new ray, as the rule is written. Additions, products, quotients, roots,
    /// comparisons, selections, conversions and moves of bits count one each.
    [[nodiscard]] std::uint64_t operation_count(Shape shape) const;
};

/// Rows of the table, in the order of every output.
std::span<const Strategy> strategies();
/// The same rows, as a vector of pointers.
std::vector<const Strategy*> all_strategies();

}  // namespace lostbits::measure::offset
