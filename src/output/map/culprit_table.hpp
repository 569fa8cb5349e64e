// How often each operation is the culprit: a row per form, format and operation.
#pragma once

#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::map {

/// An operation that is the culprit of some rays: as columns of a summary, operations would differ from run to run.
struct Culprit {
    measure::evaluate::TestedForm row;
    std::string_view operation;
    std::uint64_t rays;
    double fraction;
};
table::Table<Culprit> culprit_table();

/// Only where `culprit` is among the metrics.
[[nodiscard]] bool asks_for_culprits(const std::vector<const measure::metric::Metric*>& metrics);

/// The most frequent first.
std::vector<Culprit> culprits_of(const std::vector<const measure::metric::Metric*>& metrics,
                                 const measure::evaluate::TestedForm& row,
                                 const measure::evaluate::FormSummary& summary);

/// The operations that are the culprit of any ray, by their categories, the most frequent first; of equals the first on
/// the tape.
std::vector<std::size_t> culprits_by_count(const std::vector<std::uint64_t>& counts);

}  // namespace lostbits::output::map
