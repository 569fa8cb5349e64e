// The rays of one row that are worth a second look: the largest errors, and the first wrong decisions of each kind.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "measure/map/map.hpp"

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
    WorstRays(std::size_t most, std::size_t ulp_error) : most_(most), ulp_error_(ulp_error) {}

    /// Rays of the file from `first` on.
    void look_at(std::uint64_t first, const map::BandResult& result);
    /// The largest errors first, then the wrong decisions in the file's order.
    [[nodiscard]] std::vector<NotedRay> all() const;

private:
    NotedRay note(std::uint64_t first, std::size_t i, const map::BandResult& result) const;

    std::size_t most_, ulp_error_;
    std::vector<NotedRay> errors_;  ///< falling
    std::map<answer::Outcome, std::vector<NotedRay>> faults_;
};

}  // namespace lostbits::measure::judge
