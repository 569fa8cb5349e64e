// Light and paint of a scene as stored numbers, rounded as its geometry is.
#pragma once

#include <vector>

#include "measure/picture/shade.hpp"
#include "number/format.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::measure::picture {

/// S is double (shared inputs: every number rounded once to binary32; or any format's numbers) or Real (own inputs).
template <class S>
struct StoredAppearance {
    Vec<S> background{S(0), S(0), S(0)};
    Vec<S> light{S(0), S(0), S(0)};  ///< meaningless where the scene has no light
    S shadow_on_background{S(1)};    ///< factor
    S epsilon{S(0)};
    std::vector<Paint<S>> paints;  ///< one per sphere
};

template <class S, class Lift>
auto lifted(const Vec<S>& v, Lift lift) {
    using T = std::decay_t<std::invoke_result_t<Lift, const S&>>;
    return Vec<T>(lift(v.x), lift(v.y), lift(v.z));
}

template <class S, class Lift>
auto lifted(const Paint<S>& p, Lift lift) {
    using T = std::decay_t<std::invoke_result_t<Lift, const S&>>;
    return Paint<T>{lifted(p.colour, lift), lift(p.ambient), lift(p.diffuse), lift(p.specular), p.exponent, p.shiny};
}

/// Converts each number by `lift`. A shiny sphere stays shiny: a ks that a format rounds to 0 adds nothing by itself.
template <class S, class Lift>
auto lifted(const StoredAppearance<S>& look, Lift lift) {
    using T = std::decay_t<std::invoke_result_t<Lift, const S&>>;
    StoredAppearance<T> to{lifted(look.background, lift),
                           lifted(look.light, lift),
                           lift(look.shadow_on_background),
                           lift(look.epsilon),
                           {}};
    for (const Paint<S>& p : look.paints) to.paints.push_back(lifted(p, lift));
    return to;
}

/// Light and paint in ideal numbers.
StoredAppearance<Real> own_appearance(const scene::file::Appearance& appearance);
/// Light and paint with each number rounded once to binary32: the inputs that all formats share.
StoredAppearance<double> shared_appearance(const scene::file::Appearance& appearance);
/// Light and paint as a form in format F is given them, like `scene::rays::input_rays`.
StoredAppearance<double> input_appearance(const scene::file::Scene& scene, const FloatFormat& f);

/// Points of the pixels of rows [y0, y1) in the plane z = 0, where the camera has them there; S as above.
template <class S>
std::vector<Vec<S>> pixel_points(const scene::file::Scene& scene, int y0, int y1);
/// Same points as a form in format F is given them.
std::vector<Vec<double>> input_pixel_points(const scene::file::Scene& scene, int y0, int y1, const FloatFormat& f);

}  // namespace lostbits::measure::picture
