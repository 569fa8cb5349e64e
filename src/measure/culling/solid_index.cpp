#include "measure/culling/solid_index.hpp"

#include <algorithm>
#include <numeric>

#include "intersect/process/parallel.hpp"

namespace lostbits::measure::culling {

CandidateLists::CandidateLists(const SolidIndex& index, const scene::rays::RayBlock& rays) {
    constexpr std::size_t together = 1024;
    const std::size_t parts = (rays.size() + together - 1) / together;
    std::vector<std::vector<std::uint32_t>> solids(parts);
    ends_.resize(rays.size() + 1);
    intersect::process::in_parallel(std::size_t{0}, parts, [&](std::size_t part) {
        std::vector<std::uint32_t> found;
        for (std::size_t i = part * together; i < std::min(rays.size(), (part + 1) * together); ++i) {
            index.candidates(rays[i], found);
            ends_[i + 1] = found.size();
            solids[part].insert(solids[part].end(), found.begin(), found.end());
        }
    });
    std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
    solids_.reserve(ends_.back());
    for (const auto& part : solids) solids_.insert(solids_.end(), part.begin(), part.end());
}

CandidateLists::CandidateLists(const CandidateLists& all, std::span<const std::uint32_t> rays) {
    for (const std::uint32_t ray : rays) {
        const auto its = all.of(ray);
        solids_.insert(solids_.end(), its.begin(), its.end());
        ends_.push_back(solids_.size());
    }
}

}  // namespace lostbits::measure::culling
