// How far off many answers are, as columns: at first as closely as the truth is known, then as closely as it must be.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "measure/answer/outcome.hpp"
#include "measure/sweep/axis_columns.hpp"

namespace lostbits::measure::sweep {

/// Of one form at the floats of some columns.
class UlpColumns {
public:
    using Outcomes = std::array<std::uint64_t, answer::outcomes_of_one_solid>;

    /// The answers of a form beside the truth of the same floats.
    UlpColumns(const AxisColumns& columns, const truth::ColumnTerms& terms) : columns_(columns), terms_(terms) {}
    void compare(std::span<const float> t, std::span<const std::uint8_t> hit, const truth::TruthColumns& truth);

    [[nodiscard]] std::size_t size() const { return outcome_.size(); }
    [[nodiscard]] const Outcomes& counts() const { return counts_; }
    [[nodiscard]] answer::Outcome outcome(std::size_t i) const { return static_cast<answer::Outcome>(outcome_[i]); }

    /// |ulp error| lies between these, where both hit; elsewhere both are −1.
    [[nodiscard]] double at_least(std::size_t i) const { return low_[i]; }
    [[nodiscard]] double at_most(std::size_t i) const { return high_[i]; }
    /// The largest of each, −1 for none.
    [[nodiscard]] double most_at_least() const { return most_low_; }
    [[nodiscard]] double most_at_most() const { return most_high_; }

    /// Brings the two closer together, to 2^-48 of themselves, where truths in packs can; for floats where both hit.
    void refine(std::span<const std::size_t> places);
    /// The error by the whole truth of float i, signed: what `lostbits explain` says.
    [[nodiscard]] double exact(std::size_t i);

private:
    void classify(std::span<const std::uint8_t> hit, const truth::TruthColumns& truth);
    void settle(std::size_t i, double ulps);

    const AxisColumns& columns_;
    truth::ColumnTerms terms_;
    std::span<const float> t_;
    std::vector<std::uint8_t> outcome_;
    std::vector<double> low_, high_;
    Outcomes counts_{};
    double most_low_ = -1, most_high_ = -1;
    truth::TruthColumns closer_;  ///< of `refine`
};

}  // namespace lostbits::measure::sweep
