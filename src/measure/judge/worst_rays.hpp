// Rays of one row to look at more closely: the largest errors, and the first wrong decisions of each kind.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::judge {

struct ReportedRay {
    std::uint64_t ray_index = 0;  ///< index in the file, from 0
    answer::Outcome outcome = answer::Outcome::agree_hit;
    double ulps = 0;                                              ///< (t − t*)/ulp(t*), for a correct hit
    std::shared_ptr<const scene::rays::RayGroup> ray_group = {};  ///< the ray, and the primitives that decide its hit
};

/// Keeps up to `most` rays of each kind: correct hits with the largest |ulp_error|, the first among equal errors, and
/// the first rays with each wrong decision.
class WorstRays {
public:
    /// `ulp_error` is the index of that metric among the measured metrics.
    explicit WorstRays(std::size_t most = 0, std::size_t ulp_error = 0) : max_rays_(most), ulp_error_(ulp_error) {}

    /// Adds rays of the file, from index `first` on.
    void add_rays(std::uint64_t first, const evaluate::BandResult& result);
    /// Adds the next rays of the file.
    void append(WorstRays&& next);
    /// The largest errors, followed by the wrong decisions in the file's order.
    [[nodiscard]] std::vector<ReportedRay> all() const;

    template <class Archive>
    void fields(Archive& archive) {
        archive(max_rays_, ulp_error_, errors_, faults_);
    }

private:
    void insert_error(ReportedRay&& ray);
    void add_fault(ReportedRay&& ray);
    [[nodiscard]] bool is_among_worst(double error) const;
    ReportedRay make_reported_ray(std::uint64_t first, std::size_t i, const evaluate::BandResult& result) const;

    std::size_t max_rays_, ulp_error_;
    std::vector<ReportedRay> errors_;  ///< in descending order of |ulp_error|
    std::array<std::vector<ReportedRay>, answer::outcome_names.size()> faults_;
};

}  // namespace lostbits::measure::judge
