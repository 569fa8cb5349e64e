// Rays that have candidates among many solids: each pair of a ray and a solid that it can meet.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/answer/chunk.hpp"
#include "measure/truth/format_inputs.hpp"

namespace lostbits::measure::answer {

/// Rays, each with its candidates, as columns of pairs in the order of the solids, so that a solid meets its rays at
/// once.
template <class S>
class PairColumns {
public:
    PairColumns(const scene::rays::RayBlock& rays, const truth::FormatInputs& in, std::size_t begin, std::size_t end)
        : in_(in), open_(rays.open) {
        const culling::CandidateLists& candidates = *in.candidates;
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t k = candidates.first(i); k < candidates.first(i + 1); ++k)
                pairs_.push_back({candidates.solid(k), static_cast<std::uint32_t>(k), i});
        std::ranges::sort(pairs_);
        const std::array from{&rays.ox, &rays.oy, &rays.oz, &rays.dx, &rays.dy, &rays.dz, &rays.tmax, &rays.tmin};
        for (std::size_t c = 0; c < from.size(); ++c) {
            if (from[c]->empty()) continue;
            columns_[c].reserve(pairs_.size());
            for (const Pair& pair : pairs_) columns_[c].push_back(static_cast<S>((*from[c])[pair.ray]));
        }
        for (auto* answers : {&t_, &near_, &far_}) answers->resize(pairs_.size());
        hit_.resize(pairs_.size());
    }

    /// The kernel meets each solid by itself.
    template <class Kernel>
    void ask_one_by_one(const Kernel& kernel) {
        for (std::size_t k = 0, end = 0; k < pairs_.size(); k = end) {
            for (end = k + 1; end < pairs_.size() && pairs_[end].solid == pairs_[k].solid;) ++end;
            in_.stop.check();
            kernel(batch(k, end), intersect::Target<S>(solid(k)), hits(k, end));
        }
    }
    /// The kernel is from outside, where a call may cost a message to another process: it meets all of a shape at once.
    template <class Kernel>
    void ask_at_once(const Kernel& kernel) {
        std::vector<Solid<S>> own;
        for (std::size_t k = 0, end = 0; k < pairs_.size(); k = end) {
            own.assign(1, solid(k));
            for (end = k + 1; end < pairs_.size() && in_.solids[pairs_[end].solid].shape == own.front().shape; ++end)
                own.push_back(solid(end));
            in_.stop.check();
            kernel(batch(k, end), intersect::Target<S>(std::span<const Solid<S>>(own)), hits(k, end));
        }
    }
    void put(Answers& answers) const {
        for (std::size_t k = 0; k < pairs_.size(); ++k) answers.claimed[pairs_[k].place] = hit_[k];
        for (std::size_t k = 0; k < pairs_.size(); ++k)
            if (hit_[k] != 0) keep_nearest(t_[k], pairs_[k].ray, static_cast<std::int32_t>(pairs_[k].solid), answers);
    }

private:
    struct Pair {
        std::uint32_t solid, place;
        std::size_t ray;
        friend auto operator<=>(const Pair&, const Pair&) = default;
    };
    [[nodiscard]] Solid<S> solid(std::size_t k) const {
        return transformed(in_.solids[pairs_[k].solid], [](double x) { return static_cast<S>(x); });
    }
    [[nodiscard]] intersect::table::RayBatch<S> batch(std::size_t k, std::size_t end) const {
        return batch_of<S>(columns_, k, end, open_);
    }
    [[nodiscard]] intersect::table::HitBatch<S> hits(std::size_t k, std::size_t end) {
        const auto part = [&](auto& all) { return std::span(all).subspan(k, end - k); };
        return {part(t_), part(near_), part(far_), part(hit_)};
    }

    const truth::FormatInputs& in_;
    OpenEnds open_;
    std::vector<Pair> pairs_;
    std::array<std::vector<S>, 8> columns_;
    std::vector<S> t_, near_, far_;
    std::vector<std::uint8_t> hit_;
};

}  // namespace lostbits::measure::answer
