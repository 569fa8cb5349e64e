#include "measure/render/stored_appearance.hpp"

#include "number/rounded.hpp"
#include "scene/rays/camera.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::measure::render {

using scene::file::Scene;

StoredAppearance<Real> make_own_appearance(const scene::file::Appearance& appearance) {
    StoredAppearance<Real> stored;
    stored.background = appearance.background;
    if (appearance.light) stored.light = *appearance.light;
    if (appearance.shadows) {
        stored.shadow_on_background = appearance.shadows->background;
        stored.epsilon = appearance.shadows->epsilon;
    }
    for (const scene::file::Material& m : appearance.materials)
        stored.paints.push_back({m.colour, m.ambient, m.diffuse, m.specular, m.exponent, m.specular > 0});
    return stored;
}

StoredAppearance<double> make_shared_appearance(const scene::file::Appearance& appearance) {
    return lift_numbers(make_own_appearance(appearance),
                        [](const Real& x) { return scene::toml::round_to_format(x, binary32); });
}

StoredAppearance<double> make_input_appearance(const Scene& scene, const FloatFormat& format) {
    if (scene.inputs == scene::file::InputRounding::own)
        return lift_numbers(make_own_appearance(scene.appearance),
                            [&format](const Real& x) { return scene::toml::round_to_format(x, format); });
    return lift_numbers(make_shared_appearance(scene.appearance),
                        [&format](double x) { return rounding::to_format(x, 0, format); });
}

template <class S>
std::vector<Vec<S>> make_pixel_points(const Scene& scene, int y0, int y1) {
    std::vector<Vec<S>> points;
    if (scene.camera.kind != scene::file::Camera::Kind::pixel_plane) return points;
    const auto frame = scene::rays::make_frame<S>(scene);
    const auto stored = [](const S& x) {
        if constexpr (std::is_same_v<S, double>) return rounding::to_format(x, 0, binary32);
        else return x;
    };
    for (int y = y0; y < y1; ++y) {
        for (int x = 0; x < scene.width; ++x)
            points.push_back(lift_numbers(scene::rays::pixel_point(frame, x, y), stored));
    }
    return points;
}

template std::vector<Vec<double>> make_pixel_points<double>(const Scene&, int, int);
template std::vector<Vec<Real>> make_pixel_points<Real>(const Scene&, int, int);

std::vector<Vec<double>> make_input_pixel_points(const Scene& scene, int y0, int y1, const FloatFormat& format) {
    std::vector<Vec<double>> points;
    if (scene.inputs == scene::file::InputRounding::own) {
        for (const auto& p : make_pixel_points<Real>(scene, y0, y1))
            points.push_back(
                lift_numbers(p, [&format](const Real& x) { return scene::toml::round_to_format(x, format); }));
    } else {
        for (const auto& p : make_pixel_points<double>(scene, y0, y1))
            points.push_back(lift_numbers(p, [&format](double x) { return rounding::to_format(x, 0, format); }));
    }
    return points;
}

}  // namespace lostbits::measure::render
