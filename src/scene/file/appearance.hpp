// What a scene looks like: colours, a light, and how shadows are cast. A map or a sweep does not look at it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "number/real.hpp"
#include "scene/toml/toml_reader.hpp"
#include "shapes/solid.hpp"

namespace lostbits::scene::file {

/// The stages of a picture, each on top of the one before (the steps of the course notes Ray-Casting Formulas).
enum class Stage : std::uint8_t { visible, diffuse, shadows, phong };
inline constexpr std::array<std::string_view, 4> stage_names{"visible", "diffuse", "shadows", "phong"};
inline std::string_view name_of(Stage stage) { return stage_names[static_cast<std::size_t>(stage)]; }

/// A sphere's paint. Colours are display numbers, 0 to 1 a channel: 255 times the number, rounded, is the byte of the
/// picture, with no gamma in between. Coefficients are not negative.
struct Material {
    Vec<Real> colour{Real(1), Real(1), Real(1)};
    Real ambient = Real(1) / 5;  ///< ka; 0.2 and 0.8 are what the source says to try
    Real diffuse = Real(4) / 5;  ///< kd
    Real specular = Real(0);     ///< ks; shiny where above 0
    int exponent = 1;            ///< n of (H·N)ⁿ
};

/// How shadows are cast: a ray from the point to the light, blocked by what it meets before the light.
struct ShadowRule {
    /// Where a shadow ray starts if it is also tested against the sphere that it leaves: at the point as computed,
    /// moved along the normal by `epsilon` world units, or by `ulps` units in the last place of its largest coordinate.
    enum class Offset : std::uint8_t { none, epsilon, ulp };

    bool half_diffuse = false;      ///< in shadow keep half of the diffuse light, instead of ambient light alone
    Real background = Real(1) / 2;  ///< what is left of the background's colour in shadow
    bool own = false;               ///< also test the sphere that the point lies on
    Offset offset = Offset::none;
    Real epsilon = Real(0);
    int ulps = 0;
};

/// What pictures are made of.
inline constexpr Shape rendered_shape = std::ranges::find(shape_rows, true, &ShapeRow::shaded)->shape;

struct Appearance {
    Vec<Real> background{Real(0), Real(0), Real(0)};
    std::optional<Vec<Real>> light;     ///< one point light
    std::optional<ShadowRule> shadows;  ///< absent: nothing casts any
    Material base;                      ///< what a sphere is that says nothing else
    std::vector<Material> materials;    ///< one per solid of the rendered shape, in their order

    /// Whether the scene asks for what this stage adds: a light for `diffuse`, `[shadows]`, a ks above 0 for `phong`.
    [[nodiscard]] bool asks_for(Stage stage) const;
    /// The last stage that it asks for, and that no later than `stage`.
    [[nodiscard]] Stage last_up_to(Stage stage) const;
    [[nodiscard]] Stage furthest() const { return last_up_to(Stage::phong); }
};

}  // namespace lostbits::scene::file
