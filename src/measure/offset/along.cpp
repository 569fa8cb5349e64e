#include "measure/offset/along.hpp"

#include <cmath>

#include "number/error.hpp"

namespace lostbits::measure::offset {

using scene::file::Camera;
using scene::file::Scene;

namespace {

constexpr int most_columns = 48;

/// `place` of every point of the scene and `size` of every length.
template <class Place, class Size>
void change_lengths(Scene& s, const Place& place, const Size& size) {
    for (auto& sphere : s.spheres) sphere = {place(sphere.centre), size(sphere.radius)};
    for (auto& box : s.boxes) box = {place(box.lo), place(box.hi)};
    s.camera.eye = place(s.camera.eye);
    s.camera.look_at = place(s.camera.look_at);
    s.camera.width = size(s.camera.width);
    if (s.appearance.light) s.appearance.light = place(*s.appearance.light);
}

Real narrowed(const Real& fov_deg, const Real& k) {
    const Real half = fov_deg * boost::math::constants::pi<Real>() / 360;
    return atan(Real(tan(half) / k)) * 360 / boost::math::constants::pi<Real>();
}

}  // namespace

std::string_view meaning_of(Along a) {
    switch (a) {
        case Along::distance: return "times as far away, the picture the same";
        case Along::radius: return "times every length of the scene";
        case Along::world: return "everything moved by so many times (1, 0.6875, -0.4375)";
    }
    return "";
}

std::vector<double> steps_along(Along a) {
    constexpr std::array<std::array<int, 3>, 3> ranges{{{0, 13, 1}, {-12, 24, 2}, {-2, 22, 2}}};
    const auto& [from, to, by] = ranges[static_cast<std::size_t>(a)];
    std::vector<double> steps;
    for (int k = from; k <= to; k += by) steps.push_back(std::ldexp(1.0, k));
    return steps;
}

Scene moved_along(const Scene& scene, Along a, double k) {
    if (scene.flake || scene.camera.kind == Camera::Kind::pixel_plane)
        throw InputError("--along: scene " + scene.id +
                         (scene.flake ? " has a [sphereflake], whose numbers are fixed"
                                      : " has a camera with its pixels in the plane z = 0, which cannot move") +
                         "; try another scene");
    Scene s = scene;
    const Real scale(k);
    if (s.width > most_columns) {
        s.height = std::max(1, s.height * most_columns / s.width);
        s.width = most_columns;
    }
    switch (a) {
        case Along::distance:
            s.camera.eye = s.camera.look_at + scale * (scene.camera.eye - scene.camera.look_at);
            if (s.camera.kind == Camera::Kind::pinhole) s.camera.fov_deg = narrowed(s.camera.fov_deg, scale);
            break;
        case Along::radius:
            change_lengths(
                s, [&](const Vec<Real>& p) { return Vec<Real>(scale * p.x, scale * p.y, scale * p.z); },
                [&](const Real& x) { return Real(scale * x); });
            break;
        case Along::world: {
            const Vec<Real> by(scale, scale * Real(11) / 16, -scale * Real(7) / 16);
            change_lengths(
                s, [&](const Vec<Real>& p) { return Vec<Real>(p + by); }, [](const Real& x) { return x; });
            break;
        }
    }
    return s;
}

}  // namespace lostbits::measure::offset
