#include "measure/choice/room.hpp"

#include <algorithm>
#include <cmath>

#include <mpfr.h>

#include "measure/truth/band.hpp"

namespace lostbits::measure::choice {

using scene::file::Camera;
using scene::file::Scene;

namespace {

double in_double(const Real& x) { return static_cast<double>(x); }

Vec<Real> middle_of(const Scene& scene) {
    Vec<Real> sum(Real(0), Real(0), Real(0));
    int count = 0;
    const auto take = [&](const Vec<Real>& v) {
        sum = sum + v;
        ++count;
    };
    for (const auto& sphere : scene.spheres) take(sphere.centre);
    for (const auto& box : scene.boxes) take(Real(0.5) * (box.lo + box.hi));
    if (scene.flake) {
        const Vec<double>& c = scene.flake->centre;
        take({Real(c.x), Real(c.y), Real(c.z)});
    }
    return (Real(1) / Real(std::max(count, 1))) * sum;
}

/// tan(degrees/2), and back.
Real half_tangent(const Real& degrees) {
    Real pi;
    mpfr_const_pi(pi.backend().data(), MPFR_RNDN);
    return tan(degrees * pi / 360);
}
Real degrees_of(const Real& half_tangent) {
    Real pi;
    mpfr_const_pi(pi.backend().data(), MPFR_RNDN);
    return atan(half_tangent) * 360 / pi;
}

std::optional<Stretched> farther(Scene scene, const Real& k) {
    Camera& camera = scene.camera;
    const Vec<Real> view = camera.look_at - camera.eye;
    const Real share = dot(middle_of(scene) - camera.eye, view) / dot(view, view);
    if (share <= 0) return std::nullopt;
    const Vec<Real> back = ((k - 1) * share) * view;
    camera.eye = camera.eye - back;
    camera.look_at = camera.look_at - back;
    if (camera.kind == Camera::Kind::pinhole) camera.fov_deg = degrees_of(half_tangent(camera.fov_deg) / k);
    return Stretched{std::move(scene), in_double(k * share * length(view))};
}

std::optional<Stretched> larger(Scene scene, const Real& k) {
    const Vec<Real>& eye = scene.camera.eye;
    Real largest(0);
    for (auto& sphere : scene.spheres) {
        const Vec<Real> towards = eye - sphere.centre;
        const Real distance = length(towards);
        if (distance == 0) return std::nullopt;
        sphere.centre = sphere.centre - ((k - 1) * sphere.radius / distance) * towards;
        sphere.radius = k * sphere.radius;
        largest = std::max(largest, sphere.radius);
    }
    for (auto& box : scene.boxes) {
        for (int i = 0; i < 3; ++i) {
            const Real still = std::clamp(eye[i], box.lo[i], box.hi[i]);
            box.lo[i] = still + k * (box.lo[i] - still);
            box.hi[i] = still + k * (box.hi[i] - still);
            largest = std::max(largest, Real((box.hi[i] - box.lo[i]) / 2));
        }
    }
    return Stretched{std::move(scene), in_double(largest)};
}

Stretched elsewhere(Scene scene, const Real& k) {
    const Real away = (k - 1) * length(middle_of(scene) - scene.camera.eye), unit = away / sqrt(Real(14));
    const Vec<Real> by(3 * unit, 2 * unit, -unit);
    scene.camera.eye = scene.camera.eye + by;
    scene.camera.look_at = scene.camera.look_at + by;
    for (auto& sphere : scene.spheres) sphere.centre = sphere.centre + by;
    for (auto& box : scene.boxes) {
        box.lo = box.lo + by;
        box.hi = box.hi + by;
    }
    if (scene.flake)
        for (int i = 0; i < 3; ++i) scene.flake->centre[i] += in_double(by[i]);
    return {std::move(scene), in_double(away)};
}

std::optional<Stretched> wider(Scene scene, const Real& k) {
    if (scene.camera.kind != Camera::Kind::pinhole) return std::nullopt;
    scene.camera.fov_deg = degrees_of(k * half_tangent(scene.camera.fov_deg));
    const double degrees = in_double(scene.camera.fov_deg);
    if (degrees > 170) return std::nullopt;
    return Stretched{std::move(scene), degrees};
}

}  // namespace

std::optional<Stretched> stretched(const Scene& scene, Growth way, double factor) {
    const bool plane = scene.camera.kind == Camera::Kind::pixel_plane;
    const Real k(factor);
    switch (way) {
        case Growth::distance: return plane ? std::nullopt : farther(scene, k);
        case Growth::radius: return scene.flake ? std::nullopt : larger(scene, k);
        case Growth::offset: return plane ? std::nullopt : std::optional(elsewhere(scene, k));
        case Growth::view: return wider(scene, k);
    }
    return std::nullopt;
}

namespace {

/// Whether what is stored of the scene is still the scene: nine rays of ten have the same decision, and t to a tenth.
bool is_as_meant(const Scene& scene, truth::TruthLimit limit) {
    if (scene.inputs == scene::file::Inputs::own) return true;
    Scene ideal = scene;
    ideal.inputs = scene::file::Inputs::own;
    const truth::Band stored(scene, 0, scene.height, limit), meant(ideal, 0, ideal.height, limit);
    const auto t_of = [](const truth::Band& band, std::size_t i) {
        return band.truth(i, {}).is_hit() ? band.rounded_truth(i, binary64, intersect::Direction::any, {}) : HUGE_VAL;
    };
    std::size_t other = 0;
    for (std::size_t i = 0; i < meant.pixels(); ++i) {
        const double is = t_of(stored, i), should_be = t_of(meant, i);
        other += is != should_be && !(std::fabs(is - should_be) <= 0.1 * should_be);
    }
    return 10 * other <= meant.pixels();
}

/// The search along one way.
class Search {
public:
    Search(const ChoiceRequest& request, const map::MapRow& row, int pixels, Growth way)
        : request_(request), thin_(thinned(*request.scene, pixels)) {
        request_.rows = {row};
        room_.way = way;
    }

    /// Nothing where the way means nothing for the scene.
    std::optional<Room> run() {
        constexpr double most = 0x1p64, close = 1.02;
        if (!stretched(thin_, room_.way, 1)) return std::nullopt;
        double next = 1;
        while (next <= most && try_at(next)) next *= 2;
        if (room_.end == End::none || room_.holds == 0) return room_;
        while (room_.beyond / room_.holds > close) try_at(std::sqrt(room_.holds * room_.beyond));
        return room_;
    }

private:
    /// Whether the wish holds at that factor; notes what it finds.
    bool try_at(double factor) {
        const auto there = stretched(thin_, room_.way, factor);
        if (!there) return false;
        request_.scene = &there->scene;
        const Worth worth = worth_of(request_).front();
        const bool meets = worth.meets(request_.wish) || (worth.hits == 0 && worth.decides(request_.wish));
        const End end = !is_as_meant(there->scene, request_.limit) ? End::other_scene
                        : !meets                                   ? End::fails
                        : worth.hits == 0                          ? End::nothing_hit
                                                                   : End::none;
        if (end == End::none) {
            room_.holds = factor;
            room_.value = there->value;
            return true;
        }
        room_.end = end;
        room_.beyond = factor;
        room_.broken = end == End::fails ? worth : Worth{};
        return false;
    }

    ChoiceRequest request_;
    Scene thin_;
    Room room_{};
};

}  // namespace

std::vector<Room> rooms_of(const ChoiceRequest& request, const map::MapRow& row, int pixels) {
    std::vector<Room> all;
    for (const Growth way : growths) {
        if (const auto room = Search(request, row, pixels, way).run()) all.push_back(*room);
    }
    return all;
}

}  // namespace lostbits::measure::choice
