#include "measure/truth/band.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <type_traits>

#include "intersect/sdf/march_loop.hpp"
#include "intersect/simd/packed.hpp"
#include "intersect/simd/packed_many.hpp"
#include "intersect/table/union_field.hpp"
#include "measure/truth/conditioning.hpp"
#include "measure/truth/unit_direction.hpp"
#include "number/interruption.hpp"
#include "scene/file/march_table.hpp"

namespace lostbits::measure::truth {

using intersect::Target;
using intersect::Touching;
using intersect::simd::SphereArrays;
using intersect::table::HitBatch;
using scene::rays::RayBlock;

namespace {

template <class Function>
void for_each_pixel(std::size_t count, Function&& function) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 256), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            stop_if_interrupted();
            function(i);
        }
    });
}

template <class S>
using Solids = std::span<const Solid<S>>;

RayBlock normalised(const RayBlock& rays, const FloatFormat& format) {
    RayBlock unit = rays;
    for_each_pixel(rays.size(), [&](std::size_t i) {
        const Vec<double> u = unit_direction(Vec<double>(rays.dx[i], rays.dy[i], rays.dz[i]), format);
        unit.dx[i] = u.x;
        unit.dy[i] = u.y;
        unit.dz[i] = u.z;
    });
    return unit;
}

template <class S>
std::vector<S> stored(const std::vector<double>& x, std::size_t begin, std::size_t count) {
    std::vector<S> y(count);
    for (std::size_t i = 0; i < count; ++i) y[i] = static_cast<S>(x[begin + i]);
    return y;
}

/// Rays begin to begin + count as the kernels take them, and room for their answers.
template <class S>
struct Chunk {
    Chunk(const RayBlock& rays, std::size_t first, std::size_t size)
        : begin(first),
          count(size),
          ox(stored<S>(rays.ox, begin, count)),
          oy(stored<S>(rays.oy, begin, count)),
          oz(stored<S>(rays.oz, begin, count)),
          dx(stored<S>(rays.dx, begin, count)),
          dy(stored<S>(rays.dy, begin, count)),
          dz(stored<S>(rays.dz, begin, count)),
          tmax(rays.tmax.empty() ? std::vector<S>() : stored<S>(rays.tmax, begin, count)),
          t(count),
          near(count),
          far(count),
          hit(count) {}

    [[nodiscard]] intersect::table::RayBatch<S> batch() const { return {ox, oy, oz, dx, dy, dz, tmax}; }
    [[nodiscard]] HitBatch<S> hits() { return {t, near, far, hit}; }

    std::size_t begin, count;
    std::vector<S> ox, oy, oz, dx, dy, dz, tmax, t, near, far;
    std::vector<std::uint8_t> hit;
};

/// Takes a hit of ray p where it comes before what the ray has met so far.
template <class S>
void keep_nearest(S t, std::size_t p, std::int32_t object, Answers& answers) {
    const bool first = answers.hit[p] == 0 || std::isnan(answers.t[p]);
    if (!(first || t < answers.t[p]) || (std::isnan(t) && answers.hit[p] != 0)) return;
    answers.hit[p] = 1;
    // The sign and payload of a NaN are the compiler's choice; no file may depend on it.
    answers.t[p] = std::isnan(t) ? std::numeric_limits<double>::quiet_NaN() : t;
    answers.object[p] = object;
}

/// One chunk of rays against all solids, keeping the nearest.
template <class S, class Kernel>
void nearest_of(const Kernel& kernel, const RayBlock& rays, const FormatInputs& in, std::size_t begin,
                std::size_t count, Answers& answers) {
    Chunk<S> chunk(rays, begin, count);
    for (std::size_t s = 0; s < in.solids.size(); ++s) {
        stop_if_interrupted();
        const Solid<S> solid = transformed(in.solids[s], [](double x) { return static_cast<S>(x); });
        kernel(chunk.batch(), Target<S>(solid), chunk.hits());
        for (std::size_t i = 0; i < count; ++i) {
            if (chunk.hit[i] != 0) keep_nearest(chunk.t[i], begin + i, static_cast<std::int32_t>(s), answers);
        }
    }
}

/// One ray against many spheres in the format's own arithmetic: into `t` and `hit`, one for each sphere.
template <class S>
using OneToMany = std::function<void(const Ray<S>&, const SphereArrays<S>&, std::span<S>, std::span<std::uint8_t>)>;

/// Calls `take(c)` for every c with hit[c] != 0, in order. Hits are rare: eight bytes are looked at together.
template <class Take>
void for_each_hit(std::span<const std::uint8_t> hit, const Take& take) {
    std::size_t c = 0;
    for (; c + 8 <= hit.size(); c += 8) {
        std::uint64_t eight;
        std::memcpy(&eight, hit.data() + c, 8);
        if (eight == 0) continue;
        for (std::size_t k = c; k < c + 8; ++k) {
            if (hit[k] != 0) take(k);
        }
    }
    for (; c < hit.size(); ++c) {
        if (hit[c] != 0) take(c);
    }
}

/// Rays one by one, each against the spheres that it can meet, in their order: what `nearest_of` finds, without the
/// rest.
template <class S>
void nearest_among(const OneToMany<S>& kernel, const RayBlock& rays, const FormatInputs& in, Answers& answers) {
    const SphereIndex& index = *in.index;
    const SphereArrays<S> all{index.column<S>(0), index.column<S>(1), index.column<S>(2), index.column<S>(3)};
    std::vector<std::uint32_t> found;
    std::vector<S> column[4], t(all.size());
    std::vector<std::uint8_t> hit(all.size());
    for (std::size_t p = 0; p < rays.size(); ++p) {
        stop_if_interrupted();
        const Ray<double> r = rays[p];
        const auto cast = [](const Vec<double>& v) {
            return Vec<S>(static_cast<S>(v.x), static_cast<S>(v.y), static_cast<S>(v.z));
        };
        const Ray<S> ray{cast(r.origin), cast(r.direction)};
        const bool few = index.candidates(r, found);
        const std::size_t count = few ? found.size() : all.size();
        if (few) {
            for (int k = 0; k < 4; ++k) {
                const auto from = index.column<S>(k);
                column[k].resize(count);
                for (std::size_t c = 0; c < count; ++c) column[k][c] = from[found[c]];
            }
        }
        const SphereArrays<S> asked = few ? SphereArrays<S>{column[0], column[1], column[2], column[3]} : all;
        kernel(ray, asked, std::span(t).first(count), std::span(hit).first(count));
        for_each_hit(std::span(hit).first(count), [&](std::size_t c) {
            keep_nearest(t[c], p, static_cast<std::int32_t>(few ? found[c] : c), answers);
        });
    }
}

/// A kernel of many rays and one sphere, asked sphere by sphere.
template <class S, class Kernel>
OneToMany<S> one_by_one(const Kernel& kernel) {
    return [kernel](const Ray<S>& ray, const SphereArrays<S>& spheres, std::span<S> t, std::span<std::uint8_t> hit) {
        const auto one = [](const S& x) { return std::span(&x, 1); };
        const Vec<S>&o = ray.origin, &d = ray.direction;
        S near{}, far{};
        for (std::size_t i = 0; i < spheres.size(); ++i) {
            const Solid<S> solid(Sphere<S>{{spheres.x[i], spheres.y[i], spheres.z[i]}, spheres.radius[i]});
            kernel(intersect::table::RayBatch<S>{one(o.x), one(o.y), one(o.z), one(d.x), one(d.y), one(d.z)},
                   Target<S>(solid),
                   HitBatch<S>{t.subspan(i, 1), std::span(&near, 1), std::span(&far, 1), hit.subspan(i, 1)});
        }
    };
}

/// The same over all spheres that a ray can meet; a row that is not the table's has no kernel for many spheres.
void meet_many(const intersect::table::Intersector& form, const RayBlock& rays, const FormatInputs& in,
               Answers& answers) {
    const intersect::simd::ManyRow many = intersect::simd::many_kernels(form);
    switch (in.format.engine) {
        case Format::Engine::native32:
            return nearest_among<float>(
                many.spheres32 ? OneToMany<float>(many.spheres32) : one_by_one<float>(form.native32), rays, in,
                answers);
        case Format::Engine::native64:
            return nearest_among<double>(
                many.spheres64 ? OneToMany<double>(many.spheres64) : one_by_one<double>(form.native64), rays, in,
                answers);
        case Format::Engine::rounded: break;
    }
    nearest_among<double>(one_by_one<double>([&](const auto&... a) { form.rounded(in.format.shape, a...); }), rays, in,
                          answers);
}

/// The solid whose surface is nearest to the point at t, by double precision: of the solids of a field none says "I was
/// it".
std::int32_t nearest_solid(const Ray<double>& ray, double t, const std::vector<Solid<double>>& solids) {
    const Vec<double> p = intersect::sdf::along(ray, t);
    const auto size = [&p](const Solid<double>& s) { return std::fabs(intersect::table::distance(s, p)); };
    return static_cast<std::int32_t>(std::ranges::min_element(solids, {}, size) - solids.begin());
}

/// One chunk of rays against the field of all solids.
template <class S, class Kernel>
void march_to(const Kernel& kernel, const RayBlock& rays, const FormatInputs& in, std::size_t begin, std::size_t count,
              Answers& answers) {
    stop_if_interrupted();
    Chunk<S> chunk(rays, begin, count);
    HitBatch<S> hits = chunk.hits();
    hits.march = std::span(answers.march).subspan(begin, count);
    const intersect::LiftedTarget<S> target(Target<double>(in.solids, in.march.value()),
                                            [](double x) { return static_cast<S>(x); });
    kernel(chunk.batch(), target.get(), hits);
    for (std::size_t i = 0; i < count; ++i) {
        if (chunk.hit[i] != 0)
            keep_nearest(chunk.t[i], begin + i,
                         nearest_solid(rays[begin + i], static_cast<double>(chunk.t[i]), in.solids), answers);
    }
}

}  // namespace

template <class Function>
auto Band::with_ray(std::size_t i, Function&& function) const {
    return ideal_ ? function((*ideal_)[i], Solids<Real>(ideal_solids_))
                  : function(shared_[i], Solids<double>(shared_solids_));
}

Band::Band(const scene::file::Scene& scene, int y0, int y1, TruthLimit limit, Culler* culler)
    : culler_(culler), scene_(&scene), y0_(y0), rows_(y1 - y0), limit_(limit) {
    if (scene.inputs == scene::file::Inputs::shared) {
        shared_ = scene::rays::make_shared_rays(scene, y0, y1);
        shared_solids_ = culler ? culler->shared_solids() : scene::rays::shared_solids(scene);
    } else {
        ideal_ = scene::rays::make_own_rays(scene, y0, y1);
        ideal_solids_ = scene.solids();
    }
    if (scene.march) shared_march_ = scene::file::round_march(*scene.march, binary32);
    find_truth_of_all();
}

Band::Band(scene::rays::RayGroup group, TruthLimit limit)
    : y0_(group.rays.y0),
      rows_(group.rays.y1 - group.rays.y0),
      limit_(limit),
      shared_(std::move(group.rays)),
      shared_solids_(std::move(group.solids)),
      shared_march_(group.march) {
    find_truth_of_all();
}

namespace {

Ray<double> in_double(const Ray<double>& ray) { return ray; }
Ray<double> in_double(const Ray<Real>& ray) {
    const auto of = [](const Vec<Real>& v) {
        return Vec<double>(static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
    };
    return {of(ray.origin), of(ray.direction)};
}

}  // namespace

Truth Band::find_truth_of(std::size_t i, Touching touching) const {
    const double tmax = !ideal_ && !shared_.tmax.empty() ? shared_.tmax[i] : HUGE_VAL;
    const SphereIndex* const index = culler_ ? culler_->for_truth() : nullptr;
    return with_ray(i, [&](const auto& ray, auto solids) {
        thread_local std::vector<std::uint32_t> found;
        if (index && index->candidates(in_double(ray), found))
            return find_truth_among(ray, solids, found, limit_, touching);
        return find_truth(ray, solids, limit_, touching, tmax);
    });
}

void Band::find_truth_of_all() {
    truth_.resize(ideal_ ? ideal_->size() : shared_.size());
    if (culler_) culler_->for_truth();  // made here, by one thread
    for_each_pixel(truth_.size(), [&](std::size_t i) { truth_[i] = find_truth_of(i, Touching::hit); });
    for (std::size_t i = 0; i < truth_.size(); ++i) {
        if (truth_[i].touches) open_[i].truth = find_truth_of(i, Touching::miss);
    }
}

const Truth& Band::truth(std::size_t i, Touching touching) const {
    if (touching == Touching::hit || !truth_[i].touches) return truth_[i];
    return open_.at(i).truth;
}

void Band::find_condition() {
    const auto of = [&](std::size_t i, const Truth& truth) {
        if (!truth.is_hit()) return std::numeric_limits<double>::quiet_NaN();
        return with_ray(i, [&](const auto& ray, auto solids) {
            return lostbits::measure::truth::condition(ray, solids[static_cast<std::size_t>(truth.object)]);
        });
    };
    condition_.resize(pixels());
    for_each_pixel(pixels(), [&](std::size_t i) { condition_[i] = of(i, truth_[i]); });
    for (auto& [i, open] : open_) open.condition = of(i, open.truth);
}

double Band::condition(std::size_t i, Touching touching) const {
    if (touching == Touching::hit || !truth_[i].touches) return condition_[i];
    return open_.at(i).condition;
}

FormatInputs Band::inputs(const Format& format, BandNeeds needs) const {
    FormatInputs in{.format = format, .rays = {}, .solids = {}, .march = {}, .unit_rays = {}, .own_truth = {}};
    const FloatFormat& shape = format.shape;
    if (ideal_) {
        in.rays = scene::rays::round_rays(*ideal_, shape);
        for (const auto& s : ideal_solids_) in.solids.push_back(scene::rays::round_solid(s, shape));
    } else {
        in.ideal = shape.precision >= binary32.precision && shape.emin <= binary32.emin && shape.emax >= binary32.emax;
        in.rays = in.ideal ? shared_ : scene::rays::round_block(shared_, shape);
        for (const auto& s : shared_solids_) in.solids.push_back(scene::rays::round_solid(s, shape));
    }
    if (ideal_ && scene_->march) in.march = scene::file::round_march(*scene_->march, shape);
    else if (shared_march_) in.march = scene::file::round_march(*shared_march_, shape);
    if (needs.unit_rays) in.unit_rays = normalised(in.rays, shape);
    if (culler_) in.index = culler_->for_format(shape, in.solids);
    if (needs.own_truth && !in.ideal) {
        in.own_truth.resize(pixels());
        for_each_pixel(pixels(), [&](std::size_t i) {
            const Ray<double> ray = in.rays[i];
            thread_local std::vector<std::uint32_t> found;
            if (in.index && in.index->candidates(ray, found))
                in.own_truth[i] = find_truth_among(ray, Solids<double>(in.solids), found, limit_, Touching::hit);
            else
                in.own_truth[i] = find_truth(ray, Solids<double>(in.solids), limit_, Touching::hit,
                                             in.rays.tmax.empty() ? HUGE_VAL : in.rays.tmax[i]);
        });
    }
    return in;
}

double Band::rounded_truth(std::size_t i, const FloatFormat& format, intersect::Direction unit_of,
                           Touching touching) const {
    const Truth& truth = this->truth(i, touching);
    const Length length = unit_of == intersect::Direction::unit ? Length::distance : Length::parameter;
    return with_ray(i, [&](const auto& ray, auto solids) {
        return round_truth(truth, ray, solids[static_cast<std::size_t>(truth.object)], format, length);
    });
}

Answers evaluate(const intersect::table::Intersector& form, const FormatInputs& inputs) {
    const RayBlock& rays = inputs.rays_for(*form.info);
    const std::size_t n = rays.size();
    const bool marches = form.shape == Shape::sdf;
    Answers answers{std::vector<double>(n), std::vector<std::uint8_t>(n), std::vector<std::int32_t>(n, -1)};
    // Packs keep no records of the marches in their lanes.
    const intersect::simd::PackedRow native = marches
                                                  ? intersect::simd::PackedRow{form.info, form.native32, form.native64}
                                                  : intersect::simd::packed_kernels(form);
    if (marches) answers.march.resize(n);
    if (inputs.index && form.shape == Shape::sphere) {
        meet_many(form, rays, inputs, answers);
        return answers;
    }
    constexpr std::size_t chunk = 4096;  // ray and answer arrays of a chunk stay in the second-level cache
    for (std::size_t begin = 0; begin < n; begin += chunk) {
        const std::size_t count = std::min(chunk, n - begin);
        const auto run = [&]<class S>(const auto& kernel) {
            if (marches) march_to<S>(kernel, rays, inputs, begin, count, answers);
            else nearest_of<S>(kernel, rays, inputs, begin, count, answers);
        };
        switch (inputs.format.engine) {
            case Format::Engine::native32: run.template operator()<float>(native.f32); break;
            case Format::Engine::native64: run.template operator()<double>(native.f64); break;
            case Format::Engine::rounded:
                run.template operator()<double>([&](const auto&... a) { form.rounded(inputs.format.shape, a...); });
                break;
        }
    }
    return answers;
}

}  // namespace lostbits::measure::truth
