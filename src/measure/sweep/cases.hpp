// Named cases at the extremes: is a form right there, and if not, how is it wrong?
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "measure/map/map.hpp"
#include "scene/sweep/case_file.hpp"

namespace lostbits {

/// What a case comes to. Wrong decisions come before wrong values, and of several kinds the most frequent counts.
enum class Verdict : std::uint8_t { right, wrong_value, false_hit, false_miss, not_a_number, unresolved };

inline constexpr std::array<std::string_view, 6> verdict_names{"right", "wrong_value", "false_hit", "false_miss", "not_a_number", "unresolved"};

struct CaseRequest {
    const scene::CaseFile* file = nullptr;
    std::vector<MapRow> rows;
    std::vector<const Metric*> metrics;  ///< with lost_bits and excess_bits
    TruthLimit limit{};
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
};

/// Every row of every case, in the file's order; in parallel over the cases. Each format gets the case's rays as its own
/// numbers, and its own truth.
std::vector<std::vector<MapSummary>> run_cases(const CaseRequest& request);
/// One row over several cases as if they were one.
MapSummary run_cases_together(const CaseRequest& request, std::size_t row, const std::vector<std::size_t>& numbers);

/// `right`: every decision is, and no answer is more than `within` bits beyond the envelope of half an ulp in each input.
Verdict verdict_of(const MapSummary& summary, const std::vector<const Metric*>& metrics, double within);

}  // namespace lostbits
