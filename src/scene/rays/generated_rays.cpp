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

/// Builds the inverse of a view: the axes in the columns, then a position.
Matrix4<Real> to_world(const CameraFrame<Real>& f, const Vec<Real>& place) {
    const auto row = [&](int i) { return std::array<Real, 4>{f.right[i], f.up[i], -f.forward[i], place[i]}; };
    return matrix({row(0), row(1), row(2), {Real(0), Real(0), Real(0), Real(1)}});
}

/// z/w is p = `depth_near` on the near plane and q = `depth_far` on the far one, with w = -z. With n and f the
/// distances: z' = a z + b, a = (p n - q f)/(f - n), b = (p - q) f n/(f - n). With f at infinity, a = -q and b = (p -
/// q) n.
Matrix4<Real> projection(const CameraProjection& p, const CameraNumbers<Real>& c) {
    const Real range = c.depth_near - c.depth_far, zero(0);
    const Real a =
        p.far ? Real((c.depth_near * p.near - c.depth_far * *p.far) / (*p.far - p.near)) : Real(-c.depth_far);
    const Real b = p.far ? Real(range * *p.far * p.near / (*p.far - p.near)) : Real(range * p.near);
    return matrix({{{1 / c.tan_x, zero, zero, zero},
                    {zero, 1 / c.tan_y, zero, zero},
                    {zero, zero, a, b},
                    {zero, zero, Real(-1), zero}}});
}

/// The matrix from pixels, to the right and down, to clip space; z is 0 on the near plane.
Matrix4<Real> raster_to_clip(const CameraNumbers<Real>& c) {
    const Real zero(0), one(1);
    return matrix({{{Real(2) / c.width, zero, zero, -one},
                    {zero, -Real(2) / c.height, zero, one},
                    {zero, zero, one, c.depth_near},
                    {zero, zero, zero, one}}});
}

}  // namespace

CameraNumbers<Real> camera_numbers(const Scene& scene) {
    const CameraFrame<Real> f = make_frame<Real>(scene);
    const CameraProjection& p = scene.camera.projection.value();
    using Depth = CameraProjection::Depth;
    CameraNumbers<Real> c{};
    c.width = scene.width, c.height = scene.height;
    c.eye = f.origin, c.right = f.right, c.up = f.up, c.forward = f.forward;
    c.tan_y = file::half_tangent(scene.camera.fov_deg);
    c.tan_x = c.tan_y * c.width / c.height;
    c.near = p.near;
    c.depth_near = Real(p.depth == Depth::gl ? -1 : p.depth == Depth::reversed ? 1 : 0);
    c.depth_far = Real(p.depth == Depth::reversed ? 0 : 1);
    c.projection = projection(p, c);
    c.to_world = to_world(f, f.origin);
    c.view = inverse(c.to_world);
    const Matrix4<Real> from_clip = inverse(c.projection);
    c.clip_to_world = c.to_world * from_clip;
    c.clip_to_offset = to_world(f, {Real(0), Real(0), Real(0)}) * from_clip;
    c.raster_to_camera = from_clip * raster_to_clip(c);
    return c;
}

GeneratedRays::GeneratedRays(const Scene& scene)
    : by_(scene.camera.rays), frame_(make_frame<Real>(scene)), numbers_(camera_numbers(scene)) {}

BasicRayBlock<Real> GeneratedRays::ideal(int y0, int y1) const {
    BasicRayBlock<Real> block;
    block.width = numbers_.width, block.y0 = y0, block.y1 = y1;
    for (int y = y0; y < y1; ++y) {
        for (int x = 0; x < block.width; ++x) {
            Ray<Real> one = ray(frame_, x, y);
            if (by_->info->from_near)
                one.origin = one.origin + (numbers_.near / dot(one.direction, frame_.forward)) * one.direction;
            block.push(one);
        }
    }
    return block;
}

const CameraNumbers<double>& GeneratedRays::stored(const FloatFormat& format) const {
    const std::lock_guard alone(storing_);
    for (const auto& [of, numbers] : stored_)
        if (of == format) return numbers;
    const auto rounded = [&format](const Real& x) { return static_cast<double>(toml::round_to_format(x, format)); };
    return stored_.emplace_back(format, numbers_.each(rounded)).second;
}

template <class T>
RayBlock GeneratedRays::generate(camera::MakeIn<T> make, const FloatFormat& format, int y0, int y1) const {
    const CameraNumbers<T> numbers = stored(format).each([](double x) { return T(x); });
    RayBlock block;
    block.width = numbers_.width, block.y0 = y0, block.y1 = y1;
    make(numbers, {y0, y1}, [&block](const Ray<T>& ray) { block.push(as_doubles(ray)); });
    return block;
}

RayBlock GeneratedRays::in(const FloatFormat& format, int y0, int y1) const {
    if (format == binary32) return generate<float>(by_->f32, format, y0, y1);
    if (format == binary64) return generate<double>(by_->f64, format, y0, y1);
    const CurrentFormat::Scope scope(format);
    return generate<RoundedAny>(by_->rounded, format, y0, y1);
}

RecordedRay GeneratedRays::record(const Format& format, camera::PixelCoordinates at) const {
    Tape whole;
    const auto ray = by_->record(format, stored(format.parameters), at, whole);
    static const std::vector<std::string> names = [] {
        auto all = camera::camera_number_names();
        all.insert(all.end(), {"pixel.x", "pixel.y", "pixel.left"});
        return all;
    }();
    std::vector<bool> is_used(whole.nodes.size());
    for (const NodeId node : ray) is_used[static_cast<std::size_t>(node)] = true;
    for (NodeId i = whole.size() - 1; i >= 0; --i) {
        if (!is_used[static_cast<std::size_t>(i)]) continue;
        for (const NodeId operand : whole.operands_of(i)) is_used[static_cast<std::size_t>(operand)] = true;
    }
    RecordedRay recorded;
    std::vector<NodeId> place(whole.nodes.size(), no_node);
    for (NodeId i = 0; i < whole.size(); ++i) {
        const TapeNode& n = whole[i];
        if (!is_used[static_cast<std::size_t>(i)]) continue;
        const auto operand = [&](std::size_t k) {
            const NodeId from = n.operands[k];
            return is_given(n.op) || from == no_node ? from : place[static_cast<std::size_t>(from)];
        };
        NodeId& there = place[static_cast<std::size_t>(i)];
        if (n.op == TapeOp::input) {
            recorded.names.push_back(names[static_cast<std::size_t>(n.operands[0])]);
            there = recorded.tape.add_input(format.parameters, n.value);
        } else {
            there = recorded.tape.add(n.op, whole.format_of(i), n.value, {operand(0), operand(1), operand(2)});
            recorded.tape[there].label = n.label;
        }
    }
    constexpr std::array<std::string_view, 6> numbers{"o.x", "o.y", "o.z", "d.x", "d.y", "d.z"};
    for (std::size_t k = 0; k < ray.size(); ++k) {
        recorded.ray[k] = place[static_cast<std::size_t>(ray[k])];
        recorded.tape.name(recorded.ray[k], numbers[k]);
    }
    return recorded;
}

void RecordedRay::put_before(Tape& form) const {
    Tape whole = tape;
    whole.outputs = intersect::table::append(form, {ray.begin(), ray.end()}, whole);
    form = std::move(whole);
}

bool RecordedRay::try_put_before(Tape& form) const {
    const auto is_same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    for (const TapeNode& n : form.nodes) {
        const auto k = static_cast<std::size_t>(n.operands[0]);
        if (n.op == TapeOp::input && k < ray.size() && !is_same(tape[ray[k]].value, n.value)) return false;
    }
    put_before(form);
    return true;
}

}  // namespace lostbits::scene::rays
