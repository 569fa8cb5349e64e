#include "measure/band.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "intersect/packed.hpp"
#include "measure/conditioning.hpp"
#include "measure/unit_direction.hpp"

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

/// One chunk of rays against all spheres, keeping the nearest.
template <class S, class Kernel>
void nearest_of(const Kernel& kernel, const scene::RayBlock& rays, const std::vector<Solid<double>>& solids, std::size_t begin, std::size_t count,
                Answers& answers) {
    const auto ox = stored<S>(rays.ox, begin, count), oy = stored<S>(rays.oy, begin, count), oz = stored<S>(rays.oz, begin, count);
    const auto dx = stored<S>(rays.dx, begin, count), dy = stored<S>(rays.dy, begin, count), dz = stored<S>(rays.dz, begin, count);
    const auto tmax = rays.tmax.empty() ? std::vector<S>() : stored<S>(rays.tmax, begin, count);
    const RayBatch<S> batch{ox, oy, oz, dx, dy, dz, tmax};
    std::vector<S> t(count), near(count), far(count);
    std::vector<std::uint8_t> hit(count);
    for (std::size_t s = 0; s < solids.size(); ++s) {
        kernel(batch, transformed(solids[s], [](double x) { return static_cast<S>(x); }), HitBatch<S>{t, near, far, hit});
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t p = begin + i;
            const bool first = answers.hit[p] == 0 || std::isnan(answers.t[p]);
            if (hit[i] == 0 || !(first || t[i] < answers.t[p]) || (std::isnan(t[i]) && answers.hit[p] != 0)) continue;
            answers.hit[p] = 1;
            // The sign and payload of a NaN are the compiler's choice; no file may depend on it.
            answers.t[p] = std::isnan(t[i]) ? std::numeric_limits<double>::quiet_NaN() : t[i];
            answers.object[p] = static_cast<std::int32_t>(s);
        }
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
    find_truth_of_all();
}

Band::Band(scene::RayBlock rays, std::vector<Solid<double>> solids, TruthLimit limit)
    : y0_(rays.y0), rows_(rays.y1 - rays.y0), limit_(limit), shared_(std::move(rays)), shared_solids_(std::move(solids)) {
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
    FormatInputs in{.format = format, .rays = {}, .solids = {}, .unit_rays = {}, .own_truth = {}};
    const FloatFormat& shape = format.shape;
    if (ideal_) {
        in.rays = scene::round_rays(*ideal_, shape);
        for (const auto& s : ideal_solids_) in.solids.push_back(scene::round_solid(s, shape));
    } else {
        in.ideal = shape.precision >= binary32.precision && shape.emin <= binary32.emin && shape.emax >= binary32.emax;
        in.rays = in.ideal ? shared_ : scene::round_block(shared_, shape);
        for (const auto& s : shared_solids_) in.solids.push_back(scene::round_solid(s, shape));
    }
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
    Answers answers{std::vector<double>(n), std::vector<std::uint8_t>(n), std::vector<std::int32_t>(n, -1)};
    const PackedRow native = packed_kernels(form);
    constexpr std::size_t chunk = 4096;  // ray and answer arrays of a chunk stay in the second-level cache
    for (std::size_t begin = 0; begin < n; begin += chunk) {
        const std::size_t count = std::min(chunk, n - begin);
        switch (inputs.format.engine) {
            case Format::Engine::native32: nearest_of<float>(native.f32, rays, inputs.solids, begin, count, answers); break;
            case Format::Engine::native64: nearest_of<double>(native.f64, rays, inputs.solids, begin, count, answers); break;
            case Format::Engine::rounded: {
                const auto kernel = [&](const auto&... a) { form.rounded(inputs.format.shape, a...); };
                nearest_of<double>(kernel, rays, inputs.solids, begin, count, answers);
                break;
            }
        }
    }
    return answers;
}

}  // namespace lostbits
