#include "measure/judge/worst_rays.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace lostbits::measure::judge {

using answer::Outcome;

NotedRay WorstRays::note(std::uint64_t first, std::size_t i, const map::BandResult& result) const {
    // The nearest of all solids is the nearer of these two.
    std::set<int> deciding;
    if (result.answers->march.empty()) {
        if (result.answers->hit[i] != 0) deciding.insert(result.answers->object[i]);
        if (result.truth(i).is_hit()) deciding.insert(result.truth(i).object);
    }
    return {.place = first + i,
            .outcome = result.outcomes[i],
            .ulps = result.metrics[ulp_error_][i],
            .given = result.band->given(i, deciding)};
}

void WorstRays::look_at(std::uint64_t first, const map::BandResult& result) {
    if (most_ == 0) return;
    const std::vector<double>& ulps = result.metrics[ulp_error_];
    const auto size = [](const NotedRay& ray) { return std::fabs(ray.ulps); };
    for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
        const Outcome outcome = result.outcomes[i];
        if (outcome == Outcome::agree_miss || outcome == Outcome::unresolved) continue;
        if (outcome != Outcome::agree_hit) {
            auto& faults = faults_[outcome];
            if (faults.size() < most_) faults.push_back(note(first, i, result));
            continue;
        }
        const double error = std::fabs(ulps[i]);
        // An answer that is right to the last bit is no worst ray.
        if (!(error > 0.5) || (errors_.size() == most_ && !(error > size(errors_.back())))) continue;
        if (errors_.size() == most_) errors_.pop_back();
        const auto at = std::ranges::upper_bound(errors_, error, std::greater<>(), size);
        errors_.insert(at, note(first, i, result));
    }
}

std::vector<NotedRay> WorstRays::all() const {
    std::vector<NotedRay> rays = errors_;
    for (const Outcome outcome : map::wrong_decisions) {
        const auto found = faults_.find(outcome);
        if (found != faults_.end()) rays.insert(rays.end(), found->second.begin(), found->second.end());
    }
    return rays;
}

}  // namespace lostbits::measure::judge
