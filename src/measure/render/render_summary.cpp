// Summary of a rendered picture: its counts, and its columns.
#include <algorithm>
#include <cmath>

#include "measure/render/render.hpp"
#include "measure/render/stored_appearance.hpp"

namespace lostbits::measure::render {

using metric::Distribution;
using truth::fraction;
using truth::missing;

namespace {

using R = RenderSummary;

double to_double(std::uint64_t n) { return static_cast<double>(n); }
double median(const Distribution& d) { return d.quantile(0.5); }
double percentile_99(const Distribution& d) { return d.quantile(0.99); }
double largest(const Distribution& d) { return d.quantile(1); }

template <SeenContent s>
double seen_count(const R& r) {
    return to_double(r.count(s));
}

/// Returns the number of points of a receiver that truly get the light. `count_truly_shadowed` counts those whose light
/// is truly blocked.
std::uint64_t count_truly_lit(const R& r, Receiver receiver) {
    return r.count(receiver, Shadow::both_lit) + r.count(receiver, Shadow::false_shadow) +
           r.count(receiver, Shadow::own_shadow);
}
std::uint64_t count_truly_shadowed(const R& r, Receiver receiver) {
    return r.count(receiver, Shadow::both_shadowed) + r.count(receiver, Shadow::false_light);
}

template <Receiver receiver, Shadow s>
double shadow_count(const R& r) {
    return r.rule.has_shadows ? to_double(r.count(receiver, s)) : missing;
}

/// True if the true colour of a point is brighter than its ambient light although the point is truly in shadow. The
/// point lies on a sphere and faces the light.
bool has_light_in_shadow(const TruePixel& true_pixel, const TrueColour& colour, const Paint<double>& paint) {
    for (int k = 0; k < 3; ++k) {
        if (colour.channel[static_cast<std::size_t>(k)].hi > paint.ambient * paint.colour[k] + 0x1p-40)
            return true_pixel.shadow == TrueShadow::shadowed;
    }
    return false;
}

constexpr RenderColumn table[] = {
    // Contents
    {"pixels", "", "pixels of the picture", true, [](const R& r) { return to_double(r.pixels); }},
    {"same_sphere", "", "pixels on which form and truth see the same sphere", true,
     seen_count<SeenContent::same_sphere>},
    {"background", "", "pixels on which both see the background", true, seen_count<SeenContent::background>},
    {"other_sphere", "", "pixels on which the form sees another sphere than the true one", true,
     seen_count<SeenContent::other_sphere>},
    {"lost_sphere", "", "pixels on which the form sees the background instead of a sphere", true,
     seen_count<SeenContent::lost_sphere>},
    {"extra_sphere", "", "pixels on which the form sees a sphere where there is only background", true,
     seen_count<SeenContent::extra_sphere>},
    {"not_a_number", "", "pixels on which the form reports a hit at NaN", true, seen_count<SeenContent::not_a_number>},

    // Pixels in doubt, and changed pixels
    {"unresolved", "", "pixels whose content, shadow or colour could not be proved", true,
     [](const R& r) { return to_double(r.unresolved()); }},
    {"changed", "", "pixels with a byte that differs from the certified picture", true,
     [](const R& r) { return to_double(r.changed_pixels); }},
    {"changed_fraction", "1", "changed, as a share of all pixels", false,
     [](const R& r) { return fraction(r.changed_pixels, r.pixels); }},

    // Errors of colours, normals and points
    {"colour_error_mean", "8-bit steps",
     "mean of the largest |channel - true channel| * 255, where form and truth see the same", false,
     [](const R& r) { return r.colour_error.mean(); }},
    {"colour_error_p50", "8-bit steps", "median (to 2^-11 of itself) of the same", false,
     [](const R& r) { return median(r.colour_error); }},
    {"colour_error_p99", "8-bit steps", "99th percentile of the same", false,
     [](const R& r) { return percentile_99(r.colour_error); }},
    {"colour_error_max", "8-bit steps", "largest of the same", false,
     [](const R& r) { return largest(r.colour_error); }},
    {"colour_not_a_number", "", "pixels with a channel at NaN", true,
     [](const R& r) { return to_double(r.colour_not_a_number); }},
    {"normal_angle_p50", "rad", "median angle between computed and true normal, on the same sphere", false,
     [](const R& r) { return median(r.normal_angle); }},
    {"normal_angle_p99", "rad", "99th percentile of the same", false,
     [](const R& r) { return percentile_99(r.normal_angle); }},
    {"normal_angle_max", "rad", "largest of the same", false, [](const R& r) { return largest(r.normal_angle); }},
    {"residual_p50", "radius", "median of ||P - G| - r|/r, P the computed point, on the same sphere", false,
     [](const R& r) { return median(r.residual); }},
    {"residual_p99", "radius", "99th percentile of the same", false,
     [](const R& r) { return percentile_99(r.residual); }},
    {"residual_max", "radius", "largest of the same", false, [](const R& r) { return largest(r.residual); }},

    // Light and shadow on spheres
    {"faces_away", "", "same_sphere, on the side away from the light", true,
     [](const R& r) { return r.rule.has_diffuse ? to_double(r.faces_away) : missing; }},
    {"surface_lit", "", "same_sphere that faces the light and truly gets it", true,
     [](const R& r) { return r.rule.has_shadows ? to_double(count_truly_lit(r, Receiver::sphere)) : missing; }},
    {"surface_shadowed", "", "same_sphere that faces the light, truly blocked by another sphere", true,
     [](const R& r) { return r.rule.has_shadows ? to_double(count_truly_shadowed(r, Receiver::sphere)) : missing; }},
    {"false_shadow", "", "surface_lit that the form puts in the shadow of another sphere", true,
     shadow_count<Receiver::sphere, Shadow::false_shadow>},
    {"own_shadow", "", "surface_lit that the form puts in the shadow of its own sphere alone: acne", true,
     shadow_count<Receiver::sphere, Shadow::own_shadow>},
    {"false_light", "", "surface_shadowed that the form lights", true,
     shadow_count<Receiver::sphere, Shadow::false_light>},
    {"own_shadow_fraction", "1", "own_shadow, as a share of surface_lit", false,
     [](const R& r) {
         return r.rule.has_shadows
                    ? fraction(r.count(Receiver::sphere, Shadow::own_shadow), count_truly_lit(r, Receiver::sphere))
                    : missing;
     }},
    {"flip_fraction", "1", "false_shadow and false_light, as a share of surface_lit and surface_shadowed", false,
     [](const R& r) {
         if (!r.rule.has_shadows) return missing;
         return fraction(
             r.count(Receiver::sphere, Shadow::false_shadow) + r.count(Receiver::sphere, Shadow::false_light),
             count_truly_lit(r, Receiver::sphere) + count_truly_shadowed(r, Receiver::sphere));
     }},

    // Light and shadow on the background
    {"background_lit", "", "background that truly gets the light, as seen by both", true,
     [](const R& r) { return r.rule.has_shadows ? to_double(count_truly_lit(r, Receiver::background)) : missing; }},
    {"background_shadowed", "", "background truly in shadow, as seen by both", true,
     [](const R& r) {
         return r.rule.has_shadows ? to_double(count_truly_shadowed(r, Receiver::background)) : missing;
     }},
    {"background_false_shadow", "", "background_lit that the form puts in shadow", true,
     shadow_count<Receiver::background, Shadow::false_shadow>},
    {"background_false_light", "", "background_shadowed that the form lights", true,
     shadow_count<Receiver::background, Shadow::false_light>},

    // Appearance of the scene itself
    {"light_in_shadow_fraction", "1",
     "share of the certified picture's points that face the light, are in shadow, and get diffuse light anyway", false,
     [](const R& r) {
         return r.rule.has_shadows ? fraction(r.light_in_true_shadow, r.truly_shadowed_points) : missing;
     }},
};

}  // namespace

void add_to_summary(const RenderBand& band, std::size_t stage_index, const StoredAppearance<double>& appearance,
                    RenderSummary& s) {
    const auto stage = static_cast<std::size_t>(s.stage);
    for (std::size_t i = 0; i < band.seen.size(); ++i) {
        const PaintedPixel& painted = band.painted[stage_index][i];
        const TruePixel& true_pixel = band.true_pixels[i];
        const TrueColour& colour = true_pixel.colours[stage];
        const bool is_same_sphere = band.seen[i] == SeenContent::same_sphere;

        ++s.pixels;
        ++s.seen[static_cast<std::size_t>(band.seen[i])];

        // Colours
        s.colour_unresolved += !colour.is_certain && band.seen[i] != SeenContent::unresolved;
        s.colour_not_a_number +=
            std::isnan(painted.colour.x) || std::isnan(painted.colour.y) || std::isnan(painted.colour.z);
        s.changed_pixels += colour.is_certain && (painted.byte != colour.byte || std::isnan(painted.error));
        if (!std::isnan(painted.error) && (is_same_sphere || band.seen[i] == SeenContent::background))
            s.colour_error.add(painted.error);

        // Points and normals
        if (is_same_sphere) {
            if (!std::isnan(band.residual[i])) s.residual.add(band.residual[i]);
            if (s.rule.has_diffuse && !std::isnan(band.normal_angle[i])) s.normal_angle.add(band.normal_angle[i]);
            s.faces_away += s.rule.has_diffuse && !true_pixel.faces_light;
        }

        // Shadows: of the form compared with the truth, then of the truth alone
        if (!s.rule.has_shadows) continue;
        const Receiver receiver = band.seen[i] == SeenContent::background ? Receiver::background : Receiver::sphere;
        ++s.shadow[static_cast<std::size_t>(receiver)][static_cast<std::size_t>(band.shadow[i])];
        if (band.true_primitive[i] < 0 || !true_pixel.faces_light || true_pixel.shadow != TrueShadow::shadowed ||
            !colour.is_certain)
            continue;
        ++s.truly_shadowed_points;
        s.light_in_true_shadow += has_light_in_shadow(
            true_pixel, colour, appearance.paints[static_cast<std::size_t>(band.true_primitive[i])]);
    }
}

std::span<const RenderColumn> render_columns() { return table; }

std::uint64_t RenderSummary::wrong_pixels() const {
    return pixels - count(SeenContent::same_sphere) - count(SeenContent::background) - count(SeenContent::unresolved);
}

std::uint64_t RenderSummary::flipped_shadows() const {
    std::uint64_t sum = 0;
    for (const Receiver receiver : {Receiver::sphere, Receiver::background})
        sum += count(receiver, Shadow::false_shadow) + count(receiver, Shadow::false_light);
    return sum;
}

std::uint64_t RenderSummary::unresolved() const {
    // If a shadow is not proved, the colour is not proved either. So each pixel without a proved shadow is already
    // counted without a proved colour, and the larger count is the whole.
    return count(SeenContent::unresolved) +
           std::max(colour_unresolved,
                    count(Receiver::sphere, Shadow::unresolved) + count(Receiver::background, Shadow::unresolved));
}

}  // namespace lostbits::measure::render
