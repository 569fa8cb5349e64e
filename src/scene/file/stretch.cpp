#include "scene/file/stretch.hpp"

#include <algorithm>
#include <memory>

#include <mpfr.h>

namespace lostbits::scene::file {

namespace {

Real pi() {
    Real value;
    mpfr_const_pi(value.backend().data(), MPFR_RNDN);
    return value;
}

/// Applies `change` to every primitive. It may return nothing; then this returns false.
template <class Change>
bool change_primitives(Scene& scene, const Change& change) {
    for (Primitive<Real>& primitive : scene.listed) {
        std::optional<Primitive<Real>> to = change(primitive);
        if (!to) return false;
        primitive = *std::move(to);
    }
    return true;
}

}  // namespace

Real half_tangent(const Real& degrees) { return tan(degrees * pi() / 360); }
Real degrees_of(const Real& half_tangent) { return atan(half_tangent) * 360 / pi(); }

Vec<Real> middle_of(const Primitive<Real>& primitive) {
    const Vec<Real> middle = visit(primitive, [](const auto& shape) { return shape.middle(); });
    if (!primitive.placed) return middle;
    // The point that the stored inverse M⁻¹ transforms to the middle.
    if (primitive.placed->is_inverse)
        return point_in_object(middle, Placement<Real>{primitive.placed->matrix, false, primitive.placed->orientation});
    return primitive.placed->map().point(middle);
}

Real size_of(const Primitive<Real>& primitive) {
    const Real size = visit(primitive, [](const auto& shape) { return shape.half_extent(); });
    if (!primitive.placed) return size;
    const Real times = cbrt(abs(primitive.placed->map().determinant()));
    return primitive.placed->is_inverse ? Real(size / times) : Real(size * times);
}

namespace {

/// A primitive under the matrix of the meshes whose corners are all at a point; what happens to a vertex happens to it.
Primitive<Real> at_vertex(const Scene& scene, const Vec<double>& v) {
    Primitive<double> one(scene.mesh->triangle(0));
    for (std::size_t k = 0; k < one.used().size(); k += 3) one.set_point(k, v);
    one.placed = scene.mesh_placed;
    return transformed(one, [](double x) { return Real(x); });
}

/// The mean of the middles of all triangles of meshes. A matrix transforms the mean as it transforms each.
Vec<Real> middle_of_mesh(const Scene& scene) {
    Vec<double> sum(0, 0, 0);
    for (std::size_t i = 0; i < scene.mesh->faces.size(); ++i) sum = sum + scene.mesh->triangle(i).middle();
    const Vec<double> middle = sum / static_cast<double>(scene.mesh->faces.size());
    return middle_of(at_vertex(scene, middle));
}

/// Applies a change to the matrix of the meshes, or if they have none to their vertices, rounded to doubles.
template <class Change>
void change_mesh(Scene& scene, const Change& change) {
    if (!scene.mesh) return;
    const auto as_double = [](const Real& x) { return static_cast<double>(x); };
    if (scene.mesh_placed) {
        scene.mesh_placed = transformed(*change(at_vertex(scene, {0, 0, 0})).placed, as_double);
        return;
    }
    const auto mesh = std::make_shared<triangle::Mesh>(*scene.mesh);
    for (Vec<double>& v : mesh->vertices) {
        const Vec<Real> to = change(at_vertex(scene, v)).point(0);
        v = Vec<double>(as_double(to.x), as_double(to.y), as_double(to.z));
    }
    scene.mesh = mesh;
}

}  // namespace

Vec<Real> middle_of(const Scene& scene) {
    Vec<Real> sum(Real(0), Real(0), Real(0));
    int count = 0;
    const auto take = [&](const Vec<Real>& v) {
        sum = sum + v;
        ++count;
    };
    for (const Primitive<Real>& primitive : scene.listed) take(middle_of(primitive));
    if (scene.flake) {
        const Vec<double>& c = scene.flake->centre;
        take({Real(c.x), Real(c.y), Real(c.z)});
    }
    if (scene.mesh) {
        const auto faces = static_cast<int>(scene.mesh->faces.size());
        sum = sum + Real(faces) * middle_of_mesh(scene);
        count += faces;
    }
    return (Real(1) / Real(std::max(count, 1))) * sum;
}

Vec<Real> offset_direction() { return {Real(1), Real(11) / 16, -Real(7) / 16}; }

Primitive<Real> moved(const Primitive<Real>& primitive, const Vec<Real>& by) {
    Primitive<Real> to = primitive;
    if (primitive.placed) {
        const Affine<Real> m = primitive.placed->map();
        const Vec<Real> shift = primitive.placed->is_inverse ? Vec<Real>(-m.linear(by)) : by;
        for (int i = 0; i < 3; ++i) to.placed->matrix[static_cast<std::size_t>(4 * i + 3)] += shift[i];
        return to;
    }
    for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
        if (key.kind == Key::Kind::point) to.set_point(k, to.point(k) + by);
    });
    return to;
}

std::optional<Primitive<Real>> grown(const Primitive<Real>& primitive, const Vec<Real>& still, const Real& k) {
    const Vec<Real> there = primitive.placed ? point_in_object(still, *primitive.placed) : still;
    auto to =
        visit(primitive, [&](const auto& shape) -> std::optional<Primitive<Real>> { return shape.grown(there, k); });
    if (to) to->placed = primitive.placed;
    return to;
}

namespace {

/// Multiplies every length of the world by k.
Primitive<Real> enlarged(const Primitive<Real>& primitive, const Real& k) {
    if (!primitive.placed) return transformed(primitive, [&k](const Real& x) { return Real(k * x); });
    Primitive<Real> to = primitive;
    for (std::size_t i = 0; i < to.placed->matrix.size(); ++i) {
        if (!to.placed->is_inverse) to.placed->matrix[i] *= k;
        else if (i % 4 != 3) to.placed->matrix[i] /= k;
    }
    return to;
}

}  // namespace

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
    change_primitives(scene, [&k](const Primitive<Real>& primitive) { return std::optional(enlarged(primitive, k)); });
    change_mesh(scene, [&k](const Primitive<Real>& triangle) { return enlarged(triangle, k); });
    scene.camera.eye = place(scene.camera.eye);
    scene.camera.look_at = place(scene.camera.look_at);
    scene.camera.width = k * scene.camera.width;
    if (scene.appearance.light) scene.appearance.light = place(*scene.appearance.light);
    return scene;
}

std::optional<Scene> grown(Scene scene, const Real& k) {
    if (scene.mesh) return std::nullopt;  // triangles that grow by themselves are no mesh
    const Vec<Real> eye = scene.camera.eye;
    if (!change_primitives(scene, [&](const Primitive<Real>& primitive) { return grown(primitive, eye, k); }))
        return std::nullopt;
    return scene;
}

Scene moved(Scene scene, const Vec<Real>& by) {
    change_primitives(scene, [&by](const Primitive<Real>& primitive) { return std::optional(moved(primitive, by)); });
    change_mesh(scene, [&by](const Primitive<Real>& triangle) { return moved(triangle, by); });
    scene.camera.eye = scene.camera.eye + by;
    scene.camera.look_at = scene.camera.look_at + by;
    if (scene.flake)
        for (int i = 0; i < 3; ++i) scene.flake->centre[i] += static_cast<double>(by[i]);
    if (scene.appearance.light) scene.appearance.light = *scene.appearance.light + by;
    return scene;
}

}  // namespace lostbits::scene::file
