// Light and paint of a scene as stored numbers, rounded in the same way as its geometry.
#pragma once

#include <vector>

#include "measure/render/shade.hpp"
#include "number/format.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::measure::render {

/// Light and paint in numbers of type S. S is double for shared inputs (each number rounded once to binary32) and for
/// the numbers of a format. S is Real for own inputs.
template <class S>
struct StoredAppearance {
    Vec<S> background{S(0), S(0), S(0)};
    Vec<S> light{S(0), S(0), S(0)};  ///< meaningless where the scene has no light
    S shadow_on_background{S(1)};    ///< factor
    S epsilon{S(0)};
    std::vector<Paint<S>> paints;  ///< one per sphere
};

template <class S, class Lift>
auto lift_numbers(const Vec<S>& v, Lift lift) {
    using T = std::decay_t<std::invoke_result_t<Lift, const S&>>;
    return Vec<T>(lift(v.x), lift(v.y), lift(v.z));
}

template <class S, class Lift>
auto lift_numbers(const Paint<S>& p, Lift lift) {
    using T = std::decay_t<std::invoke_result_t<Lift, const S&>>;
    return Paint<T>{
        lift_numbers(p.colour, lift), lift(p.ambient), lift(p.diffuse), lift(p.specular), p.exponent, p.is_shiny};
}

/// Converts each number by `lift`. A shiny sphere stays shiny even if a format rounds its ks to 0; its highlight is
/// then 0.
template <class S, class Lift>
auto lift_numbers(const StoredAppearance<S>& appearance, Lift lift) {
    using T = std::decay_t<std::invoke_result_t<Lift, const S&>>;
    StoredAppearance<T> result{lift_numbers(appearance.background, lift),
                               lift_numbers(appearance.light, lift),
                               lift(appearance.shadow_on_background),
                               lift(appearance.epsilon),
                               {}};
    for (const Paint<S>& p : appearance.paints) result.paints.push_back(lift_numbers(p, lift));
    return result;
}

/// Returns light and paint in ideal numbers.
StoredAppearance<Real> make_own_appearance(const scene::file::Appearance& appearance);
/// Returns light and paint with each number rounded once to binary32: the inputs that all formats share.
StoredAppearance<double> make_shared_appearance(const scene::file::Appearance& appearance);
/// Returns light and paint as a form in the format receives them, like `scene::rays::input_rays`.
StoredAppearance<double> make_input_appearance(const scene::file::Scene& scene, const FloatFormat& format);

/// Returns the points of the pixels of scanlines [y0, y1) in the plane z = 0, or nothing if the camera does not have
/// its pixels there. S is as in `StoredAppearance`.
template <class S>
std::vector<Vec<S>> make_pixel_points(const scene::file::Scene& scene, int y0, int y1);
/// Returns these points as a form in the format receives them.
std::vector<Vec<double>> make_input_pixel_points(const scene::file::Scene& scene, int y0, int y1,
                                                 const FloatFormat& format);

}  // namespace lostbits::measure::render
