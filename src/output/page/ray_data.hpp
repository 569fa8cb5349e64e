// The rays of a map whose operations the page holds, as `lostbits explain` has them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "output/page/text.hpp"

namespace lostbits::output::page {

/// A pixel whose operations are held, and why: words that the page writes as it writes names of outcomes.
struct ChosenRay {
    int x, y;
    std::vector<std::string> why;
};

/// A picture is cut into so many parts each way, and the worst ray of each part is chosen.
inline constexpr std::size_t parts_each_way = 4;

/// The worst ray first, then the first of each kind of wrong decision, the largest and the median error, and the worst
/// of each part of the picture, each once. `sizes`: a pixel each, |ulp_error| of a correct hit, infinity of a wrong
/// decision, NaN of what has no error.
[[nodiscard]] std::vector<ChosenRay> choose_rays(const measure::evaluate::FormSummary& summary,
                                                 std::span<const float> sizes, int width);

/// What `explain` says of each ray: its sentences, and its table a row an operation. Of a form that is compiled
/// elsewhere nothing is known.
[[nodiscard]] Json rays_json(const measure::evaluate::EvaluationRequest& request,
                             const measure::evaluate::TestedForm& row, const std::vector<ChosenRay>& rays);

}  // namespace lostbits::output::page
