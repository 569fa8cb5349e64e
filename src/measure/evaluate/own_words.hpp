// What a form says of its own answer, for the metrics that ask.
#pragma once

#include <optional>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::evaluate {

/// Of ray i and one solid; of the levels of a hierarchy, of the one that is truly met, nothing where `truly` is below
/// 0. Empty of what `needs` does not name or the form cannot tell.
class OwnWords {
public:
    OwnWords(const TestedForm& row, unsigned needs, const truth::FormatInputs& inputs, const Ray<double>& ray,
             std::size_t i, std::size_t solid, std::int32_t truly);
    /// Points the sample to this, which must outlive it.
    void into(metric::Sample& sample) const;

private:
    std::optional<intersect::BoundedAnswer> bounded_;
    std::optional<intersect::Way> way_;
    std::optional<answer::Steps> steps_;
    std::optional<answer::Levels> levels_;
    double end_margin_ = truth::missing;
};

}  // namespace lostbits::measure::evaluate
