#include "measure/band.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "intersect/packed.hpp"
#include "intersect/sdf/field.hpp"
#include "intersect/sdf/march_loop.hpp"
#include "measure/conditioning.hpp"
#include "measure/unit_direction.hpp"
#include "scene/march_table.hpp"

namespace lostbits {
namespace {

template <class Function>
void for_each_pixel(std::size_t count, Function&& function) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 256), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) function(i);
    });
}

template <class S>
using Solids = std::span<const Solid<S>>;

scene::RayBlock normalised(const scene::RayBlock& rays, const FloatFormat& format) {
    scene::RayBlock unit = rays;
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
    Chunk(const scene::RayBlock& rays, std::size_t first, std::size_t size)
        : begin(first), count(size), ox(stored<S>(rays.ox, begin, count)), oy(stored<S>(rays.oy, begin, count)), oz(stored<S>(rays.oz, begin, count)),
          dx(stored<S>(rays.dx, begin, count)), dy(stored<S>(rays.dy, begin, count)), dz(stored<S>(rays.dz, begin, count)),
          tmax(rays.tmax.empty() ? std::vector<S>() : stored<S>(rays.tmax, begin, count)), t(count), near(count), far(count), hit(count) {}

    [[nodiscard]] RayBatch<S> batch() const { return {ox, oy, oz, dx, dy, dz, tmax}; }
    [[nodiscard]] HitBatch<S> hits() { return {t, near, far, hit}; }

    std::size_t begin, count;
    std::vector<S> ox, oy, oz, dx, dy, dz, tmax, t, near, far;
    std::vector<std::uint8_t> hit;
};

/// Takes the answer to ray i of the chunk where it comes before what the ray has met so far.
template <class S>
void keep_nearest(const Chunk<S>& chunk, std::size_t i, std::int32_t object, Answers& answers) {
    const std::size_t p = chunk.begin + i;
    const S t = chunk.t[i];
    const bool first = answers.hit[p] == 0 || std::isnan(answers.t[p]);
    if (chunk.hit[i] == 0 || !(first || t < answers.t[p]) || (std::isnan(t) && answers.hit[p] != 0)) return;
    answers.hit[p] = 1;
    // The sign and payload of a NaN are the compiler's choice; no file may depend on it.
    answers.t[p] = std::isnan(t) ? std::numeric_limits<double>::quiet_NaN() : t;
    answers.object[p] = object;
}

/// One chunk of rays against all solids, keeping the nearest.
template <class S, class Kernel>
void nearest_of(const Kernel& kernel, const scene::RayBlock& rays, const FormatInputs& in, std::size_t begin, std::size_t count, Answers& answers) {
    Chunk<S> chunk(rays, begin, count);
    for (std::size_t s = 0; s < in.solids.size(); ++s) {
        const Solid<S> solid = transformed(in.solids[s], [](double x) { return static_cast<S>(x); });
        kernel(chunk.batch(), Target<S>(solid), chunk.hits());
        for (std::size_t i = 0; i < count; ++i) keep_nearest(chunk, i, static_cast<std::int32_t>(s), answers);
    }
}

/// The solid whose surface is nearest to the point at t, by double precision: of the solids of a field none says "I was it".
std::int32_t nearest_solid(const Ray<double>& ray, double t, const std::vector<Solid<double>>& solids) {
    const Vec<double> p = sdf::along(ray, t);
    const auto size = [&p](const Solid<double>& s) { return std::fabs(sdf::distance(s, p)); };
    return static_cast<std::int32_t>(std::ranges::min_element(solids, {}, size) - solids.begin());
}

/// One chunk of rays against the field of all solids.
template <class S, class Kernel>
void march_to(const Kernel& kernel, const scene::RayBlock& rays, const FormatInputs& in, std::size_t begin, std::size_t count, Answers& answers) {
    Chunk<S> chunk(rays, begin, count);
    HitBatch<S> hits = chunk.hits();
    hits.march = std::span(answers.march).subspan(begin, count);
    const LiftedTarget<S> target(Target<double>(in.solids, in.march.value()), [](double x) { return static_cast<S>(x); });
    kernel(chunk.batch(), target.get(), hits);
    for (std::size_t i = 0; i < count; ++i) {
        if (chunk.hit[i] != 0) keep_nearest(chunk, i, nearest_solid(rays[begin + i], static_cast<double>(chunk.t[i]), in.solids), answers);
    }
}

}  // namespace

template <class Function>
auto Band::with_ray(std::size_t i, Function&& function) const {
    return ideal_ ? function((*ideal_)[i], Solids<Real>(ideal_solids_)) : function(shared_[i], Solids<double>(shared_solids_));
}

Band::Band(const scene::Scene& scene, int y0, int y1, TruthLimit limit) : scene_(&scene), y0_(y0), rows_(y1 - y0), limit_(limit) {
    if (scene.inputs == scene::Inputs::shared) {
        shared_ = scene::make_shared_rays(scene, y0, y1);
        for (const auto& s : scene.solids()) shared_solids_.push_back(scene::round_solid(s, binary32));
    } else {
        ideal_ = scene::make_own_rays(scene, y0, y1);
        ideal_solids_ = scene.solids();
    }
    if (scene.march) shared_march_ = scene::round_march(*scene.march, binary32);
    find_truth_of_all();
}

Band::Band(scene::RayGroup group, TruthLimit limit)
    : y0_(group.rays.y0), rows_(group.rays.y1 - group.rays.y0), limit_(limit), shared_(std::move(group.rays)), shared_solids_(std::move(group.solids)),
      shared_march_(group.march) {
    find_truth_of_all();
}

void Band::find_truth_of_all() {
    truth_.resize(ideal_ ? ideal_->size() : shared_.size());
    const auto find = [&](std::size_t i, Touching touching) {
        const double tmax = !ideal_ && !shared_.tmax.empty() ? shared_.tmax[i] : HUGE_VAL;
        return with_ray(i, [&](const auto& ray, auto solids) { return find_truth(ray, solids, limit_, touching, tmax); });
    };
    for_each_pixel(truth_.size(), [&](std::size_t i) { truth_[i] = find(i, Touching::hit); });
    for (std::size_t i = 0; i < truth_.size(); ++i) {
        if (truth_[i].touches) open_[i].truth = find(i, Touching::miss);
    }
}

const Truth& Band::truth(std::size_t i, Touching touching) const {
    if (touching == Touching::hit || !truth_[i].touches) return truth_[i];
    return open_.at(i).truth;
}

void Band::find_condition() {
    const auto of = [&](std::size_t i, const Truth& truth) {
        if (!truth.is_hit()) return std::numeric_limits<double>::quiet_NaN();
        return with_ray(i, [&](const auto& ray, auto solids) { return lostbits::condition(ray, solids[static_cast<std::size_t>(truth.object)]); });
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
        in.rays = scene::round_rays(*ideal_, shape);
        for (const auto& s : ideal_solids_) in.solids.push_back(scene::round_solid(s, shape));
    } else {
        in.ideal = shape.precision >= binary32.precision && shape.emin <= binary32.emin && shape.emax >= binary32.emax;
        in.rays = in.ideal ? shared_ : scene::round_block(shared_, shape);
        for (const auto& s : shared_solids_) in.solids.push_back(scene::round_solid(s, shape));
    }
    if (ideal_ && scene_->march) in.march = scene::round_march(*scene_->march, shape);
    else if (shared_march_) in.march = scene::round_march(*shared_march_, shape);
    if (needs.unit_rays) in.unit_rays = normalised(in.rays, shape);
    if (needs.own_truth && !in.ideal) {
        in.own_truth.resize(pixels());
        for_each_pixel(pixels(), [&](std::size_t i) {
            const Ray<double> ray = in.rays[i];
            in.own_truth[i] = find_truth(ray, Solids<double>(in.solids), limit_, Touching::hit, in.rays.tmax.empty() ? HUGE_VAL : in.rays.tmax[i]);
        });
    }
    return in;
}

double Band::rounded_truth(std::size_t i, const FloatFormat& format, Direction unit_of, Touching touching) const {
    const Truth& truth = this->truth(i, touching);
    if (unit_of == Direction::unit) {
        // A distance is irrational but where |d| is rational; a bound that straddles is settled as the midpoint rounds.
        Certified middle = truth.distance;
        if (const auto r = round_certified(middle, format)) return *r;
        middle.bound = 0;
        return round_certified(middle, format).value_or(std::numeric_limits<double>::quiet_NaN());
    }
    return with_ray(i, [&](const auto& ray, auto solids) { return round_truth(truth, ray, solids[static_cast<std::size_t>(truth.object)], format); });
}

Answers evaluate(const Intersector& form, const FormatInputs& inputs) {
    const scene::RayBlock& rays = inputs.rays_for(*form.info);
    const std::size_t n = rays.size();
    const bool marches = form.shape == Shape::sdf;
    Answers answers{std::vector<double>(n), std::vector<std::uint8_t>(n), std::vector<std::int32_t>(n, -1)};
    // Packs keep no records of the marches in their lanes.
    const PackedRow native = marches ? PackedRow{form.info, form.native32, form.native64} : packed_kernels(form);
    if (marches) answers.march.resize(n);
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

}  // namespace lostbits
