#include "measure/offset/along.hpp"

#include <cmath>

#include "number/error.hpp"
#include "number/real.hpp"
#include "scene/file/stretch.hpp"

namespace lostbits::measure::offset {

using scene::file::Camera;
using scene::file::Scene;

std::vector<double> factors_along(SceneAxis axis) {
    struct Exponents {
        int first, last, step;
    };
    constexpr std::array<Exponents, 3> exponents{{{0, 13, 1}, {-12, 24, 2}, {-2, 22, 2}}};  // distance, radius, world
    const auto& [first, last, step] = exponents[static_cast<std::size_t>(axis)];
    std::vector<double> factors;
    for (int k = first; k <= last; k += step) factors.push_back(std::ldexp(1.0, k));
    return factors;
}

namespace {

/// Throws InputError for a scene whose primitives or camera cannot be moved.
void require_movable(const Scene& scene) {
    if (!scene.flake && scene.camera.kind != Camera::Kind::pixel_plane) return;
    throw InputError("--along: scene " + scene.id +
                     (scene.flake ? " has a [sphereflake], whose numbers are fixed"
                                  : " has a camera with its pixels in the plane z = 0, which cannot move") +
                     "; try another scene");
}

/// Reduces the picture to 48 columns, with the same ratio of its sides.
void reduce_picture(Scene& scene) {
    constexpr int max_columns = 48;
    if (scene.width <= max_columns) return;
    scene.height = std::max(1, scene.height * max_columns / scene.width);
    scene.width = max_columns;
}

}  // namespace

Scene move_along(const Scene& scene, SceneAxis axis, double factor) {
    require_movable(scene);
    Scene moved_scene = scene;
    reduce_picture(moved_scene);
    const Real scale(factor);
    switch (axis) {
        case SceneAxis::distance: {
            auto farther_scene = scene::file::move_farther(std::move(moved_scene), scale);
            if (!farther_scene)
                throw InputError("--along distance: the middle of the primitives of scene " + scene.id +
                                 " lies behind its camera; try another scene");
            return std::move(*farther_scene);
        }
        case SceneAxis::radius: return scene::file::enlarge(std::move(moved_scene), scale);
        case SceneAxis::world:
            return scene::file::translate(std::move(moved_scene), scale * scene::file::offset_direction());
    }
    return moved_scene;
}

}  // namespace lostbits::measure::offset
