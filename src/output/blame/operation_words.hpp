// What the table and the sentences of an explained ray say of its operations.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "measure/blame/explanation.hpp"
#include "measure/blame/tape_text.hpp"

namespace lostbits::output::blame {

/// Three digits; `nan` without the sign that says nothing and that machines choose differently.
std::string short_number(double x);

/// A number in a sentence: its digits, `infinity`, `minus infinity` or `not a number`.
std::string number_words(double x);
/// `3.5 ulp`; of what is not finite nothing, as there is no such number of ulps.
std::string ulps_or_nothing(double ulps);

/// A view of an explanation, with the names and the ulps of its operations.
class OperationWords {
public:
    explicit OperationWords(const measure::blame::Explanation& x);

    [[nodiscard]] const measure::blame::OperationError& of(NodeId i) const { return x_.attribution[i]; }
    [[nodiscard]] const measure::blame::TapeText& text() const { return text_; }
    /// In ulps of the format at the value itself.
    [[nodiscard]] double own_ulps(NodeId i, double error) const;
    /// In ulps of the subject.
    [[nodiscard]] double contribution(NodeId i) const { return of(i).contribution / ulp_; }
    /// `24 catastrophic`
    [[nodiscard]] std::string cancellation(NodeId i) const;
    /// Says if the answer is computed from it: what only chose a branch, or was compared and not taken, too. Not what
    /// stands on a side that was not taken, and of a miss not what only t is computed from.
    [[nodiscard]] bool is_on_way(NodeId i) const { return on_way_[static_cast<std::size_t>(i)]; }
    /// Whether the table has a row for it.
    [[nodiscard]] bool is_shown(NodeId i, bool all) const;
    /// The operations that its expression calls by their names.
    [[nodiscard]] std::vector<NodeId> named_in(NodeId i) const;
    /// Of the subject.
    [[nodiscard]] double ulp() const { return ulp_; }
    /// What the contributions are to, in whose ulps they are: t, or what the decision compares.
    [[nodiscard]] std::string subject() const;

private:
    const measure::blame::Explanation& x_;
    measure::blame::TapeText text_;
    double ulp_;
    std::vector<bool> on_way_;
    std::map<std::string, std::vector<NodeId>, std::less<>> called_;  ///< operations by name; by a vector's all three
};

/// A row of the table of operations.
struct OperationRow {
    NodeId node = no_node;
    /// False: of an earlier sample of a march, which another row names. Its values stand there alone.
    bool whole = true;
    bool culprit = false;     ///< and one worth its name
    bool turned = false;      ///< rounding chose the other side
    bool on_purpose = false;  ///< no rounding: the form goes to the next number
    bool aside = false;       ///< not on the way to the answer
    std::string name = {}, formula = {};
    double computed = 0, exact = 0;  ///< of a decision 1 or 0
    int digits = 0;                  ///< that tell numbers of its format apart; 0: a decision
    /// How far off in ulps of its own, `24 catastrophic`, bits, its rounding in ulps of its own, and what is assigned
    /// to that in ulps of the subject; empty where there is nothing to say.
    std::string off = {}, cancelled = {}, local = {}, own = {}, share = {};
};

/// The rows of the table: see `explain_text`. `first`: of the nodes from which it goes on, behind earlier samples.
struct OperationTable {
    NodeId first = 0;
    std::vector<OperationRow> rows = {};
};
OperationTable operation_table(const measure::blame::Explanation& x, const OperationWords& words, bool all);

/// Digits that tell numbers of a format apart.
int digits_of(const FloatFormat& format);

}  // namespace lostbits::output::blame
