#include "measure/offset/along.hpp"

#include <cmath>

#include "number/error.hpp"
#include "number/real.hpp"
#include "scene/file/stretch.hpp"

namespace lostbits::measure::offset {

using scene::file::Camera;
using scene::file::Scene;

std::vector<double> factors_along(SceneAxis a) {
    struct Exponents {
        int from, to, step;
    };
    constexpr std::array<Exponents, 3> exponents{{{0, 13, 1}, {-12, 24, 2}, {-2, 22, 2}}};  // distance, radius, world
    const auto& [from, to, step] = exponents[static_cast<std::size_t>(a)];
    std::vector<double> factors;
    for (int k = from; k <= to; k += step) factors.push_back(std::ldexp(1.0, k));
    return factors;
}

Scene moved_along(const Scene& scene, SceneAxis a, double k) {
    if (scene.flake || scene.camera.kind == Camera::Kind::pixel_plane)
        throw InputError("--along: scene " + scene.id +
                         (scene.flake ? " has a [sphereflake], whose numbers are fixed"
                                      : " has a camera with its pixels in the plane z = 0, which cannot move") +
                         "; try another scene");
    constexpr int most_columns = 48;
    Scene s = scene;
    const Real scale(k);
    if (s.width > most_columns) {
        s.height = std::max(1, s.height * most_columns / s.width);
        s.width = most_columns;
    }
    switch (a) {
        case SceneAxis::distance: {
            auto far = scene::file::farther(std::move(s), scale);
            if (!far)
                throw InputError("--along distance: the middle of the primitives of scene " + scene.id +
                                 " lies behind its camera; try another scene");
            return std::move(*far);
        }
        case SceneAxis::radius: return scene::file::enlarged(std::move(s), scale);
        case SceneAxis::world: return scene::file::moved(std::move(s), scale * scene::file::offset_direction());
    }
    return s;
}

}  // namespace lostbits::measure::offset
