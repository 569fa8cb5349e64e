// Renders pictures: every stage in every format, by a form's own hits and shadows, and compares them with the certified
// picture.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/render/shade.hpp"
#include "measure/render/stored_appearance.hpp"
#include "measure/render/true_picture.hpp"
#include "measure/shard/share.hpp"

namespace lostbits::measure::render {

/// Content of a pixel as the form sees it, compared with the true content.
enum class SeenContent : std::uint8_t {
    same_sphere,
    background,
    other_sphere,
    lost_sphere,
    extra_sphere,
    not_a_number,
    unresolved
};
inline constexpr std::array<std::string_view, 7> seen_names{
    "same_sphere", "background", "other_sphere", "lost_sphere", "extra_sphere", "not_a_number", "unresolved"};

/// Shadow decision of the form, compared with that of the truth. The two are compared where both see the background, or
/// the same sphere at a point that truly faces the light. A point that faces away gets no light in either case.
/// `own_shadow` is acne: a false shadow that only the point's own sphere casts.
enum class Shadow : std::uint8_t {
    not_compared,
    both_lit,
    both_shadowed,
    false_shadow,
    own_shadow,
    false_light,
    unresolved
};
inline constexpr std::array<std::string_view, 7> shadow_names{
    "not_compared", "both_lit", "both_shadowed", "false_shadow", "own_shadow", "false_light", "unresolved"};

/// Content that receives light or shadow.
enum class Receiver : std::uint8_t { sphere, background };

struct PaintedPixel {
    Vec<double> colour{0, 0, 0};  ///< numbers of the format, not clamped; NaN if the form's t is NaN
    std::array<std::uint8_t, 3> byte{};
    double error = 0;  ///< largest |channel - true channel|, in 8-bit steps; NaN if either is unknown
};

/// Returns 255c, rounded once, half up, and clamped to 0…255, with c the channel. Returns 0 for NaN; pictures mark such
/// a pixel separately.
std::uint8_t byte_of(double channel);

/// Picture of one form in one format over some scanlines.
struct RenderBand {
    int y0, scanlines, width;
    answer::Answers answers;
    std::span<const TruePixel> true_pixels;
    std::vector<SeenContent> seen;
    std::vector<Shadow> shadow;  ///< empty where no stage casts shadows
    /// Angle between the computed and the true normal, in radians; NaN except on `same_sphere`.
    std::vector<double> normal_angle;
    std::vector<double> residual;                    ///< the metric of that name; NaN except on `same_sphere`
    std::vector<std::vector<PaintedPixel>> painted;  ///< one picture for each stage, in the order of the study
    std::vector<std::int32_t> true_primitive;        ///< index of the sphere that the ray truly hits; −1: background
};

/// Totals of one stage of one row over the whole picture.
struct RenderSummary {
    scene::file::Stage stage = scene::file::Stage::visible;
    ShadeRule rule;
    std::uint64_t pixels = 0;
    std::array<std::uint64_t, seen_names.size()> seen{};
    /// Counts of shadow decisions, indexed by `Receiver`.
    std::array<std::array<std::uint64_t, shadow_names.size()>, 2> shadow{};
    std::uint64_t facing_away_count = 0;           ///< points on the same sphere that truly face away from the light
    std::uint64_t truly_shadowed_point_count = 0;  ///< points on spheres that face the light and are truly in shadow
    /// Number of `truly_shadowed_point_count` that have diffuse light in the true picture anyway.
    std::uint64_t lit_in_true_shadow_count = 0;
    std::uint64_t changed_pixel_count = 0;  ///< pixels with a byte that differs from the true one
    std::uint64_t unresolved_colour_count = 0, nan_colour_count = 0;
    metric::Distribution colour_error, normal_angle, residual;

    [[nodiscard]] std::uint64_t count(SeenContent s) const { return seen[static_cast<std::size_t>(s)]; }
    [[nodiscard]] std::uint64_t count(Receiver receiver, Shadow s) const {
        return shadow[static_cast<std::size_t>(receiver)][static_cast<std::size_t>(s)];
    }
    /// Returns the number of pixels that show the wrong sphere, no sphere where there is one, a sphere where there is
    /// none, or NaN.
    [[nodiscard]] std::uint64_t wrong_pixel_count() const;
    /// Returns the number of shadow decisions that differ from the truth, without shadows by the point's own sphere.
    [[nodiscard]] std::uint64_t flipped_shadow_count() const;
    /// Returns the number of pixels whose content, shadow or colour is not proved.
    [[nodiscard]] std::uint64_t unresolved_count() const;
};

/// Lists the fields for shards. The stage and its rule are those of the study, and are left out.
template <class Archive>
void fields(Archive& archive, RenderSummary& whole) {
    auto& [stage, rule, pixels, seen, shadow, facing_away_count, truly_shadowed_point_count, lit_in_true_shadow_count,
           changed_pixel_count, unresolved_colour_count, nan_colour_count, colour_error, normal_angle, residual] =
        whole;
    archive(pixels, seen, shadow, facing_away_count, truly_shadowed_point_count, lit_in_true_shadow_count,
            changed_pixel_count, unresolved_colour_count, nan_colour_count, colour_error, normal_angle, residual);
}

/// Adds a band to the summary of one stage, pixel by pixel from the top. `stage_index` is the index of the stage in the
/// study. `appearance` holds the scene's paint in binary64.
void add_to_summary(const RenderBand& band, std::size_t stage_index, const StoredAppearance<double>& appearance,
                    RenderSummary& summary);

/// Inputs of one format on a band.
struct FormatRenderInputs {
    truth::FormatInputs geometry;
    StoredAppearance<double> appearance;
    std::vector<Vec<double>> points;  ///< points of the pixels in the plane z = 0; empty for other cameras
};

/// Inputs that all forms share on a band.
struct SharedRenderInputs {
    const truth::Band& band;
    std::vector<TruePixel> true_pixels;
    std::map<std::string, FormatRenderInputs> inputs;  ///< by the name of the format
    StoredAppearance<double> appearance;               ///< in binary64
};

/// A study, see measure/study/study.hpp. The summary of a row has one element for each stage.
struct RenderStudy {
    using Band = RenderBand;
    using Summary = std::vector<RenderSummary>;
    static constexpr int pixels_per_band = 32768;

    const scene::file::Scene& scene;         ///< a scene of spheres
    std::vector<scene::file::Stage> stages;  ///< in rising order, only stages that the scene asks for
    std::vector<evaluate::TestedForm> tested_forms;
    PictureLimit limit{};
    shard::Share share = {};
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    void require() const {}
    [[nodiscard]] Summary begin(std::size_t form_index) const;
    [[nodiscard]] SharedRenderInputs prepare(const truth::Band& band) const;
    RenderBand measure(const SharedRenderInputs& shared, std::size_t form_index, Summary& summary) const;
};

}  // namespace lostbits::measure::render
