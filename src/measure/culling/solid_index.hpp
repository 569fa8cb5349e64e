// Which of many solids a ray can meet at all, whatever their shapes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/ray.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::culling {

/// Candidates among many solids for rays within stated bounds: supersets, never missing one that the line of the ray
/// meets at t ≥ 0.
class SolidIndex {
public:
    virtual ~SolidIndex() = default;
    /// Fills `found` with the candidates for a ray in rising order.
    virtual void candidates(const Ray<double>& ray, std::vector<std::uint32_t>& found) const = 0;
};

/// The candidates of every ray of a block, found once for all forms: pairs of a ray and a solid, ray by ray.
class CandidateLists {
public:
    CandidateLists(const SolidIndex& index, const scene::rays::RayBlock& rays);
    /// Those of some rays of `all`, in their order.
    CandidateLists(const CandidateLists& all, std::span<const std::uint32_t> rays);

    [[nodiscard]] std::size_t rays() const { return ends_.size() - 1; }
    [[nodiscard]] std::size_t pairs() const { return solids_.size(); }
    /// The place of the first pair of ray i among all; of ray `rays()` the end.
    [[nodiscard]] std::size_t first(std::size_t i) const { return ends_[i]; }
    /// The solid of a pair.
    [[nodiscard]] std::uint32_t solid(std::size_t pair) const { return solids_[pair]; }
    [[nodiscard]] std::span<const std::uint32_t> of(std::size_t i) const {
        return std::span(solids_).subspan(ends_[i], ends_[i + 1] - ends_[i]);
    }

private:
    std::vector<std::size_t> ends_{0};  ///< where the pairs of each ray begin, and the end of all
    std::vector<std::uint32_t> solids_;
};

}  // namespace lostbits::measure::culling
