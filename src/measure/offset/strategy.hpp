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
    Respawn<float> (*in_float)(const Leaving<float>&);
    Respawn<double> (*in_double)(const Leaving<double>&);
    Respawn<RoundedAny> (*in_any)(const Leaving<RoundedAny>&);
    Respawn<Counted<float>> (*counted)(const Leaving<Counted<float>>&);

    template <class T>
    [[nodiscard]] Respawn<T> respawn(const Leaving<T>& l) const {
        if constexpr (std::is_same_v<T, float>) return in_float(l);
        else if constexpr (std::is_same_v<T, double>) return in_double(l);
        else return in_any(l);
    }
    /// Returns the number of operations for one new ray, as the rule is written. Additions, products, quotients, roots,
    /// comparisons, selections, conversions and moves of bits count one each.
    [[nodiscard]] std::uint64_t operations(Shape shape) const;
};

/// Rows of the table, in the order of every output.
std::span<const Strategy> strategies();
/// The same rows, as a vector of pointers.
std::vector<const Strategy*> all_strategies();

}  // namespace lostbits::measure::offset
