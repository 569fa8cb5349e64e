#include "measure/evaluate/row_sums.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "measure/truth/missing.hpp"

namespace lostbits::measure::evaluate {

using answer::Outcome;
using truth::missing;
using truth::Truth;

WorstRay RowSums::worst(std::size_t i) const {
    WorstRay w = named(i, Outcome::agree_hit);
    w.ulps = ulps_[i];
    w.size = std::fabs(ulps_[i]);
    return w;
}

void RowSums::keep_worst(FormSummary& summary, double largest) const {
    if (!(largest > summary.worst.size)) return;
    const auto is_it = [largest](double ulps) { return std::fabs(ulps) == largest; };
    const double* const end = ulps_ + result_.outcomes.size();
    const double* const found = std::find_if(ulps_, end, is_it);
    if (found != end) summary.worst = worst(static_cast<std::size_t>(found - ulps_));  // else no ray is measured
}

void RowSums::keep_faults(FormSummary& summary) const {
    for (std::size_t kind = 0; kind < wrong_decisions.size(); ++kind) {
        auto& fault = summary.faults.at(kind);
        if (fault || summary.count(wrong_decisions[kind]) == 0) continue;
        const auto i = std::ranges::find(result_.outcomes, wrong_decisions[kind]) - result_.outcomes.begin();
        fault = std::make_unique<WorstRay>(named(static_cast<std::size_t>(i), wrong_decisions[kind]));
    }
}

void RowSums::add(const BandPart& part) const {
    FormSummary& summary = *part.summary;
    std::optional<std::size_t> farthest;
    double largest = summary.worst.size;
    summary.rays += part.rays.size();
    for (const std::uint32_t i : part.rays) {
        ++summary.outcomes[static_cast<std::size_t>(result_.outcomes[i])];
        summary.true_hits += static_cast<std::uint64_t>(truth_.decision[i] == Truth::Decision::hit);
        if (!(std::fabs(ulps_[i]) > largest)) continue;
        farthest = i;
        largest = std::fabs(ulps_[i]);
    }
    if (farthest) summary.worst = worst(*farthest);
    std::vector<double> values(part.rays.size());
    for (std::size_t m = 0; m < request_.metrics.size(); ++m) {
        std::ranges::transform(part.rays, values.begin(), [&](std::uint32_t i) { return result_.metrics[m][i]; });
        summary.add(m, *request_.metrics[m], values);
    }
    for (std::size_t kind = 0; kind < wrong_decisions.size(); ++kind) {
        if (summary.faults.at(kind) || summary.count(wrong_decisions[kind]) == 0) continue;
        const auto is_it = [&](std::uint32_t i) { return result_.outcomes[i] == wrong_decisions[kind]; };
        const auto i = *std::ranges::find_if(part.rays, is_it);
        summary.faults[kind] = std::make_unique<WorstRay>(named(i, wrong_decisions[kind]));
    }
}

WorstRay RowSums::named(std::size_t i, Outcome outcome) const {
    const bool hit = result_.answers->hit[i] != 0, tells_t = row_.form->info->roots != intersect::Roots::none;
    const Truth truth = result_.truth(i);
    const int object = hit ? result_.answers->object[i] : truth.object;
    // The place of the band's first ray among all.
    const std::int64_t first = request_.first + std::int64_t{result_.y0} * result_.width;
    WorstRay w{.x = request_.first + static_cast<std::int64_t>(i % static_cast<std::size_t>(result_.width)),
               .y = result_.y0 + static_cast<int>(i / static_cast<std::size_t>(result_.width)),
               .group = request_.group,
               .object = result_.inputs->paired && object >= 0 ? first + object : object,
               .size = 0,
               .ray = result_.inputs->rays[i],
               .solid = result_.inputs->solids[static_cast<std::size_t>(std::max(0, object))],
               .t = hit && tells_t ? result_.answers->t[i] : missing,
               .outcome = outcome,
               .judged = row_.judged};
    if (truth.is_hit())
        w.truth = result_.band->rounded_truth(i, binary64, row_.form->info->direction, row_.convention());
    // The nearest of all solids is the nearer of these two; a field of distances is of all of them.
    std::set<int> deciding;
    if (is_solid(row_.form->shape)) {
        if (hit) deciding.insert(object);
        if (truth.is_hit()) deciding.insert(truth.object);
    }
    w.given = result_.band->given(i, deciding);
    return w;
}

}  // namespace lostbits::measure::evaluate
