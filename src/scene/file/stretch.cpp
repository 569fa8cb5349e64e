#include "scene/file/stretch.hpp"

#include <algorithm>

#include <mpfr.h>

namespace lostbits::scene::file {

namespace {

Real pi() {
    Real value;
    mpfr_const_pi(value.backend().data(), MPFR_RNDN);
    return value;
}

/// Every solid through `change`, which may find that there is none.
template <class Change>
bool change_solids(Scene& scene, const Change& change) {
    for (SphereSpec& sphere : scene.spheres) {
        const std::optional<Solid<Real>> to = change(Solid<Real>(sphere));
        if (!to) return false;
        sphere = to->sphere();
    }
    for (BoxSpec& box : scene.boxes) {
        const std::optional<Solid<Real>> to = change(Solid<Real>(box));
        if (!to) return false;
        box = to->box();
    }
    return true;
}

}  // namespace

Real half_tangent(const Real& degrees) { return tan(degrees * pi() / 360); }
Real degrees_of(const Real& half_tangent) { return atan(half_tangent) * 360 / pi(); }

Vec<Real> middle_of(const Solid<Real>& solid) {
    if (solid.shape == Shape::sphere) return solid.sphere().centre;
    const Box<Real> box = solid.box();
    return Real(0.5) * (box.lo + box.hi);
}

Real size_of(const Solid<Real>& solid) {
    if (solid.shape == Shape::sphere) return solid.numbers[3];
    const Box<Real> box = solid.box();
    Real longest(0);
    for (int i = 0; i < 3; ++i) longest = std::max(longest, Real(box.hi[i] - box.lo[i]));
    return longest / 2;
}

Vec<Real> middle_of(const Scene& scene) {
    Vec<Real> sum(Real(0), Real(0), Real(0));
    int count = 0;
    const auto take = [&](const Vec<Real>& v) {
        sum = sum + v;
        ++count;
    };
    for (const SphereSpec& sphere : scene.spheres) take(sphere.centre);
    for (const BoxSpec& box : scene.boxes) take(middle_of(Solid<Real>(box)));
    if (scene.flake) {
        const Vec<double>& c = scene.flake->centre;
        take({Real(c.x), Real(c.y), Real(c.z)});
    }
    return (Real(1) / Real(std::max(count, 1))) * sum;
}

Vec<Real> offset_direction() { return {Real(1), Real(11) / 16, -Real(7) / 16}; }

Solid<Real> moved(const Solid<Real>& solid, const Vec<Real>& by) {
    Solid<Real> to = solid;
    const std::size_t places = solid.shape == Shape::sphere ? 3 : 6;
    for (std::size_t k = 0; k < places; ++k) to.numbers[k] += by[static_cast<int>(k % 3)];
    return to;
}

std::optional<Solid<Real>> grown(const Solid<Real>& solid, const Vec<Real>& still, const Real& k) {
    if (solid.shape == Shape::sphere) {
        Sphere<Real> sphere = solid.sphere();
        const Vec<Real> towards = still - sphere.centre;
        const Real distance = length(towards);
        if (distance == 0) return std::nullopt;
        sphere.centre = sphere.centre - ((k - 1) * sphere.radius / distance) * towards;
        sphere.radius = k * sphere.radius;
        return sphere;
    }
    Box<Real> box = solid.box();
    for (int i = 0; i < 3; ++i) {
        const Real there = std::clamp(still[i], box.lo[i], box.hi[i]);
        box.lo[i] = there + k * (box.lo[i] - there);
        box.hi[i] = there + k * (box.hi[i] - there);
    }
    return box;
}

Real view_share(const Scene& scene) {
    const Vec<Real> view = scene.camera.look_at - scene.camera.eye;
    return dot(middle_of(scene) - scene.camera.eye, view) / dot(view, view);
}

std::optional<Scene> farther(Scene scene, const Real& k) {
    Camera& camera = scene.camera;
    const Real share = view_share(scene);
    if (share <= 0) return std::nullopt;
    const Vec<Real> back = ((k - 1) * share) * (camera.look_at - camera.eye);
    camera.eye = camera.eye - back;
    camera.look_at = camera.look_at - back;
    if (camera.kind == Camera::Kind::pinhole) camera.fov_deg = degrees_of(half_tangent(camera.fov_deg) / k);
    return scene;
}

Scene enlarged(Scene scene, const Real& k) {
    const auto place = [&k](const Vec<Real>& v) { return Vec<Real>(k * v.x, k * v.y, k * v.z); };
    change_solids(scene, [&k](const Solid<Real>& solid) {
        return std::optional(transformed(solid, [&k](const Real& x) { return Real(k * x); }));
    });
    scene.camera.eye = place(scene.camera.eye);
    scene.camera.look_at = place(scene.camera.look_at);
    scene.camera.width = k * scene.camera.width;
    if (scene.appearance.light) scene.appearance.light = place(*scene.appearance.light);
    return scene;
}

std::optional<Scene> grown(Scene scene, const Real& k) {
    const Vec<Real> eye = scene.camera.eye;
    if (!change_solids(scene, [&](const Solid<Real>& solid) { return grown(solid, eye, k); })) return std::nullopt;
    return scene;
}

Scene moved(Scene scene, const Vec<Real>& by) {
    change_solids(scene, [&by](const Solid<Real>& solid) { return std::optional(moved(solid, by)); });
    scene.camera.eye = scene.camera.eye + by;
    scene.camera.look_at = scene.camera.look_at + by;
    if (scene.flake)
        for (int i = 0; i < 3; ++i) scene.flake->centre[i] += static_cast<double>(by[i]);
    if (scene.appearance.light) scene.appearance.light = *scene.appearance.light + by;
    return scene;
}

}  // namespace lostbits::scene::file
