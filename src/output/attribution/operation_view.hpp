// Names and numbers of the operations of an explained ray, for its table and sentences.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "measure/attribution/explanation.hpp"
#include "measure/attribution/tape_text.hpp"

namespace lostbits::output::attribution {

using measure::attribution::Explanation;
using measure::attribution::TapeText;

/// A number with three digits. A NaN is `nan` without a sign, because its sign means nothing and differs between
/// machines.
std::string short_number(double x);

/// A number for a sentence: its digits, `infinity`, `minus infinity` or `not a number`.
std::string number_phrase(double x);
/// `3.5 ulp`; empty for a number that is not finite.
std::string ulps_or_nothing(double ulps);

/// A view of an explanation with the names and the ulps of its operations.
class OperationView {
public:
    explicit OperationView(const Explanation& explanation);

    [[nodiscard]] const measure::attribution::OperationError& error_of(NodeId i) const {
        return explanation_.attribution[i];
    }
    [[nodiscard]] const TapeText& text() const { return text_; }
    /// `error` in ulps of the format at the value itself.
    [[nodiscard]] double ulps_of_value(NodeId i, double error) const;
    /// Contribution of an operation to the error, in ulps of the subject.
    [[nodiscard]] double contribution(NodeId i) const { return error_of(i).contribution / ulp_; }
    /// Number of cancelled bits and kind of cancellation: `24 catastrophic`. Empty if no bit is cancelled.
    [[nodiscard]] std::string cancellation(NodeId i) const;
    /// True if the answer is computed from the operation, or if the operation only chose a branch or was only compared.
    /// False for operations of a branch that was not taken and, in a miss, for operations from which only t is
    /// computed.
    [[nodiscard]] bool is_on_path(NodeId i) const { return on_path_[i]; }
    /// True if the table has a row for the operation.
    [[nodiscard]] bool is_shown(NodeId i, bool show_all) const;
    /// Operations that the expression of operation i refers to by name.
    [[nodiscard]] std::vector<NodeId> operations_named_in(NodeId i) const;
    /// Size of an ulp of the subject.
    [[nodiscard]] double ulp() const { return ulp_; }
    /// Name of the value that contributions go to: t, or the value that the decision compares. Contributions are in
    /// ulps of this value.
    [[nodiscard]] std::string subject() const;

private:
    const Explanation& explanation_;
    TapeText text_;
    double ulp_;
    std::vector<bool> on_path_;
    /// Operations by name; a vector's name maps to its three components.
    std::map<std::string, std::vector<NodeId>, std::less<>> nodes_by_name_;
};

/// A row of the table of operations.
struct OperationRow {
    NodeId node = no_node;
    /// True if the row shows errors. False for an operation of an earlier sample of a march, shown because another row
    /// names it: its row has only the values.
    bool shows_errors = true;
    bool is_culprit = false;         ///< the operation is to blame
    bool is_branch_flipped = false;  ///< rounding chose the other side
    bool is_on_purpose = false;      ///< not a rounding: the form goes to the next number
    bool is_off_path = false;        ///< the answer is not computed from it (`OperationView::is_on_path`)
    std::string name = {}, formula = {};
    double computed = 0, exact = 0;  ///< 1 or 0 for a decision
    int digits = 0;                  ///< digits that tell numbers of the operation's format apart; 0: a decision
    /// Texts, empty if there is nothing to show: the error and the rounding in ulps of the value, the cancellation
    /// (`24 catastrophic`), the bits lost locally, and the contribution. The contribution is the part of the subject's
    /// error that is assigned to the rounding, in ulps of the subject.
    std::string error_ulps = {}, cancelled = {}, local_bits = {}, rounding_ulps = {}, contribution_ulps = {};
};

/// Rows of the table, see `explain_text`. `first_node` is the first node of the last samples of a march; nodes before
/// it belong to earlier samples.
struct OperationTable {
    NodeId first_node = 0;
    std::vector<OperationRow> rows = {};
};
OperationTable operation_table(const Explanation& explanation, const OperationView& view, bool show_all);

/// Number of decimal digits that tell any two numbers of a format apart.
int digits_of(const FloatFormat& format);

}  // namespace lostbits::output::attribution
