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

/// Applies `change` to every primitive. Returns false if `change` returns nothing for one of them.
template <class Change>
bool change_primitives(Scene& scene, const Change& change) {
    for (Primitive<Real>& primitive : scene.listed) {
        std::optional<Primitive<Real>> changed = change(primitive);
        if (!changed) return false;
        primitive = *std::move(changed);
    }
    return true;
}

}  // namespace

Real half_tangent(const Real& degrees) { return tan(degrees * pi() / 360); }
Real degrees_of(const Real& half_tangent) { return atan(half_tangent) * 360 / pi(); }

Vec<Real> middle_of(const Primitive<Real>& primitive) {
    const Vec<Real> middle = visit(primitive, [](const auto& shape) { return shape.middle(); });
    if (!primitive.transform) return middle;
    // The point that the stored inverse M⁻¹ transforms to the middle.
    if (primitive.transform->is_inverse)
        return point_to_object_space(
            middle, Transform<Real>{primitive.transform->matrix, false, primitive.transform->orientation});
    return primitive.transform->map().point(middle);
}

Real size_of(const Primitive<Real>& primitive) {
    const Real size = visit(primitive, [](const auto& shape) { return shape.half_extent(); });
    if (!primitive.transform) return size;
    const Real factor = cbrt(abs(primitive.transform->map().determinant()));
    return primitive.transform->is_inverse ? Real(size / factor) : Real(size * factor);
}

namespace {

/// A triangle with the transform of the meshes whose corners are all at one point. A change moves this point as it
/// moves a vertex.
Primitive<Real> at_vertex(const Scene& scene, const Vec<double>& v) {
    Primitive<double> triangle(scene.mesh->triangle(0));
    for (std::size_t k = 0; k < triangle.shape_numbers().size(); k += 3) triangle.set_point(k, v);
    triangle.transform = scene.mesh_transform;
    return convert_numbers(triangle, [](double x) { return Real(x); });
}

/// The mean of the middles of all triangles of meshes. A matrix transforms the mean of points to the mean of the
/// transformed points.
Vec<Real> middle_of_mesh(const Scene& scene) {
    Vec<double> sum(0, 0, 0);
    for (std::size_t i = 0; i < scene.mesh->faces.size(); ++i) sum = sum + scene.mesh->triangle(i).middle();
    const Vec<double> middle = sum / static_cast<double>(scene.mesh->faces.size());
    return middle_of(at_vertex(scene, middle));
}

/// Applies a change to the matrix of the meshes or, if the scene has no matrix for them, to the vertices. The results
/// are rounded to doubles.
template <class Change>
void change_mesh(Scene& scene, const Change& change) {
    if (!scene.mesh) return;
    const auto as_double = [](const Real& x) { return static_cast<double>(x); };
    if (scene.mesh_transform) {
        scene.mesh_transform = convert_numbers(*change(at_vertex(scene, {0, 0, 0})).transform, as_double);
        return;
    }
    const auto mesh = std::make_shared<triangle::Mesh>(*scene.mesh);
    for (Vec<double>& v : mesh->vertices) {
        const Vec<Real> changed = change(at_vertex(scene, v)).point(0);
        v = Vec<double>(as_double(changed.x), as_double(changed.y), as_double(changed.z));
    }
    scene.mesh = mesh;
}

}  // namespace

Vec<Real> middle_of(const Scene& scene) {
    Vec<Real> sum(Real(0), Real(0), Real(0));
    int count = 0;
    const auto add = [&](const Vec<Real>& v) {
        sum = sum + v;
        ++count;
    };
    for (const Primitive<Real>& primitive : scene.listed) add(middle_of(primitive));
    if (scene.flake) {
        const Vec<double>& c = scene.flake->centre;
        add({Real(c.x), Real(c.y), Real(c.z)});
    }
    if (scene.mesh) {
        const auto faces = static_cast<int>(scene.mesh->faces.size());
        sum = sum + Real(faces) * middle_of_mesh(scene);
        count += faces;
    }
    return (Real(1) / Real(std::max(count, 1))) * sum;
}

Vec<Real> offset_direction() { return {Real(1), Real(11) / 16, -Real(7) / 16}; }

Primitive<Real> translate(const Primitive<Real>& primitive, const Vec<Real>& offset) {
    Primitive<Real> result = primitive;
    if (primitive.transform) {
        const Affine<Real> m = primitive.transform->map();
        const Vec<Real> shift = primitive.transform->is_inverse ? Vec<Real>(-m.linear(offset)) : offset;
        for (int i = 0; i < 3; ++i) result.transform->matrix[4 * i + 3] += shift[i];
        return result;
    }
    for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
        if (key.kind == Key::Kind::point) result.set_point(k, result.point(k) + offset);
    });
    return result;
}

std::optional<Primitive<Real>> grow(const Primitive<Real>& primitive, const Vec<Real>& viewpoint, const Real& k) {
    const Vec<Real> object_viewpoint =
        primitive.transform ? point_to_object_space(viewpoint, *primitive.transform) : viewpoint;
    auto result = visit(primitive, [&](const auto& shape) -> std::optional<Primitive<Real>> {
        return shape.scaled_about_nearest(object_viewpoint, k);
    });
    if (result) result->transform = primitive.transform;
    return result;
}

namespace {

/// Multiplies every length of the world by k.
Primitive<Real> enlarge(const Primitive<Real>& primitive, const Real& k) {
    if (!primitive.transform) return convert_numbers(primitive, [&k](const Real& x) { return Real(k * x); });
    Primitive<Real> result = primitive;
    for (std::size_t i = 0; i < result.transform->matrix.size(); ++i) {
        if (!result.transform->is_inverse) result.transform->matrix[i] *= k;
        else if (i % 4 != 3) result.transform->matrix[i] /= k;
    }
    return result;
}

}  // namespace

Real view_fraction(const Scene& scene) {
    const Vec<Real> view = scene.camera.look_at - scene.camera.eye;
    return dot(middle_of(scene) - scene.camera.eye, view) / dot(view, view);
}

std::optional<Scene> move_farther(Scene scene, const Real& k) {
    Camera& camera = scene.camera;
    const Real fraction = view_fraction(scene);
    if (fraction <= 0) return std::nullopt;
    const Vec<Real> shift = ((k - 1) * fraction) * (camera.look_at - camera.eye);
    camera.eye = camera.eye - shift;
    camera.look_at = camera.look_at - shift;
    if (camera.kind == Camera::Kind::pinhole) camera.fov_deg = degrees_of(half_tangent(camera.fov_deg) / k);
    return scene;
}

Scene enlarge(Scene scene, const Real& k) {
    const auto scale = [&k](const Vec<Real>& v) { return Vec<Real>(k * v.x, k * v.y, k * v.z); };
    change_primitives(scene, [&k](const Primitive<Real>& primitive) { return std::optional(enlarge(primitive, k)); });
    change_mesh(scene, [&k](const Primitive<Real>& triangle) { return enlarge(triangle, k); });
    scene.camera.eye = scale(scene.camera.eye);
    scene.camera.look_at = scale(scene.camera.look_at);
    scene.camera.width = k * scene.camera.width;
    if (scene.appearance.light) scene.appearance.light = scale(*scene.appearance.light);
    return scene;
}

std::optional<Scene> grow(Scene scene, const Real& k) {
    if (scene.mesh) return std::nullopt;  // triangles that grow one by one are no longer a mesh
    const Vec<Real> eye = scene.camera.eye;
    if (!change_primitives(scene, [&](const Primitive<Real>& primitive) { return grow(primitive, eye, k); }))
        return std::nullopt;
    return scene;
}

Scene translate(Scene scene, const Vec<Real>& offset) {
    change_primitives(
        scene, [&offset](const Primitive<Real>& primitive) { return std::optional(translate(primitive, offset)); });
    change_mesh(scene, [&offset](const Primitive<Real>& triangle) { return translate(triangle, offset); });
    scene.camera.eye = scene.camera.eye + offset;
    scene.camera.look_at = scene.camera.look_at + offset;
    if (scene.flake)
        for (int i = 0; i < 3; ++i) scene.flake->centre[i] += static_cast<double>(offset[i]);
    if (scene.appearance.light) scene.appearance.light = *scene.appearance.light + offset;
    return scene;
}

}  // namespace lostbits::scene::file
