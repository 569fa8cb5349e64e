// Columns of the summaries of studies: of offsets, of rendered pictures, of consistency.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "number/error.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::measure::metric {

/// Named column of a summary: a number computed from the parameters.
template <class... Args>
struct MeasuredColumn {
    std::string_view name, unit, meaning;
    bool is_count;
    double (*value)(Args...);  ///< NaN if it does not exist, as a share of nothing or a quantile of no numbers
};

/// Finds a column by its name. Throws InputError for an unknown name, with did-you-mean. `where` starts the message.
template <class... Args>
const MeasuredColumn<Args...>& column_named(std::span<const MeasuredColumn<Args...>> columns, const std::string& name,
                                            const std::string& where) {
    std::vector<std::string> names;
    for (const auto& column : columns) {
        if (column.name == name) return column;
        names.emplace_back(column.name);
    }
    throw InputError(where + ": unknown metric \"" + name + "\"; " + text::did_you_mean(name, names));
}

}  // namespace lostbits::measure::metric
