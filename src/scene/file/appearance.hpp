// Appearance of a scene: colours, a light, and the rule for shadows. Maps and sweeps do not use the appearance.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "number/real.hpp"
#include "scene/toml/toml_reader.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::scene::file {

/// The stages of a picture, each on top of the previous stage (the steps of the course notes Ray-Casting Formulas).
enum class Stage : std::uint8_t { visible, diffuse, shadows, phong };
inline constexpr std::array<std::string_view, 4> stage_names{"visible", "diffuse", "shadows", "phong"};
inline std::string_view name_of(Stage stage) { return stage_names[static_cast<std::size_t>(stage)]; }

/// A sphere's paint. Colours are display numbers, 0 to 1 for each channel. The byte of the picture is 255 times the
/// number, rounded, with no gamma in between. Coefficients are not negative.
struct Material {
    Vec<Real> colour{Real(1), Real(1), Real(1)};
    Real ambient = Real(1) / 5;  ///< ka; the source suggests 0.2 and 0.8 for the first try
    Real diffuse = Real(4) / 5;  ///< kd
    Real specular = Real(0);     ///< ks; shiny if above 0
    int exponent = 1;            ///< n of (H·N)ⁿ
};

/// Rule for shadows: a point is in shadow if a ray from the point to the light meets something before the light.
struct ShadowRule {
    /// The start of a shadow ray that is also tested against the sphere that it leaves: the point as computed, moved
    /// along the normal by `epsilon` world units, or by `ulps` units in the last place of its largest coordinate.
    enum class ShadowOffset : std::uint8_t { none, epsilon, ulp };

    bool keeps_half_diffuse = false;  ///< true: half of the diffuse light remains in shadow; false: only ambient light
    Real background = Real(1) / 2;    ///< factor on the colour of the background in shadow
    bool tests_departed_sphere = false;  ///< true: the sphere that the point lies on is also tested
    ShadowOffset offset = ShadowOffset::none;
    Real epsilon = Real(0);
    int ulps = 0;
};

/// The shape that pictures can show.
inline constexpr Shape rendered_shape = std::ranges::find(shape_rows, true, &ShapeRow::has_shading_normal)->shape;

/// The colours, the light and the shadows of a scene.
struct Appearance {
    Vec<Real> background{Real(0), Real(0), Real(0)};
    std::optional<Vec<Real>> light;     ///< one point light
    std::optional<ShadowRule> shadows;  ///< absent: no shadows
    Material base;                      ///< paint of a sphere that has no paint of its own
    std::vector<Material> materials;    ///< one per primitive of the rendered shape, in their order

    /// True if the scene has what this stage adds: a light for `diffuse`, `[shadows]` for `shadows`, a ks above 0 for
    /// `phong`.
    [[nodiscard]] bool has_stage(Stage stage) const;
    /// The last stage, no later than `stage`, for which `has_stage` is true.
    [[nodiscard]] Stage last_stage_up_to(Stage stage) const;
    [[nodiscard]] Stage last_stage() const { return last_stage_up_to(Stage::phong); }
};

}  // namespace lostbits::scene::file
