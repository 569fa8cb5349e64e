// The rays of one row that are worth a second look: the largest errors, and the first wrong decisions of each kind.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::judge {

struct NotedRay {
    std::uint64_t place = 0;  ///< in the file, from 0
    answer::Outcome outcome = answer::Outcome::agree_hit;
    double ulps = 0;  ///< (t − t*)/ulp(t*) of a correct hit
    std::shared_ptr<const scene::rays::RayGroup> given = {};
};

/// Keeps so many of each: of correct hits those with the largest |ulp_error|, the first of equal ones; of each wrong
/// decision the first.
class WorstRays {
public:
    /// `ulp_error` is the place of that metric among those that are measured.
    explicit WorstRays(std::size_t most = 0, std::size_t ulp_error = 0) : most_(most), ulp_error_(ulp_error) {}

    /// Rays of the file from `first` on.
    void look_at(std::uint64_t first, const evaluate::BandResult& result);
    /// What is known of the rays that come next in the file.
    void append(WorstRays&& after);
    /// The largest errors first, then the wrong decisions in the file's order.
    [[nodiscard]] std::vector<NotedRay> all() const;

    template <class Bits>
    void fields(Bits& bits) {
        bits(most_, ulp_error_, errors_, faults_);
    }

private:
    void keep_error(NotedRay&& ray);
    void keep_fault(NotedRay&& ray);
    [[nodiscard]] bool is_kept(double error) const;
    NotedRay note(std::uint64_t first, std::size_t i, const evaluate::BandResult& result) const;

    std::size_t most_, ulp_error_;
    std::vector<NotedRay> errors_;  ///< falling
    std::array<std::vector<NotedRay>, answer::outcome_names.size()> faults_;
};

}  // namespace lostbits::measure::judge
