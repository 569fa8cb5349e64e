// Rays of a scene, or of files, on which kernels are timed.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "intersect/simd/packed.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/trade/timing.hpp"

namespace lostbits::measure::trade {

/// Returns the scene with a picture of at most `pixels` pixels and the same proportions.
scene::file::Scene with_smaller_picture(const scene::file::Scene& scene, int pixels);

/// About two thousand rays of a scene, taken evenly over its picture, against the primitives that most of them truly
/// hit. There are at most four primitives; if nothing is hit, they are the first ones of the scene.
class SceneWork {
public:
    explicit SceneWork(const scene::file::Scene& scene, truth::ProofLimit limit = {});
    /// Uses all rays of a given sample. If each ray has its own primitive, primitives with the same numbers are merged.
    explicit SceneWork(const scene::rays::RayGroup& sample, truth::ProofLimit limit = {});
    SceneWork(const SceneWork&) = delete;
    SceneWork& operator=(const SceneWork&) = delete;

    [[nodiscard]] std::size_t ray_count() const { return ray_count_; }
    [[nodiscard]] std::size_t primitive_count() const { return primitives_.size(); }
    /// Bytes of the rays and of the answers.
    [[nodiscard]] std::size_t bytes(const Format& format) const;
    /// Share of the rays that truly hit anything.
    [[nodiscard]] double hit_rate() const { return hit_rate_; }

    /// Returns the work that tests every ray against every primitive by the row's kernel; an item is one ray and one
    /// primitive. The format is f32 or f64. All work of one format shares its arrays, so only one piece of it may run
    /// at a time. The arrays live as long as any work on them.
    TimedWork work_for(const evaluate::TestedForm& tested_form, const intersect::simd::PackedFormKernels& kernels);

private:
    void choose_primitives(const std::vector<int>& first_equal, std::size_t primitive_count);

    template <class S>
    struct Store;
    template <class S>
    std::shared_ptr<Store<S>> store(const evaluate::TestedForm& tested_form);

    scene::file::Scene scene_ = {};
    std::unique_ptr<culling::Culler> culler_ = {};  ///< culler of the scene; null for a sample of a file
    truth::Band band_;
    std::size_t ray_count_;
    double hit_rate_ = 0;
    std::vector<std::size_t> primitives_;
    std::array<std::shared_ptr<Store<float>>, 2> f32_;  ///< [0]: directions as stored; [1]: of unit length
    std::array<std::shared_ptr<Store<double>>, 2> f64_;
};

}  // namespace lostbits::measure::trade
