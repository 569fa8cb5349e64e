// Named cases at the extremes: is a form right there, and if not, how is it wrong?
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "scene/sweep/case_file.hpp"

namespace lostbits::measure::sweep {

/// What a case comes to. Wrong decisions come before wrong values, and of several kinds the most frequent counts.
enum class Verdict : std::uint8_t {
    right,
    within_inputs,
    wrong_value,
    false_hit,
    false_miss,
    not_a_number,
    unresolved,
    wrong_object
};

inline constexpr std::array<std::string_view, 8> verdict_names{
    "right", "within_inputs", "wrong_value", "false_hit", "false_miss", "not_a_number", "unresolved", "wrong_object"};

struct CaseRequest {
    const scene::sweep::CaseFile* file = nullptr;
    std::vector<evaluate::TestedForm> rows;
    std::vector<const metric::Metric*> metrics;  ///< with lost_bits and excess_bits
    truth::TruthLimit limit{};
    shard::Share share = {};  ///< of the cases
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
};

/// Every row of every case of the share, in the file's order; in parallel over the cases. Each format gets the case's
/// rays as its own numbers, and its own truth.
std::vector<std::vector<evaluate::FormSummary>> run_cases(const CaseRequest& request);
/// One row over several cases as if they were one.
evaluate::FormSummary run_cases_together(const CaseRequest& request, std::size_t row,
                                         const std::vector<std::size_t>& numbers);

/// `right`: every decision is, and no answer loses more than `within` bits. `within_inputs`: every decision is right,
/// and what an answer loses is at most `within` bits beyond the envelope of half an ulp in each input.
Verdict verdict_of(const evaluate::FormSummary& summary, const std::vector<const metric::Metric*>& metrics,
                   double within);

}  // namespace lostbits::measure::sweep
