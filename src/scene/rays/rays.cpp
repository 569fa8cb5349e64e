#include "scene/rays/rays.hpp"

#include <algorithm>

#include "number/rounded.hpp"
#include "scene/file/stretch.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/generated_rays.hpp"
#include "scene/rays/primitive_list.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::scene::rays {

using file::Scene;

namespace {

template <class T>
BasicRayBlock<T> make_rays(const Scene& scene, int y0, int y1) {
    const CameraFrame<T> frame = make_frame<T>(scene);
    BasicRayBlock<T> block;
    block.width = scene.width, block.y0 = y0, block.y1 = y1;
    const std::size_t count = static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(y1 - y0);
    for (auto* column : block.numbers()) column->reserve(count);
    for (int y = y0; y < y1; ++y) {
        for (int x = 0; x < scene.width; ++x) block.push(ray(frame, x, y));
    }
    set_range(scene, block);
    return block;
}

template <class T, class Round>
RayBlock round_components(const BasicRayBlock<T>& block, Round round) {
    RayBlock result;
    result.width = block.width, result.y0 = block.y0, result.y1 = block.y1;
    for (std::size_t k = 0; k < result.numbers().size(); ++k) {
        result.numbers()[k]->resize(block.size());
        std::ranges::transform(*block.numbers()[k], result.numbers()[k]->begin(), round);
    }
    return result;
}

template <class T, class Round>
void round_ranges(const BasicRayBlock<T>& block, RayBlock& result, const Round& round) {
    for (const double t : block.tmin) result.tmin.push_back(round(t));
    for (const double t : block.tmax) result.tmax.push_back(round(t));
    result.open_ends = block.open_ends;
}

/// v/|v|. Adding zero turns −0, which cross products of axes give, into 0.
Vec<Real> unit(const Vec<Real>& v) {
    const Real size = length(v), zero(0);
    return {v.x / size + zero, v.y / size + zero, v.z / size + zero};
}

}  // namespace

CameraFrame<Real> make_ideal_frame(const Scene& scene) {
    using Kind = file::Camera::Kind;
    const file::Camera& camera = scene.camera;
    const Real width(scene.width), height(scene.height);

    CameraFrame<Real> frame{};
    frame.kind = camera.kind;
    frame.origin = camera.eye;

    if (camera.kind == Kind::pixel_plane) {
        frame.left = camera.left;
        frame.top = camera.top;
        frame.pitch = (camera.right - camera.left) / width;
        frame.pitch_down = (camera.top - camera.bottom) / height;
        return frame;
    }

    frame.normalise = camera.normalise;
    frame.forward = unit(camera.look_at - camera.eye);
    frame.right = unit(cross(frame.forward, camera.up));
    frame.up = unit(cross(frame.right, frame.forward));

    // The size of a pixel, and the point of the picture on the view axis.
    frame.pitch = camera.kind == Kind::orthographic ? Real(camera.width / width)
                                                    : Real(2 * file::half_tangent(camera.fov_deg) / height);
    frame.centre_x = width / 2 - camera.shift_right * width;
    frame.centre_y = height / 2 + camera.shift_up * width;
    return frame;
}

RayGroup make_group(const Ray<double>& ray) {
    RayGroup group;
    group.rays.push(ray);
    group.rays.mark_as_list();
    return group;
}

RayGroup sample_rays(const RayGroup& group, std::size_t max_rays) {
    const std::size_t step = (group.rays.size() + max_rays - 1) / max_rays;
    RayGroup part{.rays = {},
                  .primitives = group.is_paired ? std::vector<Primitive<double>>() : group.primitives,
                  .is_paired = group.is_paired};
    for (std::size_t i = 0; i < group.rays.size(); i += step) {
        part.rays.push(group.rays[i]);
        part.rays.push_range(group.rays, i);
        if (group.is_paired) part.primitives.push_back(group.primitives[i]);
    }
    part.rays.mark_as_list();
    return part;
}

RayBlock make_shared_rays(const Scene& scene, int y0, int y1) {
    return round_block(make_rays<double>(scene, y0, y1), binary32);
}

IdealRayBlock make_own_rays(const Scene& scene, int y0, int y1) {
    if (!scene.camera.ray_generator) return {make_rays<Real>(scene, y0, y1)};
    const auto generated = std::make_shared<const GeneratedRays>(scene);
    IdealRayBlock block{generated->make_ideal_rays(y0, y1), generated};
    set_range(scene, block);
    return block;
}

RayBlock round_rays(const IdealRayBlock& ideal, const FloatFormat& format) {
    RayBlock result =
        ideal.generated_rays
            ? ideal.generated_rays->make_rounded_rays(format, ideal.y0, ideal.y1)
            : round_components(ideal, [&format](const Real& x) { return toml::round_to_format(x, format); });
    round_ranges(ideal, result, [&format](double t) { return rounding::to_format(t, 0, format); });
    return result;
}

RayBlock round_block(const RayBlock& block, const FloatFormat& format) {
    // A picture has millions of numbers, and the machine itself rounds to binary32.
    const bool rounds_by_machine = format == binary32;
    const auto round = [&format, rounds_by_machine](double x) {
        return rounds_by_machine ? static_cast<double>(static_cast<float>(x)) : rounding::to_format(x, 0, format);
    };
    RayBlock result = round_components(block, round);
    round_ranges(block, result, round);
    return result;
}

std::vector<Primitive<double>> make_shared_primitives(const Scene& scene) {
    return round_primitives(make_shared_primitive_list(scene), binary32).all();
}

std::vector<Primitive<double>> make_stored_primitives(const Scene& scene, const FloatFormat& format) {
    if (scene.inputs == file::InputRounding::shared) return make_shared_primitives(scene);
    std::vector<Primitive<double>> stored;
    for (const Primitive<Real>& primitive : scene.primitives()) stored.push_back(round_primitive(primitive, format));
    return stored;
}

Primitive<double> round_primitive(const Primitive<Real>& primitive, const FloatFormat& format) {
    return convert_numbers(primitive, [&format](const Real& x) { return toml::round_to_format(x, format); });
}

Primitive<double> round_primitive(const Primitive<double>& primitive, const FloatFormat& format) {
    return convert_numbers(primitive, [&format](double x) { return rounding::to_format(x, 0, format); });
}

RayBlock make_input_rays(const Scene& scene, int y0, int y1, const FloatFormat& format) {
    if (scene.inputs == file::InputRounding::own) return round_rays(make_own_rays(scene, y0, y1), format);
    return round_block(make_shared_rays(scene, y0, y1), format);
}

}  // namespace lostbits::scene::rays
