#include "measure/culling/culling.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/capped_span.hpp"
#include "geometry/flat_span.hpp"
#include "geometry/joined_span.hpp"
#include "geometry/quartic_span.hpp"
#include "geometry/wall_span.hpp"
#include "intersect/process/parallel.hpp"
#include "measure/culling/box_tree.hpp"
#include "number/wide/running_error.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::culling {

using scene::rays::PrimitiveList;

void PrimitiveIndex::append_candidates(std::span<const Ray<double>> rays, std::vector<std::uint32_t>& candidates,
                                       std::span<std::size_t> ends) const {
    std::vector<std::uint32_t> ray_candidates;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        find_candidates(rays[i], ray_candidates);
        candidates.insert(candidates.end(), ray_candidates.begin(), ray_candidates.end());
        ends[i] = candidates.size();
    }
}

CandidateLists::CandidateLists(const PrimitiveIndex& index, const scene::rays::RayBlock& rays) {
    constexpr std::size_t rays_per_part = 1024;
    const std::size_t part_count = (rays.size() + rays_per_part - 1) / rays_per_part;

    // Each part lists its own candidates, with ends from its first pair on.
    std::vector<std::vector<std::uint32_t>> primitives(part_count);
    ends_.resize(rays.size() + 1);
    intersect::process::in_parallel(std::size_t{0}, part_count, [&](std::size_t part) {
        const std::size_t begin = part * rays_per_part, end = std::min(rays.size(), begin + rays_per_part);
        std::vector<Ray<double>> part_rays;
        for (std::size_t i = begin; i < end; ++i) part_rays.push_back(rays[i]);
        index.append_candidates(part_rays, primitives[part], std::span(ends_).subspan(begin + 1, end - begin));
    });

    // Joins the lists.
    std::size_t pairs_before = 0;
    for (std::size_t part = 0; part < part_count; pairs_before += primitives[part].size(), ++part)
        for (std::size_t i = part * rays_per_part; i < std::min(rays.size(), (part + 1) * rays_per_part); ++i)
            ends_[i + 1] += pairs_before;
    primitives_.reserve(ends_.back());
    for (const auto& part : primitives) primitives_.insert(primitives_.end(), part.begin(), part.end());
}

CandidateLists::CandidateLists(const CandidateLists& all_rays, std::span<const std::uint32_t> rays) {
    for (const std::uint32_t ray : rays) {
        const auto ray_candidates = all_rays.candidates_of(ray);
        primitives_.insert(primitives_.end(), ray_candidates.begin(), ray_candidates.end());
        ends_.push_back(primitives_.size());
    }
}

namespace {

/// Upper bound of the sum B of squares, and the radius of the smallest sphere.
struct Extent {
    double sum = 0, min_radius = HUGE_VAL;
};

std::optional<Extent> measure_extent(const PrimitiveList<double>& primitives, const RayBounds& rays) {
    Extent extent;
    double reach = 0;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        const Primitive<double> primitive = primitives[i];
        // The bound holds for forms of round primitives, in the space of the rays.
        if (!row_of(primitive.shape).is_ball || primitive.transform) return std::nullopt;
        const auto ball = ball_around(primitive);
        const double distance = length(ball.centre) + ball.radius;
        if (!(ball.radius > 0) || !std::isfinite(distance)) return std::nullopt;
        reach = std::max(reach, distance);
        extent.min_radius = std::min(extent.min_radius, ball.radius);
    }
    extent.sum = bound_sum_of_squares(rays.max_origin_distance, reach);
    return extent;
}

/// Bounding box of some spheres.
struct SphereBounds {
    Vec<double> low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;

    void add(const Vec<double>& centre, double radius) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], centre[k] - radius);
            high[k] = std::max(high[k], centre[k] + radius);
        }
    }
    [[nodiscard]] Vec<double> middle() const { return low / 2.0 + high / 2.0; }
};

}  // namespace

RayBounds bounds_of(const scene::rays::RayBlock& rays) {
    RayBounds bounds{0, HUGE_VAL, 0};
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray<double> ray = rays[i];
        const double d = length(ray.direction);
        // NaN and infinity make every bound useless; these values mark that.
        if (!std::isfinite(d) || !std::isfinite(length(ray.origin))) return {HUGE_VAL, 0, HUGE_VAL};
        bounds.max_origin_distance = std::max(bounds.max_origin_distance, length(ray.origin));
        bounds.max_direction_length = std::max(bounds.max_direction_length, d);
        bounds.min_direction_length = std::min(bounds.min_direction_length, d);
    }
    return bounds;
}

RayBounds join(const RayBounds& a, const RayBounds& b) {
    return {std::max(a.max_origin_distance, b.max_origin_distance),
            std::min(a.min_direction_length, b.min_direction_length),
            std::max(a.max_direction_length, b.max_direction_length)};
}

double bound_sum_of_squares(double max_origin_distance, double reach) {
    const double largest = max_origin_distance + reach;
    return max_origin_distance * max_origin_distance + reach * reach + largest * largest;
}

bool squares_are_safe(double sum, double radius, const RayBounds& rays, const FloatFormat& format) {
    const double d2 = rays.max_direction_length * rays.max_direction_length,
                 min_d2 = rays.min_direction_length * rays.min_direction_length;
    const double largest = 64 * std::max({sum * d2, sum * d2 * d2, sum, d2}),
                 smallest = radius * radius * std::min({1.0, min_d2, min_d2 * min_d2});
    return std::log2(largest) < format.emax && std::log2(smallest) > format.emin + format.precision;
}

namespace {

/// Primitives of a scene with shared inputs. A form that marches needs them in memory one by one.
PrimitiveList<double> shared_of(const scene::file::Scene& scene) {
    return scene.march ? PrimitiveList(scene::rays::make_shared_primitives(scene))
                       : scene::rays::make_shared_primitive_list(scene);
}

bool are_many(const PrimitiveList<double>& primitives) {
    return primitives.size() >= min_primitives || primitives.mesh() != nullptr;
}

/// Index of spheres if possible: a flake of millions takes one byte for each sphere in it, and about 60 in a tree.
std::shared_ptr<const PrimitiveIndex> make_index(const PrimitiveList<double>& primitives, const RayBounds& bounds,
                                                 const FloatFormat* format) {
    if (auto spheres = SphereIndex::make(primitives, bounds, format)) return spheres;
    return BoxTree::make(primitives, bounds, format);
}

}  // namespace

Culler::Culler(const scene::file::Scene& scene) {
    // Primitives.
    const bool has_own_inputs = scene.inputs == scene::file::InputRounding::own;
    if (has_own_inputs)
        ideal_ = scene.march ? PrimitiveList<Real>(scene.primitives()) : scene::rays::make_ideal_primitive_list(scene);
    else stored_ = shared_of(scene);
    if (scene.primitive_count() < min_primitives && !scene.mesh) return;

    // Bounds of the rays.
    if (scene.camera.ray_generator) {  // rays that a format computes have no bounds
        bounds_ = {HUGE_VAL, 0, HUGE_VAL};
        return;
    }
    constexpr int line_count = 16;
    for (int y = 0; y < scene.height; y += line_count) {
        bounds_ =
            join(bounds_,
                 bounds_of(scene::rays::make_input_rays(scene, y, std::min(scene.height, y + line_count), binary64)));
    }

    // Ideal rays may have numbers that doubles cannot hold.
    if (has_own_inputs && !(std::isfinite(bounds_.max_origin_distance) && bounds_.min_direction_length > 0)) return;
    truth_ = make_index(has_own_inputs ? round_primitives(ideal_, binary64) : stored_, bounds_, nullptr);
}

Culler::Culler(const scene::file::Scene& scene, const Ray<double>& ray)
    : Culler(shared_of(scene), scene::rays::make_group(ray).rays) {}

Culler::Culler(PrimitiveList<double> primitives, const scene::rays::RayBlock& rays)
    : bounds_(join({0, 1, 1}, bounds_of(rays))), stored_(std::move(primitives)) {
    if (are_many(stored_)) truth_ = make_index(stored_, bounds_, nullptr);
}

Culler::Culler(PrimitiveList<double> primitives) : bounds_{HUGE_VAL, 0, HUGE_VAL}, stored_(std::move(primitives)) {
    if (are_many(stored_)) truth_ = BoxTree::make(stored_, bounds_, nullptr);
}

Culler::Culler(const Culler& parent, const scene::rays::RayBlock& rays)
    : bounds_(join({0, 1, 1}, bounds_of(rays))), stored_(parent.stored_), truth_(parent.truth_), parent_(&parent) {}

std::shared_ptr<const PrimitiveIndex> Culler::index_for_forms(const FloatFormat& format,
                                                              const PrimitiveList<double>& primitives) {
    return index_for(Use::forms, format, primitives);
}
std::shared_ptr<const PrimitiveIndex> Culler::index_for_stored_truth(const FloatFormat& format,
                                                                     const PrimitiveList<double>& primitives) {
    return index_for(Use::stored_truth, format, primitives);
}

std::shared_ptr<const PrimitiveIndex> Culler::index_for(Use use, const FloatFormat& format,
                                                        const PrimitiveList<double>& primitives) const {
    if (!are_many(primitives)) return nullptr;
    if (parent_) {
        if (auto shared_index = parent_->index_for(use, format, primitives)) return shared_index;
    }
    // No code under this lock waits for other threads, since they might wait for this one.
    const std::scoped_lock lock(lazy_->mutex);
    const auto [entry, is_new] = lazy_->indices.try_emplace({use, format.precision, format.emin, format.emax});
    if (is_new) {
        // Bounds of the rays as the format rounds them.
        const double u = std::ldexp(1.0, -format.precision);
        entry->second =
            make_index(primitives,
                       {bounds_.max_origin_distance * (1 + 2 * u), bounds_.min_direction_length * (1 - 2 * u),
                        bounds_.max_direction_length * (1 + 2 * u)},
                       use == Use::forms ? &format : nullptr);
    }
    return entry->second;
}

std::shared_ptr<const SphereIndex> SphereIndex::make(const PrimitiveList<double>& primitives, const RayBounds& rays,
                                                     const FloatFormat* format) {
    if (primitives.size() < min_primitives || !std::isfinite(rays.max_origin_distance) ||
        !(rays.min_direction_length > 0))
        return nullptr;
    const auto extent = measure_extent(primitives, rays);
    const auto is_safe_in = [&](const FloatFormat& tested) {
        return squares_are_safe(extent->sum, extent->min_radius, rays, tested);
    };
    if (!extent || !is_safe_in(binary64) || (format && !is_safe_in(*format))) return nullptr;

    std::shared_ptr<SphereIndex> index(new SphereIndex);
    index->primitives_ = primitives;
    index->rounding_factor_ = format ? 64 * std::ldexp(1.0, -format->precision) : 0;
    index->max_origin_distance_ = rays.max_origin_distance;
    index->margin_ = 0x1p-40 * std::sqrt(extent->sum);
    index->max_distance_behind_ = std::sqrt(index->rounding_factor_ * extent->sum) + index->margin_;
    index->make_blocks();
    index->make_pages();
    return index;
}

double SphereIndex::reach(const Vec<double>& centre, double radius) const {
    return std::sqrt(radius * radius +
                     rounding_factor_ * bound_sum_of_squares(max_origin_distance_, length(centre) + radius)) *
               (1 + 0x1p-20) +
           margin_;
}

void SphereIndex::make_blocks() {
    for (std::size_t begin = 0; begin < primitives_.size(); begin += spheres_per_block) {
        const std::size_t end = std::min(primitives_.size(), begin + spheres_per_block);
        SphereBounds bounds;
        for (std::size_t i = begin; i < end; ++i) {
            const auto [centre, radius] = ball_around(primitives_[i]);
            bounds.add(centre, radius);
        }

        const Vec<double> middle = bounds.middle();
        double ball_reach = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const auto [centre, radius] = ball_around(primitives_[i]);
            ball_reach = std::max(ball_reach, length(centre - middle) + reach(centre, radius));
        }
        blocks_.add(middle, ball_reach + margin_);
    }
}

void SphereIndex::make_pages() {
    constexpr std::size_t blocks_per_page = spheres_per_page / spheres_per_block;
    for (std::size_t begin = 0; begin < blocks_.x.size(); begin += blocks_per_page) {
        const std::size_t end = std::min(blocks_.x.size(), begin + blocks_per_page);
        SphereBounds bounds;
        for (std::size_t b = begin; b < end; ++b) bounds.add(blocks_.centre(b), blocks_.reach[b]);

        const Vec<double> middle = bounds.middle();
        double ball_reach = 0;
        for (std::size_t b = begin; b < end; ++b)
            ball_reach = std::max(ball_reach, length(blocks_.centre(b) - middle) + blocks_.reach[b]);
        pages_.add(middle, ball_reach + margin_);
    }
}

SphereIndex::UnitRay::UnitRay(const Ray<double>& ray)
    : origin(ray.origin), unit_direction(ray.direction / length(ray.direction)) {}

bool SphereIndex::meets(const UnitRay& line, const Vec<double>& centre, double reach) const {
    const Vec<double> to_centre = centre - line.origin;
    const Vec<double> moment = cross(to_centre, line.unit_direction);
    const bool is_ahead = dot(to_centre, line.unit_direction) >= -(reach + max_distance_behind_);
    return is_ahead && dot(moment, moment) <= reach * reach;
}

void SphereIndex::find_runs(const UnitRay& line, std::size_t p, Grain grain, std::vector<Run>& runs) const {
    runs.clear();
    if (!meets(line, pages_.centre(p), pages_.reach[p])) return;
    const auto add_run = [&runs](std::size_t begin, std::size_t end) {
        if (!runs.empty() && runs.back().second == begin) runs.back().second = end;
        else runs.emplace_back(begin, end);
    };
    constexpr std::size_t blocks_per_page = spheres_per_page / spheres_per_block;
    const std::size_t first = p * blocks_per_page, last = std::min(first + blocks_per_page, blocks_.x.size());
    for (std::size_t b = first; b < last; ++b) {
        if (!meets(line, blocks_.centre(b), blocks_.reach[b])) continue;
        const std::size_t begin = b * spheres_per_block, end = std::min(begin + spheres_per_block, primitives_.size());
        if (grain == Grain::blocks) add_run(begin, end);
        for (std::size_t i = begin; grain == Grain::spheres && i < end; ++i) {
            const auto [centre, radius] = ball_around(primitives_[i]);
            if (meets(line, centre, reach(centre, radius))) add_run(i, i + 1);
        }
    }
}

void SphereIndex::find_candidates(const Ray<double>& ray, std::vector<std::uint32_t>& candidates) const {
    candidates.clear();
    const UnitRay line(ray);
    thread_local std::vector<Run> runs;
    for (std::size_t p = 0; p < page_count(); ++p) {
        find_runs(line, p, Grain::spheres, runs);
        for (const auto& [begin, end] : runs) {
            for (std::size_t i = begin; i < end; ++i) candidates.push_back(static_cast<std::uint32_t>(i));
        }
    }
}

namespace {

using Certain = number::wide::RunningError<double>;
using Decision = mask_t<Certain>;

/// True if a ray begins in the closed primitive; false for shapes without an inside.
Decision begins_inside(const QuadraticSpan<Certain>& span) { return span.c <= Certain(0); }
Decision begins_inside(const QuarticSpan<Certain>& span) { return span.f.at(span.b) <= Certain(0); }
Decision begins_inside(const SlabSpan<Certain>& span) {
    Decision inside = span.closed;
    for (std::size_t i = 0; i < 3; ++i)
        inside = inside && span.entry[i].n <= Certain(0) && span.exit[i].n >= Certain(0);
    return inside;
}
template <ComparableSpan<Certain> S>
Decision begins_inside(const S& s) {
    return s.meets_closed() && s.compare_entry(ZeroParameter()).at_most && !s.compare_exit(ZeroParameter()).less;
}
template <SurfaceSpan<Certain> S>
Decision begins_inside(const S&) {
    return {false, true};
}

}  // namespace

bool may_start_inside(const Ray<double>& ray, const Primitive<double>& primitive) {
    return with_span(lift_ray<Certain>(ray), lift_primitive<Certain>(primitive),
                     [](const auto& span) { return !begins_inside(span).is_no(); });
}

}  // namespace lostbits::measure::culling
