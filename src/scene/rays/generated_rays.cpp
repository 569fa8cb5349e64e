#include "scene/rays/generated_rays.hpp"

#include <cmath>

#include "intersect/table/joined_tapes.hpp"
#include "number/with_number.hpp"
#include "scene/file/stretch.hpp"
#include "shapes/lift.hpp"

namespace lostbits::scene::rays {

using camera::CameraNumbers;
using camera::Matrix4;
using file::CameraProjection;
using file::Scene;

namespace {

Matrix4<Real> matrix(const std::array<std::array<Real, 4>, 4>& rows) { return {rows}; }

/// Builds the inverse of a view: the axes in the columns, then the position of the eye.
Matrix4<Real> to_world(const CameraFrame<Real>& f, const Vec<Real>& position) {
    const auto row = [&](int i) { return std::array<Real, 4>{f.right[i], f.up[i], -f.forward[i], position[i]}; };
    return matrix({row(0), row(1), row(2), {Real(0), Real(0), Real(0), Real(1)}});
}

/// Builds a projection between two planes. z/w is p = `depth_near` on the near plane and q = `depth_far` on the far
/// plane, with w = -z. If n and f are the distances of the planes, z' = a z + b with a = (p n - q f)/(f - n) and b = (p
/// - q) f n/(f - n). With f at infinity, a = -q and b = (p - q) n.
Matrix4<Real> projection(const CameraProjection& planes, const CameraNumbers<Real>& camera) {
    const Real depth_range = camera.depth_near - camera.depth_far, zero(0);
    const Real a =
        planes.far
            ? Real((camera.depth_near * planes.near - camera.depth_far * *planes.far) / (*planes.far - planes.near))
            : Real(-camera.depth_far);
    const Real b = planes.far ? Real(depth_range * *planes.far * planes.near / (*planes.far - planes.near))
                              : Real(depth_range * planes.near);
    return matrix({{{1 / camera.tan_x, zero, zero, zero},
                    {zero, 1 / camera.tan_y, zero, zero},
                    {zero, zero, a, b},
                    {zero, zero, Real(-1), zero}}});
}

/// The matrix from pixels, to the right and down, to clip space; z is 0 on the near plane.
Matrix4<Real> raster_to_clip(const CameraNumbers<Real>& camera) {
    const Real zero(0), one(1);
    return matrix({{{Real(2) / camera.width, zero, zero, -one},
                    {zero, -Real(2) / camera.height, zero, one},
                    {zero, zero, one, camera.depth_near},
                    {zero, zero, zero, one}}});
}

}  // namespace

CameraNumbers<Real> compute_camera_numbers(const Scene& scene) {
    const CameraFrame<Real> frame = make_frame<Real>(scene);
    const CameraProjection& planes = scene.camera.projection.value();
    using DepthRange = CameraProjection::DepthRange;
    CameraNumbers<Real> camera{};
    camera.width = scene.width;
    camera.height = scene.height;
    camera.eye = frame.origin;
    camera.right = frame.right;
    camera.up = frame.up;
    camera.forward = frame.forward;

    // The planes of the projection, and z/w on them.
    camera.tan_y = file::half_tangent(scene.camera.fov_deg);
    camera.tan_x = camera.tan_y * camera.width / camera.height;
    camera.near = planes.near;
    camera.depth_near = Real(planes.depth == DepthRange::gl ? -1 : planes.depth == DepthRange::reversed ? 1 : 0);
    camera.depth_far = Real(planes.depth == DepthRange::reversed ? 0 : 1);

    camera.projection = projection(planes, camera);
    camera.to_world = to_world(frame, frame.origin);
    camera.view = inverse(camera.to_world);
    const Matrix4<Real> from_clip = inverse(camera.projection);
    camera.clip_to_world = camera.to_world * from_clip;
    camera.clip_to_offset = to_world(frame, {Real(0), Real(0), Real(0)}) * from_clip;
    camera.raster_to_camera = from_clip * raster_to_clip(camera);
    return camera;
}

GeneratedRays::GeneratedRays(const Scene& scene)
    : generator_(scene.camera.ray_generator),
      frame_(make_frame<Real>(scene)),
      numbers_(compute_camera_numbers(scene)) {}

BasicRayBlock<Real> GeneratedRays::make_ideal_rays(int y0, int y1) const {
    BasicRayBlock<Real> block;
    block.width = numbers_.width;
    block.y0 = y0;
    block.y1 = y1;
    for (int y = y0; y < y1; ++y) {
        for (int x = 0; x < block.width; ++x) {
            Ray<Real> pixel_ray = ray(frame_, x, y);
            if (generator_->info->starts_on_near_plane)
                pixel_ray.origin =
                    pixel_ray.origin + (numbers_.near / dot(pixel_ray.direction, frame_.forward)) * pixel_ray.direction;
            block.push(pixel_ray);
        }
    }
    return block;
}

const CameraNumbers<double>& GeneratedRays::stored_numbers(const FloatFormat& format) const {
    const std::lock_guard lock(stored_mutex_);
    for (const auto& [stored_format, numbers] : stored_)
        if (stored_format == format) return numbers;
    const auto rounded = [&format](const Real& x) { return static_cast<double>(toml::round_to_format(x, format)); };
    return stored_.emplace_back(format, numbers_.each(rounded)).second;
}

template <class T>
RayBlock GeneratedRays::generate(camera::MakeRays<T> make_rays, const FloatFormat& format, int y0, int y1) const {
    const CameraNumbers<T> numbers = stored_numbers(format).each([](double x) { return T(x); });
    RayBlock block;
    block.width = numbers_.width;
    block.y0 = y0;
    block.y1 = y1;
    make_rays(numbers, {y0, y1}, [&block](const Ray<T>& ray) { block.push(as_doubles(ray)); });
    return block;
}

RayBlock GeneratedRays::make_rounded_rays(const FloatFormat& format, int y0, int y1) const {
    if (format == binary32) return generate<float>(generator_->f32, format, y0, y1);
    if (format == binary64) return generate<double>(generator_->f64, format, y0, y1);
    const CurrentFormat::Scope scope(format);
    return generate<RoundedAny>(generator_->rounded, format, y0, y1);
}

namespace {

/// Marks the nodes that the numbers of a ray depend on, and these numbers.
std::vector<bool> find_used_nodes(const Tape& tape, const std::array<NodeId, 6>& ray) {
    std::vector<bool> is_used(tape.nodes.size());
    for (const NodeId id : ray) is_used[id] = true;
    for (NodeId i = tape.size() - 1; i >= 0; --i) {
        if (!is_used[i]) continue;
        for (const NodeId operand : tape.operands_of(i)) is_used[operand] = true;
    }
    return is_used;
}

}  // namespace

RecordedRay GeneratedRays::record_ray(const Format& format, camera::PixelCoordinates pixel) const {
    Tape tape;
    const auto ray = generator_->record(format, stored_numbers(format.parameters), pixel, tape);

    static const std::vector<std::string> names = [] {
        auto all = camera::camera_number_names();
        all.insert(all.end(), {"pixel.x", "pixel.y", "pixel.left"});
        return all;
    }();

    const std::vector<bool> is_used = find_used_nodes(tape, ray);

    // Copies the used nodes. The inputs are numbered anew, so each operand gets its new id.
    RecordedRay recorded;
    std::vector<NodeId> new_ids(tape.nodes.size(), no_node);
    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeNode& node = tape[i];
        if (!is_used[i]) continue;
        const auto operand = [&](std::size_t k) {
            const NodeId id = node.operands[k];
            return is_given(node.op) || id == no_node ? id : new_ids[id];
        };
        NodeId& new_id = new_ids[i];
        if (node.op == TapeOp::input) {
            recorded.names.push_back(names[node.operands[0]]);
            new_id = recorded.tape.add_input(format.parameters, node.value);
        } else {
            new_id = recorded.tape.add(node.op, tape.format_of(i), node.value, {operand(0), operand(1), operand(2)});
            recorded.tape[new_id].label = node.label;
        }
    }

    // Names the six numbers of the ray.
    constexpr std::array<std::string_view, 6> labels{"o.x", "o.y", "o.z", "d.x", "d.y", "d.z"};
    for (std::size_t k = 0; k < ray.size(); ++k) {
        recorded.ray[k] = new_ids[ray[k]];
        recorded.tape.name(recorded.ray[k], labels[k]);
    }
    return recorded;
}

void RecordedRay::prepend_to(Tape& form) const {
    Tape joined = tape;
    joined.outputs = intersect::table::append_tape(form, {ray.begin(), ray.end()}, joined);
    form = std::move(joined);
}

bool RecordedRay::try_prepend_to(Tape& form) const {
    const auto is_same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    for (const TapeNode& node : form.nodes) {
        const auto k = static_cast<std::size_t>(node.operands[0]);
        if (node.op == TapeOp::input && k < ray.size() && !is_same(tape[ray[k]].value, node.value)) return false;
    }
    prepend_to(form);
    return true;
}

}  // namespace lostbits::scene::rays
