#include "scene/camera/makers.hpp"

#include <algorithm>
#include <vector>

#include "scene/camera/list.hpp"

namespace lostbits::scene::camera {

namespace {

template <class M, class T>
void make(const CameraNumbers<T>& camera, Rows rows, const std::function<void(const Ray<T>&)>& take) {
    const auto prepared = M::prepare(camera);
    for (int y = rows.first; y < rows.last; ++y)
        for (int x = 0; x < camera.width; ++x) take(M::ray(camera, prepared, Pixel{x, y}));
}

const std::vector<Maker>& table() {
    static const std::vector<Maker> all = [] {
        std::vector<Maker> rows;
        for_each_maker([&rows]<class M>() {
            rows.push_back({&M::info, make<M, float>, make<M, double>, make<M, RoundedAny>, make<M, Real>});
        });
        return rows;
    }();
    return all;
}

}  // namespace

std::span<const Maker> makers() { return table(); }

const Maker* find_maker(std::string_view name) {
    const auto found = std::ranges::find(table(), name, [](const Maker& m) { return m.info->name; });
    return found == table().end() ? nullptr : &*found;
}

}  // namespace lostbits::scene::camera
