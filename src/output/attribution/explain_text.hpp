// One ray and one form, or a bound over ranges of inputs, as text and as formats for other programs.
#pragma once

#include <optional>
#include <string>

#include "measure/answer/one_ray.hpp"
#include "measure/apriori/ranges.hpp"
#include "measure/attribution/explanation.hpp"
#include "output/attribution/operation_view.hpp"

namespace lostbits::output::attribution {

using measure::answer::Outcome;
using measure::apriori::RangesBound;
using measure::apriori::RangesRequest;

/// The end of a form's march: its log and its constants.
struct MarchEnd {
    intersect::table::MarchLog log;
    intersect::MarchConstants<double> constants;
};

/// The end of a form's march along a ray; nothing for a form that does not march.
std::optional<MarchEnd> find_march_end(const intersect::table::Intersector& form, const Format& format,
                                       const measure::answer::OneRay& ray);

/// Conclusions on an explained ray. Text, JSON and page show these sentences word for word.
struct ExplainedVerdict {
    std::string answer;  ///< how far off the answer is, or which decision is wrong; more lines for another primitive
                         ///< and for the mesh
    std::string loss;    ///< the cause of the loss: the problem, the formula, or neither if a march ended
    std::string blame;   ///< the operation to blame, with a second line on its rounding alone; or why none is
    NodeId culprit = no_node;  ///< the operation to blame; none if `blame` says so

    /// The three texts, each on lines of its own.
    [[nodiscard]] std::string text() const;
};
ExplainedVerdict make_verdict(const Explanation& explanation, const std::optional<MarchEnd>& march);

/// Forms that do better on the ray and around it, one sentence per line.
std::string better_forms_text(const Explanation& explanation);

/// The verdict, the forms that do better, the inputs, the samples of a march, and the table of operations with the
/// culprit marked. With `show_all` the table has every operation. Without, it has the operations that the answer is
/// computed from and that round, cancel or have a name. It also has the operations to which these rows refer. Rows of
/// earlier samples of a march show only values.
std::string explain_text(const Explanation& explanation, bool show_all, const std::optional<MarchEnd>& march = {});

/// Text below the table, one sentence per line: the sum of the contributions, the part of the error that is not due to
/// rounding, and the decisions that rounding changed.
std::string sums_text(const Explanation& explanation, const OperationView& view);

/// Blames the problem or the formula. The envelope is that of the problem as it is stored: for a primitive under a
/// matrix, of the problem in the world; for a camera's ray, of the ideal ray.
std::string envelope_sentence(const Explanation& explanation);

/// Names the operation that contributes most, the effect of its rounding, and others that contribute as much, or says
/// why no operation contributes most. The operation is called the culprit if it is to blame.
std::string culprit_sentence(const Explanation& explanation);
/// Gives the answer if only the culprit were exact, and if only the culprit rounded. Empty if there is no culprit.
std::string counterfactual_sentence(const Explanation& explanation);

/// Sentence for a ray that form and truth do not both hit: `form misses, and so does the exact ray: a correct miss.`
/// Empty if both hit.
std::string decision_text(const std::string& form, Outcome outcome, double t, double true_t);

/// Smallest number of bits that counts as a difference: another form is called better if it keeps this many more, and
/// an operation is to blame only if this many are lost. The last rounding of any formula may cost up to one bit.
inline constexpr double min_notable_bits = 1;

/// The operation to blame. Its rounding
/// - changed a decision, or the order of two primitives,
/// - made a value that is not a number, or
/// - costs a bit or more of an answer that lost one.
/// Returns no_node if the decision is right, and if no operation caused the loss: a march stopped short, the format
/// rounded the inputs, or a value is not a number even without rounding.
NodeId culprit_operation(const Explanation& explanation);

/// True if the roundings of the operations make the loss, so that wider arithmetic on the same inputs would avoid it.
bool rounding_explains(const Explanation& explanation);

/// True if the answer is another crossing of the primitive that the ray truly meets.
bool is_wrong_root(const Explanation& explanation);

/// The constants of a march, and for every sample the iteration, t, position, |p|, d and action.
std::string march_samples(const MarchEnd& march, const Format& format);
/// The form, the ray, the text of `march_samples`, and the accuracy of the answer.
std::string march_table(const intersect::table::Intersector& form, const Format& format,
                        const measure::answer::OneRay& ray);

/// The whole explanation as one JSON object. Inputs and results are given as decimals and as hexadecimal floats. An
/// infinite or NaN number is the string "inf", "-inf" or "nan". Missing values (the error of a miss, the culprit if
/// none is to blame, a direction that was not normalised) are null.
std::string explain_json(const Explanation& explanation, const std::optional<MarchEnd>& march = {});

/// A C99 program that does not need lostbits: the inputs in hexadecimal, the form with one operation per line, then
/// the computed, the true and the recorded t. The program exits with 0 if the computed and the recorded t have the
/// same bits (their texts are then the same too), and with 1 otherwise. Values are volatile, so that no compiler fuses
/// or widens them.
///
/// Formats other than float and double compute in double and round. For at most 25 bits the double alone is enough (2p
/// + 2 ≤ 53: Figueroa 1995). For more bits the program also uses the sign of the double's remainder (TwoSum; fma for
/// products, quotients and roots).
///
/// Throws InputError if a form in a format other than float and double moves to a neighbouring number or fuses. Also
/// throws it if a value in a format of more than 25 bits is so near to the ends of double's range that the remainder is
/// not a double.
std::string explain_c(const Explanation& explanation);

/// t as an FPCore 2.0 expression. Its arguments are the inputs that t depends on. `:pre` keeps each input within 2^-12
/// of its value for this ray, and zeros and infinities as they are. A move to a neighbouring number is a sum with the
/// smallest number, rounded upward or downward (`:round`).
std::string explain_fpcore(const Explanation& explanation);

/// Lists the ranges of the inputs, the bound and the part of the ranges that it covers. Then lists the errors of rays
/// in the ranges, and the operations that contribute to the bound.
std::string ranges_text(const RangesRequest& request, const RangesBound& bound);

/// The content of `ranges_text` as one JSON object; an infinite number is the string "inf".
std::string ranges_json(const RangesRequest& request, const RangesBound& bound);

}  // namespace lostbits::output::attribution
