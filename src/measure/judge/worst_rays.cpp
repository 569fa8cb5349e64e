#include "measure/judge/worst_rays.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace lostbits::measure::judge {

using answer::Outcome;

ReportedRay WorstRays::make_reported_ray(std::uint64_t first, std::size_t i, const evaluate::BandResult& result) const {
    // Two primitives decide which hit is nearest: the one that the form hits and the one truly hit.
    std::set<int> deciding;
    if (result.answers->march.empty()) {
        if (result.answers->hit[i] != 0) deciding.insert(result.answers->primitive[i]);
        if (result.truth(i).is_hit()) deciding.insert(result.truth(i).primitive);
    }
    return {.ray_index = first + i,
            .outcome = result.outcomes[i],
            .ulps = result.metrics[ulp_error_][i],
            .ray_group = result.band->make_original_group(i, deciding)};
}

bool WorstRays::is_among_worst(double error) const {
    return errors_.size() < max_rays_ || error > std::fabs(errors_.back().ulps);
}

void WorstRays::insert_error(ReportedRay&& ray) {
    const auto magnitude = [](const ReportedRay& ray_kept) { return std::fabs(ray_kept.ulps); };
    if (errors_.size() == max_rays_) errors_.pop_back();
    errors_.insert(std::ranges::upper_bound(errors_, magnitude(ray), std::greater<>(), magnitude), std::move(ray));
}

void WorstRays::add_fault(ReportedRay&& ray) {
    auto& faults = faults_[static_cast<std::size_t>(ray.outcome)];
    if (faults.size() < max_rays_) faults.push_back(std::move(ray));
}

void WorstRays::add_rays(std::uint64_t first, const evaluate::BandResult& result) {
    if (max_rays_ == 0) return;
    const std::vector<double>& ulps = result.metrics[ulp_error_];
    for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
        const Outcome outcome = result.outcomes[i];
        if (outcome == Outcome::agree_miss || outcome == Outcome::unresolved) continue;
        if (outcome != Outcome::agree_hit) {
            if (faults_[static_cast<std::size_t>(outcome)].size() < max_rays_)
                add_fault(make_reported_ray(first, i, result));
            continue;
        }
        // An answer with an error of at most half an ulp is never reported as the worst.
        const double error = std::fabs(ulps[i]);
        if (error > 0.5 && is_among_worst(error)) insert_error(make_reported_ray(first, i, result));
    }
}

void WorstRays::append(WorstRays&& next) {
    for (ReportedRay& ray : next.errors_) {
        if (is_among_worst(std::fabs(ray.ulps))) insert_error(std::move(ray));
    }
    for (auto& faults : next.faults_) {
        for (ReportedRay& ray : faults) add_fault(std::move(ray));
    }
}

std::vector<ReportedRay> WorstRays::all() const {
    std::vector<ReportedRay> rays = errors_;
    for (const Outcome outcome : evaluate::wrong_decisions) {
        const auto& found = faults_[static_cast<std::size_t>(outcome)];
        rays.insert(rays.end(), found.begin(), found.end());
    }
    return rays;
}

}  // namespace lostbits::measure::judge
