// One ray and one form, and a bound over ranges of inputs, as a person reads them, and as other programs do.
#pragma once

#include <optional>
#include <string>

#include "measure/answer/one_ray.hpp"
#include "measure/apriori/ranges.hpp"
#include "measure/blame/explanation.hpp"
#include "output/blame/operation_words.hpp"

namespace lostbits::output::blame {

/// How the march of a form ended: its log and the constants that it had.
struct MarchEnd {
    intersect::table::MarchLog log;
    intersect::MarchConstants<double> constants;
};

/// How the march of a form ended along a ray; nothing for a form that does not march.
std::optional<MarchEnd> end_of_march(const intersect::table::Intersector& form, const Format& format,
                                     const measure::answer::OneRay& ray);

/// The conclusions on an explained ray. Text, JSON and page are views of this one: what it says stands in each of
/// them, word for word.
struct ExplainedVerdict {
    std::string
        answer;         ///< how far off it is, or what became of the decision; another primitive, the mesh: a line each
    std::string loss;   ///< whose the loss is: the problem's, the formula's, or nobody's where a march ended
    std::string blame;  ///< which operation, or why none
    NodeId culprit = no_node;  ///< the operation to blame; none where `blame` says that none is

    /// The three, a line each.
    [[nodiscard]] std::string text() const;
};
ExplainedVerdict verdict_of(const measure::blame::Explanation& x, const std::optional<MarchEnd>& march);

/// Which forms do better on the ray and around it, a sentence a line.
std::string better_sentences(const measure::blame::Explanation& x);

/// The verdict, which forms do better, the inputs, the samples of a march, and the table of operations with the culprit
/// marked. `all` shows every operation; otherwise those that the answer is computed from and that round, cancel, or
/// have a name, and those that a row names: of an earlier sample of a march their values.
std::string explain_text(const measure::blame::Explanation& x, bool all, const std::optional<MarchEnd>& march = {});

/// What stands below the table, a sentence a line: what the contributions sum to, what is not rounding's, and which
/// decisions rounding changed.
std::string sums_text(const measure::blame::Explanation& x, const OperationWords& words);

/// Blames the problem or the formula, by the envelope, which is of the problem as it is stored: of a
/// primitive under a matrix that of the world, of a camera's ray that of the ideal one.
std::string envelope_sentence(const measure::blame::Explanation& x);

/// Which operation contributes most, what became of its rounding, and which others contribute as much; or why none
/// does. It is called the culprit where it is to blame.
std::string culprit_sentence(const measure::blame::Explanation& x);
/// What becomes of the answer if the culprit alone did not round, and if it alone did; empty where there is none.
std::string counterfactual_sentence(const measure::blame::Explanation& x);

/// What became of a ray that is not hit by both: `form misses, and so does the exact ray: a correct miss.`; empty where
/// it is.
std::string decision_text(const std::string& form, measure::answer::Outcome outcome, double t, double true_t);

/// Bits that another form must keep more than this one to be called better, and that must be lost before an operation
/// is to blame: below one bit lies what the last rounding of any formula may cost.
inline constexpr double worth_saying = 1;

/// The operation to blame: rounding in the form turned a decision that is wrong, or the order of two primitives, made a
/// value that is not a number, or costs a bit or more of an answer that lost one. None where a decision is right, and
/// of what a march stops short and the format does to the inputs, which no operation lost, and where a value is not a
/// number even without rounding.
NodeId operation_to_blame(const measure::blame::Explanation& x);

/// Whether the roundings of the operations make what is lost, so that wider arithmetic on the same inputs would keep
/// it.
bool rounding_explains(const measure::blame::Explanation& x);

/// Whether the answer is another crossing of the solid that the ray truly meets.
bool is_wrong_root(const measure::blame::Explanation& x);

/// The constants of a march; iteration, t, position, |p|, d and action of every sample.
std::string march_samples(const MarchEnd& march, const Format& format);
/// The same with the form and the ray above, and what the answer is worth below: to be read by itself.
std::string march_table(const intersect::table::Intersector& form, const Format& format,
                        const measure::answer::OneRay& ray);

/// Everything in one JSON object. Inputs and results are there as decimals and as hexadecimal floats. A number that is
/// infinite or NaN is the string "inf", "-inf" or "nan"; what there is not (the error of a miss, the culprit where none
/// is to blame, a direction that was not normalised) is null.
std::string explain_json(const measure::blame::Explanation& x, const std::optional<MarchEnd>& march = {});

/// The live operations as a LaTeX `align*`: cancellations under braces, the culprit in a box. Needs amsmath.
std::string explain_latex(const measure::blame::Explanation& x);

/// A C99 program without anything of ours: the inputs in hexadecimal, the form an operation a line, then the computed,
/// the true and the recorded t, the first and the last of which are the same text where they are the same bits. It
/// exits 0 then, 1 otherwise. Values are volatile, so that no compiler fuses or widens them.
///
/// Formats other than float and double compute in double and round: of at most 25 bits the double alone (2p + 2 ≤ 53:
/// Figueroa 1995), wider ones the double with the sign of what it leaves out (TwoSum; fma for products, quotients and
/// roots). InputError where such a format moves to a neighbour or fuses, and where a wider one comes so near to the
/// ends of double's range that what is left out has no double.
std::string explain_c(const measure::blame::Explanation& x);

/// FPCore 2.0 of t: the arguments are the inputs that it depends on, :pre keeps each within 2^-12 of this ray's, zeros
/// and infinities as they are. A move to a neighbouring number is a sum with the smallest number, rounded upward or
/// downward (`:round`).
std::string explain_fpcore(const measure::blame::Explanation& x);

/// The ranges, how much of them the bound is for, the bound, what rays show of it, and the operations that make it.
std::string ranges_text(const measure::apriori::RangesRequest& request, const measure::apriori::RangesBound& bound);

/// The same in one JSON object; an infinite number is the string "inf".
std::string ranges_json(const measure::apriori::RangesRequest& request, const measure::apriori::RangesBound& bound);

}  // namespace lostbits::output::blame
