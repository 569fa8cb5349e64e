// Compares a segment written as q − p up to 1 with (q − p)/|q − p| up to |q − p|. Also compares the closest hit with
// shadow tests that end just after it, at it, and just before it.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "measure/consistency/check.hpp"
#include "measure/consistency/segments.hpp"
#include "measure/picture/stored_appearance.hpp"
#include "measure/truth/side.hpp"
#include "number/rounded.hpp"
#include "number/with_number.hpp"
#include "scene/rays/rays.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::consistency {

using scene::rays::RayBlock;
using truth::Truth;

namespace {

/// Sign of t* − m for the first t* of a ray that truly hits the sphere; m > 0.
std::optional<int> side_of_end(const Ray<double>& ray, const Primitive<double>& sphere, double m) {
    return truth::by_rising_precision([&]<class E>() {
        return truth::side_of<E>(lift_ray<E>(ray), lift_primitive<E>(sphere), E(m), truth::Length::parameter);
    });
}

/// True decision for primitives of one shape.
Truth::Decision truly_meets_alike(const Ray<double>& ray, double end, std::span<const Primitive<double>> primitives,
                                  const intersect::Convention& own) {
    const bool ends = !primitives.empty() && takes_tmax(primitives.front().shape);
    intersect::Convention convention(own.touching, ends ? intersect::AtOrigin::hit : intersect::AtOrigin::miss);
    convention.facing = own.facing;
    const Truth first = truth::find_truth(ray, primitives, {}, convention, {.tmax = ends ? end : HUGE_VAL});
    if (ends || !first.is_hit()) return first.decision;
    if (!(end > 0)) return Truth::Decision::miss;
    if (std::isinf(end)) return Truth::Decision::hit;
    std::optional<int> side = truth::compare(first.t, truth::exactly(end));
    if (*side == 0) side = side_of_end(ray, primitives[static_cast<std::size_t>(first.object)], end);
    if (!side) return Truth::Decision::unresolved;
    return *side < 0 ? Truth::Decision::hit : Truth::Decision::miss;
}

/// The point seen at a pixel: o + t*·d of its own ray, each coordinate rounded to the format. Nothing if the ray truly
/// misses.
std::optional<Vec<double>> seen_point(const FormOnBand& band_form, std::size_t i) {
    const Truth truth = band_form.band.truth(i, band_form.row.convention());
    if (!truth.is_hit()) return std::nullopt;
    const double t = std::ldexp(truth.t.hi, static_cast<int>(truth.t.exponent));
    const Ray<double> ray = band_form.inputs.rays[i];
    const auto at = [&](double o, double d) { return rounding::to_format(std::fma(t, d, o), 0, band_form.format()); };
    return Vec<double>(at(ray.origin.x, ray.direction.x), at(ray.origin.y, ray.direction.y),
                       at(ray.origin.z, ray.direction.z));
}

bool is_ray(const SegmentRays& s) {
    return truth::is_proper(s.by_difference) && truth::is_proper(s.by_unit) && std::isfinite(s.unit_end);
}

CheckResult check_result_of_segment(const FormOnBand& band_form, const SegmentRays& s, bool first, bool second) {
    if (first == second) return CheckResult::agree;
    const intersect::Convention convention = band_form.row.convention();
    const auto one = truly_meets_before(s.by_difference, s.difference_end,
                                        band_form.candidates(s.by_difference).primitives, convention);
    const auto other =
        truly_meets_before(s.by_unit, s.unit_end, band_form.candidates(s.by_unit).primitives, convention);
    if (one == Truth::Decision::unresolved || other == Truth::Decision::unresolved) return CheckResult::unresolved;
    return check_result_of(first, second, one == Truth::Decision::hit, other == Truth::Decision::hit);
}

/// Compares the segments of all pixels; the segment of pixel i starts at `from(i)`.
template <class From>
void compare_segments(const FormOnBand& band_form, const From& from, EndOfSegment end, PixelCheckResults& out) {
    std::vector<std::size_t> pixels;
    std::vector<SegmentRays> segments;
    RayBlock first, second;
    for (std::size_t i = 0; i < band_form.pixels(); ++i) {
        const auto q = seen_point(band_form, i);
        if (!q) continue;
        const SegmentRays s = write_segment(from(i), *q, band_form.row.format, end);
        if (!is_ray(s)) continue;
        pixels.push_back(i);
        segments.push_back(s);
        first.push(s.by_difference);
        first.tmax.push_back(s.difference_end);
        second.push(s.by_unit);
        second.tmax.push_back(s.unit_end);
    }
    const auto one = meets_before_end(band_form, first), other = meets_before_end(band_form, second);
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const SegmentRays& s = segments[k];
        out.set(pixels[k], check_result_of_segment(band_form, s, one[k] != 0, other[k] != 0), [&] {
            return TwoRays{0, band_form.shown(s.by_difference, s.difference_end),
                           band_form.shown(s.by_unit, s.unit_end)};
        });
    }
}

/// Compares a map's hit at a pixel with a shadow test whose end is computed from its t. `expected`: the right answer of
/// the test.
template <class End>
void compare_with_ends(const FormOnBand& band_form, const End& end, bool expected, PixelCheckResults& out) {
    scene::rays::RayBlock rays = band_form.rays();
    rays.tmax.assign(rays.size(), HUGE_VAL);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (band_form.closest.hit[i] != 0) rays.tmax[i] = end(band_form.closest.t[i]);
    }
    const auto meets = meets_before_end(band_form, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (band_form.closest.hit[i] == 0 || std::isnan(rays.tmax[i])) continue;
        const CheckResult how = (meets[i] != 0) == expected ? CheckResult::agree
                                : expected                  ? CheckResult::first_alone
                                                            : CheckResult::second_alone;
        out.set(i, how, [&] {
            return TwoRays{i, band_form.shown(band_form.inputs.rays[i], HUGE_VAL),
                           band_form.shown(band_form.inputs.rays[i], rays.tmax[i])};
        });
    }
}

}  // namespace

Truth::Decision truly_meets_before(const Ray<double>& ray, double end, std::span<const Primitive<double>> primitives,
                                   intersect::Convention convention) {
    bool unresolved = false;
    for (const ShapeRow& row : shape_rows) {
        std::vector<Primitive<double>> alike;
        std::ranges::copy_if(primitives, std::back_inserter(alike),
                             [&row](const Primitive<double>& primitive) { return primitive.shape == row.shape; });
        const auto meets = truly_meets_alike(ray, end, alike, convention.of(row.shape));
        if (meets == Truth::Decision::hit) return meets;
        unresolved = unresolved || meets == Truth::Decision::unresolved;
    }
    return unresolved ? Truth::Decision::unresolved : Truth::Decision::miss;
}

SegmentRays write_segment(const Vec<double>& p, const Vec<double>& q, const Format& format, EndOfSegment end) {
    return with_number(format, [&]<class T>() {
        const Vec<T> from = lift_vec<T>(p), way = lift_vec<T>(q) - from;
        const T size = length(way);
        T share(1);
        if (end == EndOfSegment::shortened) share = T(1) - T(1) / T(10000);
        return SegmentRays{.by_difference = {p, as_doubles(way)},
                           .difference_end = as_double(share),
                           .by_unit = {p, as_doubles(unit_of<T>(way))},
                           .unit_end = as_double(share * size)};
    });
}

void check_segment(const FormOnBand& band_form, PixelCheckResults& out) {
    compare_segments(
        band_form, [&](std::size_t i) { return band_form.inputs.rays[i].origin; }, EndOfSegment::whole, out);
}

void check_short(const FormOnBand& band_form, PixelCheckResults& out) {
    compare_segments(
        band_form, [&](std::size_t i) { return band_form.inputs.rays[i].origin; }, EndOfSegment::shortened, out);
}

void check_light(const FormOnBand& band_form, PixelCheckResults& out) {
    const Vec<double> light = picture::input_appearance(band_form.scene, band_form.format()).light;
    compare_segments(
        band_form, [&](std::size_t) { return light; }, EndOfSegment::shortened, out);
}

void check_beyond(const FormOnBand& band_form, PixelCheckResults& out) {
    // No end lies after an infinite t or a NaN, so any hit is right.
    compare_with_ends(
        band_form, [&](double t) { return std::isfinite(t) ? rounding::next_up(t, band_form.format()) : HUGE_VAL; },
        true, out);
}

void check_end(const FormOnBand& band_form, PixelCheckResults& out) {
    compare_with_ends(
        band_form, [](double t) { return std::isfinite(t) ? t : truth::missing; }, false, out);
}

void check_before(const FormOnBand& band_form, PixelCheckResults& out) {
    // A ray cannot end before t = 0.
    compare_with_ends(
        band_form,
        [&](double t) {
            return std::isfinite(t) && t > 0 ? -rounding::next_up(-t, band_form.format()) : truth::missing;
        },
        false, out);
}

}  // namespace lostbits::measure::consistency
