#include "measure/trade/scene_work.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

#include "measure/answer/chunk.hpp"

namespace lostbits::measure::trade {

using intersect::Target;
using scene::file::Scene;

namespace {

constexpr int timed_pixels = 2048;
constexpr std::size_t max_timed_primitives = 4;
constexpr std::size_t numbers_a_ray = 9;  // numbers of one ray: origin, direction; t, near, far

/// Counts, for each primitive, the rays of the band that truly hit it first. Equal primitives count as one: a hit of
/// primitive k counts for primitive `first_equal[k]`, or for k itself if `first_equal` is empty.
std::map<int, std::size_t> count_hits(const truth::Band& band, const std::vector<int>& first_equal) {
    std::map<int, std::size_t> hits;
    for (std::size_t i = 0; i < band.pixel_count(); ++i) {
        const truth::Truth truth = band.truth(i, {});
        if (truth.is_hit()) ++hits[first_equal.empty() ? truth.primitive : first_equal[truth.primitive]];
    }
    return hits;
}

/// Returns, for each primitive, the index of the first primitive with the same numbers.
std::vector<int> find_first_equal_indices(const std::vector<Primitive<double>>& primitives) {
    using Matrix = std::optional<std::pair<bool, decltype(Transform<double>::matrix)>>;
    std::map<std::tuple<Shape, decltype(Primitive<double>::numbers), Matrix>, int> first_by_key;
    std::vector<int> first_indices;
    for (const Primitive<double>& primitive : primitives) {
        Matrix matrix;
        if (primitive.transform) matrix.emplace(primitive.transform->is_inverse, primitive.transform->matrix);
        const std::tuple key(primitive.shape, primitive.numbers, matrix);
        first_indices.push_back(first_by_key.emplace(key, static_cast<int>(first_indices.size())).first->second);
    }
    return first_indices;
}

std::vector<std::size_t> choose_primitives_to_time(const std::map<int, std::size_t>& hits,
                                                   std::size_t primitive_count) {
    std::vector<std::pair<std::size_t, int>> order;
    for (const auto& [primitive, count] : hits) order.emplace_back(count, primitive);
    std::ranges::sort(order, [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    std::vector<std::size_t> chosen;
    for (const auto& [count, primitive] : order) chosen.push_back(static_cast<std::size_t>(primitive));
    if (chosen.empty()) {
        chosen.resize(primitive_count);
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
    Scene small_scene = scene;
    const double factor =
        std::min(1.0, std::sqrt(static_cast<double>(pixels) / static_cast<double>(scene.pixel_count())));
    const auto shrink = [factor](int side) { return std::max(1, static_cast<int>(std::lround(side * factor))); };
    small_scene.width = shrink(scene.width);
    small_scene.height = shrink(scene.height);
    return small_scene;
}

SceneWork::SceneWork(const Scene& scene, truth::ProofLimit limit)
    : scene_(with_smaller_picture(scene, timed_pixels)),
      culler_(std::make_unique<culling::Culler>(scene_)),
      band_(scene_, 0, scene_.height, limit, culler_.get()),
      ray_count_(band_.pixel_count()) {
    choose_primitives({}, scene_.primitive_count());
}

SceneWork::SceneWork(const scene::rays::RayGroup& sample, truth::ProofLimit limit)
    : band_(sample, limit), ray_count_(band_.pixel_count()) {
    choose_primitives(find_first_equal_indices(sample.primitives), sample.primitives.size());
}

void SceneWork::choose_primitives(const std::vector<int>& first_equal, std::size_t primitive_count) {
    const auto hits = count_hits(band_, first_equal);
    std::size_t hit_count = 0;
    for (const auto& [primitive, count] : hits) hit_count += count;
    hit_rate_ = static_cast<double>(hit_count) / static_cast<double>(ray_count_);
    primitives_ = choose_primitives_to_time(hits, primitive_count);
}

std::size_t SceneWork::bytes(const Format& format) const {
    const std::size_t size = format.engine == Format::Engine::native32 ? sizeof(float) : sizeof(double);
    return ray_count_ * (numbers_a_ray * size + 1);
}

template <class S>
std::shared_ptr<SceneWork::Store<S>> SceneWork::store(const evaluate::TestedForm& tested_form) {
    auto& stores = [this]() -> auto& {
        if constexpr (std::same_as<S, float>) return f32_;
        else return f64_;
    }
    ();
    const bool is_unit = tested_form.form->info->direction == intersect::Direction::unit;
    auto& row_store = stores[is_unit ? 1 : 0];
    if (!row_store) {
        const truth::FormatInputs inputs = band_.inputs_for(tested_form.format, *tested_form.form->info);
        row_store =
            std::make_shared<Store<S>>(Store<S>{answer::KernelBuffers<S>(inputs.rays_for(*tested_form.form->info))});
        for (const std::size_t s : primitives_)
            row_store->primitives.push_back(lift_primitive<S>(inputs.primitives[s]));
    }
    return row_store;
}

TimedWork SceneWork::work_for(const evaluate::TestedForm& tested_form,
                              const intersect::simd::PackedFormKernels& kernels) {
    const std::size_t item_count = ray_count() * primitive_count();
    if (tested_form.format.engine == Format::Engine::native32)
        return {[row_store = store<float>(tested_form), kernel = kernels.f32] { row_store->run(kernel); }, item_count,
                true};
    return {[row_store = store<double>(tested_form), kernel = kernels.f64] { row_store->run(kernel); }, item_count,
            true};
}

}  // namespace lostbits::measure::trade
