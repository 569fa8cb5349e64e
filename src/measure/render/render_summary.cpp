// Summary of a rendered picture: its counts, and its columns.
#include <algorithm>
#include <cmath>

#include "measure/render/render.hpp"
#include "measure/render/stored_appearance.hpp"

namespace lostbits::measure::render {

namespace {

/// True if the true colour of a point is brighter than its ambient light although the point is truly in shadow. The
/// point lies on a sphere and faces the light.
bool has_light_in_shadow(const TruePixel& true_pixel, const TrueColour& colour, const Paint<double>& paint) {
    for (int k = 0; k < 3; ++k) {
        if (colour.channel[k].hi > paint.ambient * paint.colour[k] + 0x1p-40)
            return true_pixel.shadow == TrueShadow::shadowed;
    }
    return false;
}

}  // namespace

void add_to_summary(const RenderBand& band, std::size_t stage_index, const StoredAppearance<double>& appearance,
                    RenderSummary& summary) {
    const auto stage = static_cast<std::size_t>(summary.stage);
    for (std::size_t i = 0; i < band.seen.size(); ++i) {
        const PaintedPixel& painted = band.painted[stage_index][i];
        const TruePixel& true_pixel = band.true_pixels[i];
        const TrueColour& colour = true_pixel.colours[stage];
        const bool is_same_sphere = band.seen[i] == SeenContent::same_sphere;

        ++summary.pixels;
        ++summary.seen[static_cast<std::size_t>(band.seen[i])];

        // Colours
        summary.unresolved_colour_count += !colour.is_certain && band.seen[i] != SeenContent::unresolved;
        summary.nan_colour_count +=
            std::isnan(painted.colour.x) || std::isnan(painted.colour.y) || std::isnan(painted.colour.z);
        summary.changed_pixel_count += colour.is_certain && (painted.byte != colour.byte || std::isnan(painted.error));
        if (!std::isnan(painted.error) && (is_same_sphere || band.seen[i] == SeenContent::background))
            summary.colour_error.add(painted.error);

        // Points and normals
        if (is_same_sphere) {
            if (!std::isnan(band.residual[i])) summary.residual.add(band.residual[i]);
            if (summary.rule.has_diffuse && !std::isnan(band.normal_angle[i]))
                summary.normal_angle.add(band.normal_angle[i]);
            summary.facing_away_count += summary.rule.has_diffuse && !true_pixel.faces_light;
        }

        // Shadows: of the form compared with the truth, then of the truth alone
        if (!summary.rule.has_shadows) continue;
        const Receiver receiver = band.seen[i] == SeenContent::background ? Receiver::background : Receiver::sphere;
        ++summary.shadow[static_cast<std::size_t>(receiver)][static_cast<std::size_t>(band.shadow[i])];
        if (band.true_primitive[i] < 0 || !true_pixel.faces_light || true_pixel.shadow != TrueShadow::shadowed ||
            !colour.is_certain)
            continue;
        ++summary.truly_shadowed_point_count;
        summary.lit_in_true_shadow_count +=
            has_light_in_shadow(true_pixel, colour, appearance.paints[band.true_primitive[i]]);
    }
}

std::uint64_t RenderSummary::wrong_pixel_count() const {
    return pixels - count(SeenContent::same_sphere) - count(SeenContent::background) - count(SeenContent::unresolved);
}

std::uint64_t RenderSummary::flipped_shadow_count() const {
    std::uint64_t sum = 0;
    for (const Receiver receiver : {Receiver::sphere, Receiver::background})
        sum += count(receiver, Shadow::false_shadow) + count(receiver, Shadow::false_light);
    return sum;
}

std::uint64_t RenderSummary::unresolved_count() const {
    // If a shadow is not proved, the colour is not proved either. So each pixel without a proved shadow is already
    // counted without a proved colour, and the larger count is the whole.
    return count(SeenContent::unresolved) +
           std::max(unresolved_colour_count,
                    count(Receiver::sphere, Shadow::unresolved) + count(Receiver::background, Shadow::unresolved));
}

}  // namespace lostbits::measure::render
