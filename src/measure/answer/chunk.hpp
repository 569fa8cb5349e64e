// Rays in pieces of the size that a kernel takes, with buffers for the answers of the kernel.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/answer/answers.hpp"
#include "measure/columns/columns.hpp"
#include "measure/culling/sort_by_index.hpp"
#include "measure/truth/format_inputs.hpp"
#include "measure/truth/missing.hpp"
#include "scene/rays/rays.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::answer {

/// Returns rays `i` to `end` − 1 of the rays in eight columns: origin, direction, tmax and tmin. The last two columns
/// may be empty.
template <class S, class Columns>
intersect::table::RayBatch<S> batch_of(const Columns& columns, std::size_t i, std::size_t end, OpenEnds open_ends) {
    const auto part = [&](std::size_t k) {
        const std::span<const S> column(columns[k]);
        return column.empty() ? column : column.subspan(i, end - i);
    };
    return {part(0), part(1), part(2), part(3), part(4), part(5), part(6), part(7), open_ends};
}

/// Buffers for the answers of a kernel.
template <class S>
struct AnswerBuffers {
    std::vector<S> t, near, far;
    std::vector<std::uint8_t> hit;

    explicit AnswerBuffers(std::size_t ray_count) : t(ray_count), near(ray_count), far(ray_count), hit(ray_count) {}
    [[nodiscard]] intersect::table::HitBatch<S> hits(std::size_t i, std::size_t end) {
        const auto part = [&](auto& column) { return std::span(column).subspan(i, end - i); };
        return {part(t), part(near), part(far), part(hit)};
    }
    [[nodiscard]] intersect::table::HitBatch<S> hits() { return {t, near, far, hit}; }
};

/// Numbers of some rays in the layout that a kernel takes, without their ranges, and buffers for its answers.
template <class S>
struct KernelBuffers : AnswerBuffers<S> {
    static constexpr std::size_t tmax_column = 6;
    std::array<std::vector<S>, 8> columns;

    KernelBuffers(const scene::rays::RayBlock& rays, std::size_t begin, std::size_t count) : AnswerBuffers<S>(count) {
        for (std::size_t k = 0; k < rays.numbers().size(); ++k) {
            columns[k].resize(count);
            std::ranges::transform(std::span(*rays.numbers()[k]).subspan(begin, count), columns[k].begin(),
                                   [](double x) { return static_cast<S>(x); });
        }
    }
    explicit KernelBuffers(const scene::rays::RayBlock& rays) : KernelBuffers(rays, 0, rays.size()) {}
    [[nodiscard]] intersect::table::RayBatch<S> rays(std::size_t i, std::size_t end) const {
        return batch_of<S>(columns, i, end, {});
    }
    [[nodiscard]] intersect::table::RayBatch<S> rays() const { return rays(0, this->hit.size()); }
};

/// Pieces of a block of rays in the layout that a kernel takes, with buffers for its answers. Their columns stay in the
/// second-level cache.
template <class S>
class RayChunk {
public:
    static constexpr std::size_t capacity = 2048;

    explicit RayChunk(const scene::rays::RayBlock& rays)
        : rays_(rays),
          buffers_(std::min(capacity, rays.size())),
          columns_(buffers_for_columns()),
          nearest_t_(buffers_.hit.size()),
          nearest_primitives_(buffers_.hit.size()) {}

    /// Takes the rays from `begin` up to, but not including, `begin + capacity`, or to the last ray.
    void move_to(std::size_t begin) {
        begin_ = begin;
        count_ = std::min(capacity, rays_.size() - begin);
        const std::array sources{&rays_.ox, &rays_.oy, &rays_.oz,   &rays_.dx,
                                 &rays_.dy, &rays_.dz, &rays_.tmax, &rays_.tmin};
        for (std::size_t k = 0; k < sources.size(); ++k) {
            if (sources[k]->empty()) continue;
            const std::span<const double> numbers = std::span(*sources[k]).subspan(begin_, count_);
            if constexpr (std::same_as<S, double>) {
                batch_[k] = numbers;
            } else {
                std::ranges::transform(numbers, columns_[k].begin(), [](double x) { return static_cast<S>(x); });
                batch_[k] = std::span(columns_[k]).first(count_);
            }
        }
        std::ranges::fill(nearest_t_, std::numeric_limits<S>::quiet_NaN());
        std::ranges::fill(nearest_primitives_, -1);
    }

    [[nodiscard]] std::size_t begin() const { return begin_; }
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] intersect::table::RayBatch<S> batch() const { return batch(0, count_); }
    [[nodiscard]] intersect::table::HitBatch<S> hits() { return hits(0, count_); }
    [[nodiscard]] intersect::table::RayBatch<S> batch(std::size_t i, std::size_t end) const {
        return batch_of<S>(batch_, i, end, rays_.open_ends);
    }
    [[nodiscard]] intersect::table::HitBatch<S> hits(std::size_t i, std::size_t end) { return buffers_.hits(i, end); }

    /// Keeps the hits with this primitive that are nearer than the hits so far.
    void keep_nearest(std::size_t primitive) {
        columns::keep_nearest(columns::RawHits<S>{.size = count_,
                                                  .t = buffers_.t.data(),
                                                  .hit = buffers_.hit.data(),
                                                  .nearest = nearest_t_.data(),
                                                  .nearest_primitives = nearest_primitives_.data(),
                                                  .primitive = static_cast<std::int32_t>(primitive)});
    }
    /// Writes the nearest hit of every ray.
    void write_to(Answers& answers) const {
        const std::int32_t* const primitives = nearest_primitives_.data();
        const S* const nearest_t = nearest_t_.data();
        double* const t_out = answers.t.data() + begin_;
        std::uint8_t* const hit_out = answers.hit.data() + begin_;
        const std::size_t count = count_;
        for (std::size_t i = 0; i < count; ++i) hit_out[i] = primitives[i] >= 0;
        for (std::size_t i = 0; i < count; ++i) {
            const auto t = static_cast<double>(nearest_t[i]);
            // The sign and payload of a NaN are the compiler's choice; no file may depend on it.
            t_out[i] = primitives[i] < 0 ? 0 : t == t ? t : truth::missing;
        }
        std::copy_n(primitives, count, answers.primitive.data() + begin_);
    }

private:
    [[nodiscard]] std::array<std::vector<S>, 8> buffers_for_columns() const {
        std::array<std::vector<S>, 8> columns;
        if constexpr (!std::same_as<S, double>) {
            for (std::vector<S>& column : columns) column.resize(buffers_.hit.size());
        }
        return columns;
    }

    const scene::rays::RayBlock& rays_;
    std::size_t begin_ = 0, count_ = 0;
    AnswerBuffers<S> buffers_;
    std::array<std::vector<S>, 8> columns_;  ///< used if the kernels take another type than double
    std::array<std::span<const S>, 8> batch_;
    std::vector<S> nearest_t_;
    std::vector<std::int32_t> nearest_primitives_;
};

/// Keeps a hit of a ray if it comes before the nearest hit so far.
template <class S>
inline void keep_nearest(S t, std::size_t ray, std::int32_t primitive, Answers& answers) {
    const bool is_first = answers.hit[ray] == 0 || std::isnan(answers.t[ray]);
    if (!(is_first || t < answers.t[ray]) || (std::isnan(t) && answers.hit[ray] != 0)) return;
    answers.hit[ray] = 1;
    // The sign and payload of a NaN are the compiler's choice; no file may depend on it.
    answers.t[ray] = std::isnan(t) ? truth::missing : t;
    answers.primitive[ray] = primitive;
}

/// Pairs of rays and their candidates, as columns in the order of the primitives, so that all rays of a primitive are
/// tested at once.
template <class S>
class PairColumns {
public:
    PairColumns(const scene::rays::RayBlock& rays, const truth::FormatInputs& in, std::size_t begin, std::size_t end)
        : in_(in), open_ends_(rays.open_ends) {
        const culling::CandidateLists& candidates = *in.candidates;
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t k = candidates.first_pair(i); k < candidates.first_pair(i + 1); ++k)
                pairs_.push_back({candidates.primitive(k), static_cast<std::uint32_t>(k), i});
        culling::sort_by_index(pairs_, [](const RayPrimitivePair& pair) { return pair.primitive; });
        const std::array sources{&rays.ox, &rays.oy, &rays.oz, &rays.dx, &rays.dy, &rays.dz, &rays.tmax, &rays.tmin};
        for (std::size_t c = 0; c < sources.size(); ++c) {
            if (sources[c]->empty()) continue;
            columns_[c].resize(pairs_.size());
            std::ranges::transform(pairs_, columns_[c].begin(), [&](const RayPrimitivePair& pair) {
                return static_cast<S>((*sources[c])[pair.ray]);
            });
        }
        buffers_.emplace(pairs_.size());
    }

    /// Calls the kernel once for each primitive.
    template <class Kernel>
    void evaluate_one_by_one(const Kernel& kernel) {
        for (std::size_t k = 0, end = 0; k < pairs_.size(); k = end) {
            for (end = k + 1; end < pairs_.size() && pairs_[end].primitive == pairs_[k].primitive;) ++end;
            in_.stop.check();
            kernel(batch(k, end), intersect::Target<S>(primitive(k)), buffers_->hits(k, end));
        }
    }
    /// Calls the kernel once for all primitives of a shape. For external kernels, where a call may cost a message to
    /// another process.
    template <class Kernel>
    void evaluate_at_once(const Kernel& kernel) {
        std::vector<Primitive<S>> shape_primitives;
        for (std::size_t k = 0, end = 0; k < pairs_.size(); k = end) {
            shape_primitives.assign(1, primitive(k));
            for (end = k + 1;
                 end < pairs_.size() && in_.primitives[pairs_[end].primitive].shape == shape_primitives.front().shape;
                 ++end)
                shape_primitives.push_back(primitive(end));
            in_.stop.check();
            kernel(batch(k, end), intersect::Target<S>(std::span<const Primitive<S>>(shape_primitives)),
                   buffers_->hits(k, end));
        }
    }
    void write_to(Answers& answers) const {
        for (std::size_t k = 0; k < pairs_.size(); ++k) answers.claimed[pairs_[k].pair] = buffers_->hit[k];
        for (std::size_t k = 0; k < pairs_.size(); ++k)
            if (buffers_->hit[k] != 0)
                keep_nearest(buffers_->t[k], pairs_[k].ray, static_cast<std::int32_t>(pairs_[k].primitive), answers);
    }

private:
    struct RayPrimitivePair {
        std::uint32_t primitive, pair;
        std::size_t ray;
    };
    [[nodiscard]] Primitive<S> primitive(std::size_t k) const {
        return lift_primitive<S>(in_.primitives[pairs_[k].primitive]);
    }
    [[nodiscard]] intersect::table::RayBatch<S> batch(std::size_t k, std::size_t end) const {
        return batch_of<S>(columns_, k, end, open_ends_);
    }

    const truth::FormatInputs& in_;
    OpenEnds open_ends_;
    std::vector<RayPrimitivePair> pairs_;
    std::array<std::vector<S>, 8> columns_;
    std::optional<AnswerBuffers<S>> buffers_;
};

}  // namespace lostbits::measure::answer
