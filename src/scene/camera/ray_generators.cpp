#include "scene/camera/ray_generators.hpp"

#include <algorithm>
#include <vector>

#include "number/recorded.hpp"
#include "number/recorders/tape_recorder.hpp"
#include "scene/camera/list.hpp"

namespace lostbits::scene::camera {

namespace {

template <class Generator, class T>
void make_rays(const CameraNumbers<T>& camera, RowRange rows, const std::function<void(const Ray<T>&)>& add) {
    const auto prepared = Generator::prepare(camera);
    for (int y = rows.first; y < rows.last; ++y)
        for (int x = 0; x < camera.width; ++x) add(Generator::ray(camera, prepared, Pixel<T>{T(x), T(y), T(x - 1)}));
}

template <class Generator>
std::array<NodeId, 6> record_ray(const Format& format, const CameraNumbers<double>& stored, PixelCoordinates pixel,
                                 Tape& tape) {
    using T = Recorded;
    number::recorders::TapeRecorder recorder(tape, format.parameters);
    const auto input = [](double x) { return T(x); };
    const CameraNumbers<T> camera = stored.each(input);
    const T x = input(pixel.x), y = input(pixel.y), left = input(pixel.x - 1);
    const auto prepared = Generator::prepare(camera);
    const auto [o, d] = Generator::ray(camera, prepared, Pixel<T>{x, y, left});
    return std::array{o.x.node(), o.y.node(), o.z.node(), d.x.node(), d.y.node(), d.z.node()};
}

}  // namespace

std::vector<std::string> camera_number_names() {
    std::vector<std::string> names;
    for (const char* const v : {"eye", "right", "up", "forward"})
        for (const char* const axis : {".x", ".y", ".z"}) names.push_back(std::string(v) + axis);
    names.insert(names.end(), {"tan_x", "tan_y", "near", "depth_near", "depth_far"});
    for (const char* const m :
         {"view", "projection", "to_world", "clip_to_world", "clip_to_offset", "raster_to_camera"})
        for (int k = 0; k < 16; ++k)
            names.push_back(std::string(m) + ".r" + std::to_string(k / 4) + "c" + std::to_string(k % 4));
    return names;
}

std::span<const RayGenerator> ray_generators() {
    static const std::vector<RayGenerator> all = [] {
        std::vector<RayGenerator> rows;
        for_each_generator([&rows]<class Generator>() {
            rows.push_back({&Generator::info, make_rays<Generator, float>, make_rays<Generator, double>,
                            make_rays<Generator, RoundedAny>, make_rays<Generator, Real>, record_ray<Generator>});
        });
        return rows;
    }();
    return all;
}

const RayGenerator* find_ray_generator(std::string_view name) {
    const auto found =
        std::ranges::find(ray_generators(), name, [](const RayGenerator& generator) { return generator.info->name; });
    return found == ray_generators().end() ? nullptr : &*found;
}

}  // namespace lostbits::scene::camera
