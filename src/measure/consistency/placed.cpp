// Compares a transformed primitive with the same primitive without a transform.
#include <algorithm>
#include <cmath>
#include <memory>

#include "intersect/table/sets.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/consistency/check.hpp"
#include "measure/offset/offsets.hpp"

namespace lostbits::measure::consistency {

using intersect::table::Intersector;
using truth::Truth;

namespace {

/// Returns the primitive moved so that its middle is the origin, with a transform that moves it back.
Primitive<double> move_to_origin(const Primitive<double>& primitive, const FloatFormat& format) {
    const auto stored = [&format](double x) { return rounding::to_format(x, 0, format); };
    const auto stored_point = [&](const Vec<double>& v) { return Vec<double>(stored(v.x), stored(v.y), stored(v.z)); };
    const Vec<double> middle = stored_point(visit(primitive, [](const auto& shape) { return shape.middle(); }));
    Primitive<double> moved_primitive = primitive;
    for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
        if (key.kind == Key::Kind::point) moved_primitive.set_point(k, stored_point(primitive.point(k) - middle));
    });
    moved_primitive.transform = Transform<double>{{1, 0, 0, middle.x, 0, 1, 0, middle.y, 0, 0, 1, middle.z}, false, 1};
    return moved_primitive;
}

/// Returns the common factor by which a matrix scales all lengths, if there is one within the rounding of the format.
std::optional<double> common_scale(const Affine<double>& m, const FloatFormat& format) {
    const auto column = [&m](int i) { return Vec<double>(m.rows[0][i], m.rows[1][i], m.rows[2][i]); };
    const Vec<double> x = column(0), y = column(1), z = column(2);
    const double size = square(x), tolerance = std::ldexp(size, 3 - format.precision);
    for (const double deviation : {dot(x, y), dot(y, z), dot(z, x), square(y) - size, square(z) - size})
        if (!(std::fabs(deviation) <= tolerance)) return std::nullopt;
    return std::sqrt(size);
}

bool is_diagonal(const Affine<double>& m) {
    return m.rows[0].y == 0 && m.rows[0].z == 0 && m.rows[1].x == 0 && m.rows[1].z == 0 && m.rows[2].x == 0 &&
           m.rows[2].y == 0;
}

/// Returns the image of a primitive under its stored matrix as a primitive without a matrix, with each number rounded
/// once to the format. Returns nothing for:
///
/// - a shape with lengths or directions, with a transform that is not a rotation with a common scale, to within 4u;
/// - a box, with a transform that is not diagonal;
/// - a shape with a radius for each axis;
/// - a matrix that is stored as its inverse.
std::optional<Primitive<double>> compute_image(const Primitive<double>& primitive, const FloatFormat& format) {
    if (!primitive.transform || primitive.transform->is_inverse) return std::nullopt;
    const Affine<double> m = primitive.transform->map();
    const std::span<const Key> keys = row_of(primitive.shape).keys;

    // Properties of the shape, and of the matrix.
    const bool is_axis_aligned =
        std::ranges::any_of(keys, [](const Key& key) { return key.limit == Key::Limit::at_least_previous; });
    const bool has_only_points = std::ranges::all_of(keys, [](const Key& key) { return key.kind == Key::Kind::point; });
    const bool has_axis_lengths =
        std::ranges::any_of(keys, [](const Key& key) { return key.kind == Key::Kind::lengths; });
    const auto scale = common_scale(m, format);
    if (is_axis_aligned ? !is_diagonal(m) : has_axis_lengths || (!has_only_points && !scale)) return std::nullopt;

    Primitive<double> image = primitive;
    image.transform.reset();
    for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
        switch (key.kind) {
            case Key::Kind::point: image.set_point(k, m.point(primitive.point(k))); break;
            case Key::Kind::direction: image.set_point(k, m.linear(primitive.point(k))); break;
            default: image.numbers[k] = scale.value_or(1) * primitive.numbers[k];
        }
    });

    // A negative scale on an axis swaps the coordinates of the two corners.
    if (is_axis_aligned)
        for (std::size_t i = 0; i < 3; ++i)
            if (image.numbers[i] > image.numbers[i + 3]) std::swap(image.numbers[i], image.numbers[i + 3]);
    return convert_numbers(image, [&format](double x) { return rounding::to_format(x, 0, format); });
}

/// Returns a form that takes primitives with and without matrices: the form itself, or the form with the usual
/// transform method.
const Intersector& form_with_matrices(const Intersector& form) {
    const auto& usual_method = intersect::transform::default_transform_method();
    if (form.shapes().have_transform()) return form;
    if (!form.is_set()) return intersect::transform::transformed_form(usual_method, form);
    std::vector<const Intersector*> parts;
    for (const Intersector* const part : form.parts)
        parts.push_back(&intersect::transform::transformed_form(usual_method, *part));
    return intersect::table::find_or_add_set(parts);
}

/// Returns each transformed primitive without its transform, and gives each other primitive a transform. A primitive
/// that cannot be converted is unchanged. Returns an empty list if none can be converted.
std::vector<Primitive<double>> convert_primitives(const FormOnBand& band_form,
                                                  const std::vector<Primitive<double>>& primitives) {
    bool any_converted = false;
    std::vector<Primitive<double>> converted;
    for (const Primitive<double>& primitive : primitives) {
        const auto other_primitive = primitive.transform ? compute_image(primitive, band_form.format())
                                                         : std::optional(move_to_origin(primitive, band_form.format()));
        any_converted = any_converted || other_primitive;
        converted.push_back(other_primitive.value_or(primitive));
    }
    return any_converted ? converted : std::vector<Primitive<double>>{};
}

/// The rays of the band with other primitives, and the index of these primitives.
struct BandAmongPrimitives {
    std::unique_ptr<culling::Culler> culler = {};
    std::unique_ptr<truth::Band> band;

    BandAmongPrimitives(const FormOnBand& band_form, const std::vector<Primitive<double>>& primitives) {
        if (primitives.size() > offset::max_primitives)
            culler = std::make_unique<culling::Culler>(scene::rays::PrimitiveList<double>(primitives),
                                                       band_form.inputs.rays);
        scene::rays::RayGroup group{.rays = band_form.inputs.rays, .primitives = primitives};
        band = std::make_unique<truth::Band>(std::move(group), truth::ProofLimit{.stop = band_form.kernels.stop},
                                             culler.get());
    }
};

/// Returns all primitives, or the triangles of a large mesh that a ray of the band may meet.
std::vector<Primitive<double>> primitives_of(const FormOnBand& band_form) {
    std::vector<Ray<double>> rays;
    for (std::size_t i = 0; i < band_form.pixel_count(); ++i) rays.push_back(band_form.inputs.rays[i]);
    return band_form.candidates(rays).primitives;
}

}  // namespace

void check_placed(const FormOnBand& band_form, PixelCheckResults& out) {
    out.apart.assign(band_form.pixel_count(), truth::missing);
    out.excess.assign(band_form.pixel_count(), truth::missing);
    const std::vector<Primitive<double>> primitives = primitives_of(band_form),
                                         converted = convert_primitives(band_form, primitives);

    if (converted.empty()) return;
    const BandAmongPrimitives given_band(band_form, primitives), converted_band(band_form, converted);
    const truth::Band &given_truth = *given_band.band, &converted_truth = *converted_band.band;

    const Intersector& form = form_with_matrices(*band_form.tested_form.form);
    const bool is_unit = form.info->direction == intersect::Direction::unit;
    const auto converted_answers =
        answer::evaluate(form, converted_truth.inputs_for(band_form.tested_form.format, *form.info));
    const answer::Answers &a = band_form.closest_hits, &b = converted_answers;

    for (std::size_t i = 0; i < band_form.pixel_count(); ++i) {
        const Truth p = given_truth.truth(i, band_form.tested_form.convention()),
                    q = converted_truth.truth(i, band_form.tested_form.convention());

        CheckResult result = check_result_of(a.hit[i] != 0, b.hit[i] != 0, p.is_hit(), q.is_hit());
        if (p.decision == Truth::Decision::unresolved || q.decision == Truth::Decision::unresolved)
            result = CheckResult::unresolved;
        else if (a.hit[i] != 0 && b.hit[i] != 0 && p.is_hit() && q.is_hit() && returns_t(*form.info)) {
            const auto &first = is_unit ? p.distance : p.t, &second = is_unit ? q.distance : q.t;
            const std::int64_t ulp = ulp_exponent(band_form.format(), first.floor_log2());
            const auto error_in_ulps = [ulp](double t, const truth::CertifiedNumber& exact) {
                return truth::scaled_difference(truth::as_certified(t), exact, ulp);
            };
            out.apart[i] = std::fabs(error_in_ulps(a.t[i], truth::as_certified(b.t[i])));
            out.excess[i] = std::fabs(error_in_ulps(a.t[i], first) - error_in_ulps(b.t[i], second));
            // The error of a correctly rounded t is at most half an ulp, so two of them differ by at most one ulp.
            result = !(out.excess[i] <= 1) ? CheckResult::other_number
                     : out.apart[i] > 1    ? CheckResult::by_inputs
                                           : CheckResult::agree;
        }

        out.set(i, result, [&] {
            RayPair two_rays{i, band_form.group_to_explain(band_form.inputs.rays[i], HUGE_VAL),
                             scene::rays::make_group(band_form.inputs.rays[i])};
            if (converted.size() <= truth::Band::max_original_primitives) two_rays.second.primitives = converted;
            return two_rays;
        });
    }
}

}  // namespace lostbits::measure::consistency
