// Compares a segment written as q − p up to 1 with (q − p)/|q − p| up to |q − p|. Also compares the closest hit with
// shadow tests that end just after it, at it, and just before it.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "measure/consistency/check.hpp"
#include "measure/consistency/segments.hpp"
#include "measure/render/stored_appearance.hpp"
#include "measure/truth/compare_hit.hpp"
#include "number/rounded.hpp"
#include "number/with_number.hpp"
#include "scene/rays/rays.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::consistency {

using scene::rays::RayBlock;
using truth::Truth;

namespace {

/// Returns the sign of t* − end, where t* is the first t at which a ray truly hits the primitive; end > 0.
std::optional<int> compare_hit_with_end(const Ray<double>& ray, const Primitive<double>& primitive, double end) {
    return truth::find_at_rising_precision([&]<class E>() {
        return truth::compare_hit<E>(lift_ray<E>(ray), lift_primitive<E>(primitive), E(end), truth::Length::parameter);
    });
}

/// Does what `truly_meets_before` does, for primitives of one shape.
Truth::Decision truly_meets_shape(const Ray<double>& ray, double end, std::span<const Primitive<double>> primitives,
                                  const intersect::Convention& shape_convention) {
    const bool takes_end = !primitives.empty() && takes_tmax(primitives.front().shape);
    intersect::Convention convention(shape_convention.touching,
                                     takes_end ? intersect::AtOrigin::hit : intersect::AtOrigin::miss);
    convention.facing = shape_convention.facing;
    const Truth ray_truth = truth::find_truth(ray, primitives, {}, convention, {.tmax = takes_end ? end : HUGE_VAL});
    if (takes_end || !ray_truth.is_hit()) return ray_truth.decision;
    if (!(end > 0)) return Truth::Decision::miss;
    if (std::isinf(end)) return Truth::Decision::hit;
    std::optional<int> order = truth::compare(ray_truth.t, truth::as_certified(end));
    if (*order == 0) order = compare_hit_with_end(ray, primitives[ray_truth.primitive], end);
    if (!order) return Truth::Decision::unresolved;
    return *order < 0 ? Truth::Decision::hit : Truth::Decision::miss;
}

/// Returns the point seen at a pixel: o + t*·d of its ray, each coordinate rounded to the format. Returns nothing if
/// the ray truly misses.
std::optional<Vec<double>> find_seen_point(const FormOnBand& band_form, std::size_t i) {
    const Truth ray_truth = band_form.band.truth(i, band_form.tested_form.convention());
    if (!ray_truth.is_hit()) return std::nullopt;
    const double t = std::ldexp(ray_truth.t.hi, static_cast<int>(ray_truth.t.exponent));
    const Ray<double> ray = band_form.inputs.rays[i];
    const auto coordinate_at = [&](double o, double d) {
        return rounding::to_format(std::fma(t, d, o), 0, band_form.format());
    };
    return Vec<double>(coordinate_at(ray.origin.x, ray.direction.x), coordinate_at(ray.origin.y, ray.direction.y),
                       coordinate_at(ray.origin.z, ray.direction.z));
}

bool are_proper(const SegmentRays& segment_rays) {
    return truth::is_valid(segment_rays.by_difference) && truth::is_valid(segment_rays.by_unit) &&
           std::isfinite(segment_rays.unit_end);
}

CheckResult check_result_of_segment(const FormOnBand& band_form, const SegmentRays& segment_rays, bool first,
                                    bool second) {
    if (first == second) return CheckResult::agree;
    const intersect::Convention convention = band_form.tested_form.convention();
    const auto first_exact =
        truly_meets_before(segment_rays.by_difference, segment_rays.difference_end,
                           band_form.candidates(segment_rays.by_difference).primitives, convention);
    const auto second_exact = truly_meets_before(segment_rays.by_unit, segment_rays.unit_end,
                                                 band_form.candidates(segment_rays.by_unit).primitives, convention);
    if (first_exact == Truth::Decision::unresolved || second_exact == Truth::Decision::unresolved)
        return CheckResult::unresolved;
    return check_result_of(first, second, first_exact == Truth::Decision::hit, second_exact == Truth::Decision::hit);
}

/// Compares the segments of all pixels. The segment of pixel i starts at `start_of(i)`.
template <class StartOf>
void compare_segments(const FormOnBand& band_form, const StartOf& start_of, SegmentEnd end, PixelCheckResults& out) {
    // Writes the segments of the pixels that see a point.
    std::vector<std::size_t> pixels;
    std::vector<SegmentRays> segments;
    RayBlock first, second;
    for (std::size_t i = 0; i < band_form.pixel_count(); ++i) {
        const auto q = find_seen_point(band_form, i);
        if (!q) continue;
        const SegmentRays s = write_segment(start_of(i), *q, band_form.tested_form.format, end);
        if (!are_proper(s)) continue;
        pixels.push_back(i);
        segments.push_back(s);
        first.push(s.by_difference);
        first.tmax.push_back(s.difference_end);
        second.push(s.by_unit);
        second.tmax.push_back(s.unit_end);
    }

    const auto first_meets = find_hits_before_tmax(band_form, first),
               second_meets = find_hits_before_tmax(band_form, second);
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const SegmentRays& s = segments[k];
        out.set(pixels[k], check_result_of_segment(band_form, s, first_meets[k] != 0, second_meets[k] != 0), [&] {
            return RayPair{0, band_form.group_to_explain(s.by_difference, s.difference_end),
                           band_form.group_to_explain(s.by_unit, s.unit_end)};
        });
    }
}

/// Compares the closest hit at each pixel with a shadow test that ends at `end_of(t)`. `expected` is the right answer
/// of the test.
template <class EndOf>
void compare_with_shadow_tests(const FormOnBand& band_form, const EndOf& end_of, bool expected,
                               PixelCheckResults& out) {
    scene::rays::RayBlock rays = band_form.rays();
    rays.tmax.assign(rays.size(), HUGE_VAL);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (band_form.closest_hits.hit[i] != 0) rays.tmax[i] = end_of(band_form.closest_hits.t[i]);
    }
    const auto meets = find_hits_before_tmax(band_form, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (band_form.closest_hits.hit[i] == 0 || std::isnan(rays.tmax[i])) continue;
        const CheckResult result = (meets[i] != 0) == expected ? CheckResult::agree
                                   : expected                  ? CheckResult::first_alone
                                                               : CheckResult::second_alone;
        out.set(i, result, [&] {
            return RayPair{i, band_form.group_to_explain(band_form.inputs.rays[i], HUGE_VAL),
                           band_form.group_to_explain(band_form.inputs.rays[i], rays.tmax[i])};
        });
    }
}

}  // namespace

Truth::Decision truly_meets_before(const Ray<double>& ray, double end, std::span<const Primitive<double>> primitives,
                                   intersect::Convention convention) {
    bool unresolved = false;
    for (const ShapeRow& shape_row : shape_rows) {
        std::vector<Primitive<double>> shape_primitives;
        std::ranges::copy_if(
            primitives, std::back_inserter(shape_primitives),
            [&shape_row](const Primitive<double>& primitive) { return primitive.shape == shape_row.shape; });
        const auto meets = truly_meets_shape(ray, end, shape_primitives, convention.for_shape(shape_row.shape));
        if (meets == Truth::Decision::hit) return meets;
        unresolved = unresolved || meets == Truth::Decision::unresolved;
    }
    return unresolved ? Truth::Decision::unresolved : Truth::Decision::miss;
}

SegmentRays write_segment(const Vec<double>& p, const Vec<double>& q, const Format& format, SegmentEnd end) {
    return with_number(format, [&]<class T>() {
        const Vec<T> start = lift_vec<T>(p), difference = lift_vec<T>(q) - start;
        const T distance = length(difference);
        T fraction(1);
        if (end == SegmentEnd::shortened) fraction = T(1) - T(1) / T(10000);
        return SegmentRays{.by_difference = {p, as_doubles(difference)},
                           .difference_end = as_double(fraction),
                           .by_unit = {p, as_doubles(unit_of<T>(difference))},
                           .unit_end = as_double(fraction * distance)};
    });
}

void check_segment(const FormOnBand& band_form, PixelCheckResults& out) {
    compare_segments(
        band_form, [&](std::size_t i) { return band_form.inputs.rays[i].origin; }, SegmentEnd::whole, out);
}

void check_short(const FormOnBand& band_form, PixelCheckResults& out) {
    compare_segments(
        band_form, [&](std::size_t i) { return band_form.inputs.rays[i].origin; }, SegmentEnd::shortened, out);
}

void check_light(const FormOnBand& band_form, PixelCheckResults& out) {
    const Vec<double> light = render::make_input_appearance(band_form.scene, band_form.format()).light;
    compare_segments(
        band_form, [&](std::size_t) { return light; }, SegmentEnd::shortened, out);
}

void check_beyond(const FormOnBand& band_form, PixelCheckResults& out) {
    // There is no end after an infinite t or a NaN, so any hit is right.
    compare_with_shadow_tests(
        band_form, [&](double t) { return std::isfinite(t) ? rounding::next_up(t, band_form.format()) : HUGE_VAL; },
        true, out);
}

void check_end(const FormOnBand& band_form, PixelCheckResults& out) {
    compare_with_shadow_tests(
        band_form, [](double t) { return std::isfinite(t) ? t : truth::missing; }, false, out);
}

void check_before(const FormOnBand& band_form, PixelCheckResults& out) {
    // A ray cannot end before t = 0.
    compare_with_shadow_tests(
        band_form,
        [&](double t) {
            return std::isfinite(t) && t > 0 ? -rounding::next_up(-t, band_form.format()) : truth::missing;
        },
        false, out);
}

}  // namespace lostbits::measure::consistency
