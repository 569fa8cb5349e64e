#include "measure/speed/scene_work.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

#include "measure/answer/chunk.hpp"

namespace lostbits::measure::speed {

using intersect::Target;
using scene::file::Scene;

namespace {

constexpr int timed_pixels = 2048;
constexpr std::size_t max_timed_primitives = 4;
constexpr std::size_t numbers_a_ray = 9;  // origin, direction; t, near, far

/// Counts the rays of the band that truly hit each primitive first. Hits of equal primitives are counted together: Hits
/// of primitive k count for primitive `same_as[k]`. If `same_as` is empty, they count for k itself.
std::map<int, std::size_t> hits_of(const truth::Band& band, const std::vector<int>& same_as) {
    std::map<int, std::size_t> hits;
    for (std::size_t i = 0; i < band.pixels(); ++i) {
        const truth::Truth truth = band.truth(i, {});
        if (truth.is_hit()) ++hits[same_as.empty() ? truth.object : same_as[static_cast<std::size_t>(truth.object)]];
    }
    return hits;
}

/// Index of the first primitive with the same numbers, for each primitive.
std::vector<int> first_same(const std::vector<Primitive<double>>& primitives) {
    using Matrix = std::optional<std::pair<bool, decltype(Placement<double>::matrix)>>;
    std::map<std::tuple<Shape, decltype(Primitive<double>::numbers), Matrix>, int> places;
    std::vector<int> first;
    for (const Primitive<double>& primitive : primitives) {
        Matrix matrix;
        if (primitive.placed) matrix.emplace(primitive.placed->is_inverse, primitive.placed->matrix);
        const std::tuple same(primitive.shape, primitive.numbers, matrix);
        first.push_back(places.emplace(same, static_cast<int>(first.size())).first->second);
    }
    return first;
}

std::vector<std::size_t> primitives_to_time(const std::map<int, std::size_t>& hits, std::size_t primitives) {
    std::vector<std::pair<std::size_t, int>> order;
    for (const auto& [primitive, count] : hits) order.emplace_back(count, primitive);
    std::ranges::sort(order, [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    std::vector<std::size_t> chosen;
    for (const auto& [count, primitive] : order) chosen.push_back(static_cast<std::size_t>(primitive));
    if (chosen.empty()) {
        chosen.resize(primitives);
        std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    }
    if (chosen.size() > max_timed_primitives) chosen.resize(max_timed_primitives);
    return chosen;
}

}  // namespace

/// Rays of a format in columns, a buffer for their answers, and the primitives.
template <class S>
struct SceneWork::Store {
    answer::KernelBuffers<S> buffers;
    std::vector<Primitive<S>> primitives = {};

    void run(const intersect::table::Kernel<S>& kernel) {
        for (const Primitive<S>& primitive : primitives) kernel(buffers.rays(), Target<S>(primitive), buffers.hits());
    }
};

Scene with_smaller_picture(const Scene& scene, int pixels) {
    Scene thin = scene;
    const double factor = std::min(1.0, std::sqrt(static_cast<double>(pixels) / static_cast<double>(scene.pixels())));
    const auto shrunk = [factor](int side) { return std::max(1, static_cast<int>(std::lround(side * factor))); };
    thin.width = shrunk(scene.width);
    thin.height = shrunk(scene.height);
    return thin;
}

SceneWork::SceneWork(const Scene& scene, truth::TruthLimit limit)
    : scene_(with_smaller_picture(scene, timed_pixels)),
      culler_(std::make_unique<culling::Culler>(scene_)),
      band_(scene_, 0, scene_.height, limit, culler_.get()),
      rays_(band_.pixels()) {
    choose_primitives({}, scene_.primitive_count());
}

SceneWork::SceneWork(const scene::rays::RayGroup& sample, truth::TruthLimit limit)
    : band_(sample, limit), rays_(band_.pixels()) {
    choose_primitives(first_same(sample.primitives), sample.primitives.size());
}

void SceneWork::choose_primitives(const std::vector<int>& same_as, std::size_t primitives) {
    const auto hits = hits_of(band_, same_as);
    std::size_t all = 0;
    for (const auto& [primitive, count] : hits) all += count;
    hit_rate_ = static_cast<double>(all) / static_cast<double>(rays_);
    primitives_ = primitives_to_time(hits, primitives);
}

std::size_t SceneWork::bytes(const Format& format) const {
    const std::size_t size = format.engine == Format::Engine::native32 ? sizeof(float) : sizeof(double);
    return rays_ * (numbers_a_ray * size + 1);
}

template <class S>
std::shared_ptr<SceneWork::Store<S>> SceneWork::store(const evaluate::TestedForm& row) {
    auto& stores = [this]() -> auto& {
        if constexpr (std::same_as<S, float>) return f32_;
        else return f64_;
    }
    ();
    const bool unit = row.form->info->direction == intersect::Direction::unit;
    auto& made = stores[unit ? 1 : 0];
    if (!made) {
        const truth::FormatInputs inputs = band_.inputs_for(row.format, *row.form->info);
        made = std::make_shared<Store<S>>(Store<S>{answer::KernelBuffers<S>(inputs.rays_for(*row.form->info))});
        for (const std::size_t s : primitives_) made->primitives.push_back(lift_primitive<S>(inputs.primitives[s]));
    }
    return made;
}

TimedWork SceneWork::on(const evaluate::TestedForm& row, const intersect::simd::PackedRow& kernels) {
    const std::size_t items = rays() * primitives();
    if (row.format.engine == Format::Engine::native32)
        return {[to = store<float>(row), kernel = kernels.f32] { to->run(kernel); }, items, true};
    return {[to = store<double>(row), kernel = kernels.f64] { to->run(kernel); }, items, true};
}

}  // namespace lostbits::measure::speed
