// What an explained ray comes to: the answer, whose the loss is, which operation, and what does better.
#pragma once

#include <optional>
#include <string>

#include "measure/answer/one_ray.hpp"
#include "measure/blame/explanation.hpp"

namespace lostbits::output::blame {

/// How the march of a form ended: its log and the constants that it had.
struct MarchEnd {
    intersect::table::MarchLog log;
    intersect::MarchConstants<double> constants;
};

/// Bits that another form must keep more than this one to be called better, and that must be lost before an operation
/// is to blame: below one bit lies what the last rounding of any formula may cost.
inline constexpr double worth_saying = 1;

/// Whether an operation is to blame, and worth its name: rounding in the form turned the decision, made a value that
/// is not a number, or costs a bit or more of an answer that lost one. What a march stops short, and what the format
/// does to the inputs, no operation lost.
bool names_culprit(const measure::blame::Explanation& x);

/// Whether the roundings of the operations make what is lost, so that wider arithmetic on the same inputs would keep
/// it.
bool rounding_explains(const measure::blame::Explanation& x);

/// Whether the answer is another crossing of the solid that the ray truly meets.
bool is_wrong_root(const measure::blame::Explanation& x);

/// The sentences that stand first. `march` where the form marches.
std::string verdict_text(const measure::blame::Explanation& x, const std::optional<MarchEnd>& march);
/// Those of them that are of the form itself, and not of what other forms do.
std::string verdict_alone(const measure::blame::Explanation& x, const std::optional<MarchEnd>& march);

}  // namespace lostbits::output::blame
