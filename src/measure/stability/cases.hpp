// Runs a formula over enclosures once for each answer to the comparisons that the enclosures leave open.
#pragma once

#include <optional>
#include <vector>

#include "measure/stability/neighbours.hpp"

namespace lostbits::measure::stability {

/// Runs a formula over all problems near one. If Kleene's logic does not decide its result, the formula runs again
/// twice: with yes and with no as the answer to the first open comparison. Every problem is in one of the cases, so a
/// result that all cases share holds for all problems. A sign that does not affect the decision, such as that of v·d
/// for a ray across a cylinder, then does not limit the result.
class Cases : Near::OpenComparisons {
public:
    /// A number and the sign that it has in a case: −1 for at most 0, +1 for at least 0, 0 for either.
    struct Sign {
        Near number;
        int sign;
    };

    /// True if `run()` returns (known, expected) with both true in every case. After `max_runs` runs, no case is
    /// split.
    template <class Run>
    bool holds_in_all(const Run& run, int max_runs) {
        max_runs_ = max_runs;
        answers_.clear();
        contradiction_.clear();
        run_count_ = 0;
        Near::OpenComparisons* const outer_open = Near::open_comparisons;
        Near::open_comparisons = this;
        const bool is_same = holds_in_remaining_cases(run);
        Near::open_comparisons = outer_open;
        return is_same;
    }
    /// Numbers whose signs lead to another result, after `holds_in_all` has returned false: those of the last case that
    /// ran.
    [[nodiscard]] const std::vector<Sign>& contradiction() const { return contradiction_; }
    /// Adds a number that would change the result if it were 0, for a formula that decides without a comparison.
    void watch(const Near& x) { watched_.push_back({x, 0}); }

    Tri is_below(const Near& x, bool or_equal) override {
        const unsigned yes_signs = or_equal ? below | zero : below;
        unsigned possible = below | zero | above;
        for (const KnownSign& known : known_)
            if (const int k = known.x.compare_up_to_sign(x); k != 0)
                possible &= k > 0 ? known.signs : mirror_signs(known.signs);
        if ((possible & ~yes_signs) == 0) return Tri::yes;
        if ((possible & yes_signs) == 0) return Tri::no;
        if (used_answers_ == answers_.size()) {
            if (!is_open_) open_number_ = x;
            is_open_ = true;
            return Tri::unknown;
        }
        const bool answer = answers_[used_answers_++];
        known_.push_back({x, possible & (answer ? yes_signs : ~yes_signs)});
        return answer ? Tri::yes : Tri::no;
    }

private:
    enum : unsigned { below = 1, zero = 2, above = 4 };
    static unsigned mirror_signs(unsigned signs) {
        return (signs & zero) | ((signs & below) != 0 ? above : 0U) | ((signs & above) != 0 ? below : 0U);
    }
    struct KnownSign {
        Near x;
        unsigned signs;
    };

    template <class Run>
    bool holds_in_remaining_cases(const Run& run) {
        used_answers_ = 0;
        is_open_ = false;
        known_.clear();
        watched_.clear();
        const bool is_last_run = ++run_count_ > max_runs_;
        const auto [known, expected] = run();
        if (known && expected) return true;
        if (known || !is_open_ || is_last_run) {
            record_contradiction(known);
            return false;
        }
        for (const bool answer : {true, false}) {
            answers_.push_back(answer);
            const bool is_same = holds_in_remaining_cases(run);
            answers_.pop_back();
            if (!is_same) return false;
        }
        return true;
    }
    void record_contradiction(bool known) {
        contradiction_ = watched_;
        for (const KnownSign& k : known_)
            contradiction_.push_back({k.x, (k.signs & above) == 0 ? -1 : (k.signs & below) == 0 ? 1 : 0});
        if (!known && is_open_) contradiction_.push_back({open_number_, 0});
    }

    std::vector<bool> answers_;  ///< answers to the first open comparisons
    std::size_t used_answers_ = 0;
    int run_count_ = 0, max_runs_ = 0;
    bool is_open_ = false;  ///< a later comparison is open: that of `open_number_` with 0
    Near open_number_;
    std::vector<KnownSign> known_;
    std::vector<Sign> watched_, contradiction_;
};

}  // namespace lostbits::measure::stability
