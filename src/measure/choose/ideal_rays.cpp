#include "measure/choose/ideal_rays.hpp"

#include <algorithm>

#include <mpfr.h>

#include "scene/file/stretch.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::measure::choose {

namespace {

/// Rounds x once, also to formats with more bits than a double; their exponents are unbounded.
Real round_once(const Real& x, const FloatFormat& format) {
    if (format.precision <= binary64.precision) return scene::toml::round_to_format(x, format);
    mpfr_t narrow;
    mpfr_init2(narrow, format.precision);
    mpfr_set(narrow, x.backend().data(), MPFR_RNDN);
    Real result;
    mpfr_set(result.backend().data(), narrow, MPFR_RNDN);
    mpfr_clear(narrow);
    return result;
}

double to_double(const Real& x) { return static_cast<double>(x); }

/// Centres of the primitives that the rays are aimed at.
std::vector<Vec<Real>> targets_of(const IdealRays& ideal) {
    std::vector<Vec<Real>> targets;
    for (const Primitive<Real>& primitive : ideal.primitives) targets.push_back(scene::file::middle_of(primitive));
    if (ideal.is_paired) return targets;
    Vec<Real> sum(Real(0), Real(0), Real(0));
    for (const Vec<Real>& v : targets) sum = sum + v;
    return {(Real(1) / Real(targets.size())) * sum};
}

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

void set_origin(scene::rays::IdealRayBlock& rays, std::size_t i, const Vec<Real>& origin) {
    rays.ox[i] = origin.x;
    rays.oy[i] = origin.y;
    rays.oz[i] = origin.z;
}

std::optional<StretchedRays> stretch_distance(IdealRays ideal, const Real& k) {
    const auto targets = targets_of(ideal);
    std::vector<double> distances;
    for (std::size_t i = 0; i < ideal.rays.size(); ++i) {
        const Ray<Real> ray = ideal.rays[i];
        const Vec<Real>& target = targets[ideal.is_paired ? i : 0];
        const Real target_t = dot(target - ray.origin, ray.direction) / dot(ray.direction, ray.direction);
        if (!(target_t > 0)) continue;
        const Real back = (k - 1) * target_t;
        set_origin(ideal.rays, i, ray.origin - back * ray.direction);
        for (auto* const ends : {&ideal.rays.tmin, &ideal.rays.tmax})
            if (!ends->empty()) (*ends)[i] += to_double(back);
        distances.push_back(to_double(k * target_t * length(ray.direction)));
    }
    if (distances.empty()) return std::nullopt;
    return StretchedRays{std::move(ideal), median_of(std::move(distances))};
}

std::optional<StretchedRays> stretch_radius(IdealRays ideal, const Real& k) {
    if (!ideal.is_paired && ideal.primitives.size() == 1) {
        ideal.primitives.assign(ideal.rays.size(), Primitive<Real>(ideal.primitives.front()));
        ideal.is_paired = true;
    }
    Vec<Real> fixed_point(Real(0), Real(0), Real(0));
    for (std::size_t i = 0; i < ideal.rays.size(); ++i) fixed_point = fixed_point + ideal.rays[i].origin;
    fixed_point = (Real(1) / Real(ideal.rays.size())) * fixed_point;
    Real largest(0);
    for (std::size_t s = 0; s < ideal.primitives.size(); ++s) {
        const auto larger =
            scene::file::grow(ideal.primitives[s], ideal.is_paired ? ideal.rays[s].origin : fixed_point, k);
        if (!larger) return std::nullopt;
        ideal.primitives[s] = *larger;
        largest = std::max(largest, scene::file::size_of(*larger));
    }
    return StretchedRays{std::move(ideal), to_double(largest)};
}

std::optional<StretchedRays> stretch_offset(IdealRays ideal, const Real& k) {
    const auto targets = targets_of(ideal);
    std::vector<double> distances;
    for (std::size_t i = 0; i < ideal.rays.size(); ++i)
        distances.push_back(to_double(length(targets[ideal.is_paired ? i : 0] - ideal.rays[i].origin)));
    const Real distance = (k - 1) * Real(median_of(std::move(distances)));
    const Vec<Real> offset = (distance / length(scene::file::offset_direction())) * scene::file::offset_direction();
    for (std::size_t i = 0; i < ideal.rays.size(); ++i) set_origin(ideal.rays, i, ideal.rays[i].origin + offset);
    for (Primitive<Real>& primitive : ideal.primitives) primitive = scene::file::translate(primitive, offset);
    return StretchedRays{std::move(ideal), to_double(distance)};
}

}  // namespace

IdealRays make_ideal_rays(const scene::rays::RayGroup& group) {
    IdealRays ideal;
    ideal.rays.width = group.rays.width;
    ideal.rays.y0 = group.rays.y0;
    ideal.rays.y1 = group.rays.y1;
    const auto to_real = [](const Vec<double>& v) { return Vec<Real>(Real(v.x), Real(v.y), Real(v.z)); };
    for (std::size_t i = 0; i < group.rays.size(); ++i) {
        const Ray<double> ray = group.rays[i];
        ideal.rays.push({to_real(ray.origin), to_real(ray.direction)});
        ideal.rays.push_range(group.rays, i);
    }
    for (const Primitive<double>& primitive : group.primitives)
        ideal.primitives.push_back(convert_numbers(primitive, [](double x) { return Real(x); }));
    ideal.is_paired = group.is_paired;
    return ideal;
}

IdealRays make_ideal_rays(const scene::file::Scene& scene) {
    return {scene::rays::make_own_rays(scene, 0, scene.height), scene.primitives(), false};
}

scene::rays::RayGroup store_in_format(const IdealRays& ideal, const FloatFormat& format) {
    scene::rays::RayGroup group{.rays = scene::rays::round_rays(ideal.rays, format), .primitives = {}};
    for (const Primitive<Real>& primitive : ideal.primitives)
        group.primitives.push_back(scene::rays::round_primitive(primitive, format));
    group.is_paired = ideal.is_paired;
    return group;
}

IdealRays round_inputs(const IdealRays& ideal, const InputFormats& formats) {
    const auto round_input = [&formats](Input input, Real& x) {
        const auto& format = formats[static_cast<std::size_t>(input)];
        if (format) x = round_once(x, *format);
    };
    IdealRays result = ideal;
    for (auto* column : {&result.rays.ox, &result.rays.oy, &result.rays.oz})
        for (Real& x : *column) round_input(Input::origin, x);
    for (auto* column : {&result.rays.dx, &result.rays.dy, &result.rays.dz})
        for (Real& x : *column) round_input(Input::direction, x);
    for (Primitive<Real>& primitive : result.primitives) {
        for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
            const Input input = key.kind == Key::Kind::length ? Input::radius : Input::place;
            for (const std::size_t end = k + key.count(); k < end; ++k) round_input(input, primitive.numbers[k]);
        });
    }
    return result;
}

std::optional<StretchedRays> stretch(const IdealRays& rays, Growth growth, double factor) {
    const Real k(factor);
    switch (growth) {
        case Growth::distance: return stretch_distance(rays, k);
        case Growth::radius: return stretch_radius(rays, k);
        case Growth::offset: return stretch_offset(rays, k);
        case Growth::view: return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace lostbits::measure::choose
