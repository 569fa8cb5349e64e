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

/// A view of an explanation, with the names and the ulps of its operations.
class OperationWords {
public:
    explicit OperationWords(const measure::blame::Explanation& x);

    [[nodiscard]] const measure::blame::OperationError& of(NodeId i) const {
        return x_.attribution.of[static_cast<std::size_t>(i)];
    }
    [[nodiscard]] const measure::blame::TapeText& text() const { return text_; }
    /// In ulps of the format at the value itself.
    [[nodiscard]] double own_ulps(NodeId i, double error) const;
    /// In ulps of the subject.
    [[nodiscard]] double contribution(NodeId i) const { return of(i).contribution / ulp_; }
    /// `24 catastrophic`
    [[nodiscard]] std::string cancellation(NodeId i) const;
    /// Whether the table has a row for it.
    [[nodiscard]] bool is_shown(NodeId i, bool all) const;
    /// The operations that its expression calls by their names.
    [[nodiscard]] std::vector<NodeId> named_in(NodeId i) const;
    /// Of the subject.
    [[nodiscard]] double ulp() const { return ulp_; }

private:
    const measure::blame::Explanation& x_;
    measure::blame::TapeText text_;
    double ulp_;
    std::map<std::string, std::vector<NodeId>, std::less<>> called_;  ///< operations by name; by a vector's all three
};

}  // namespace lostbits::output::blame
