// Computes the rays of a band of a picture and their truth once, for all forms and formats. A band is a range of
// scanlines.
#pragma once

#include <tbb/concurrent_unordered_map.h>

#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "measure/truth/format_inputs.hpp"
#include "measure/truth/truth_columns.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/generated_rays.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::truth {

/// Rays with their truth: those of the scanlines [y0, y1) of a scene, or any other rays.
class Band {
public:
    /// Finds the truth of every pixel, in parallel over the pixels. `culler`, of the same scene, skips the primitives
    /// that cannot matter; it must outlive the band.
    Band(const scene::file::Scene& scene, int y0, int y1, ProofLimit limit = {}, culling::Culler* culler = nullptr);
    /// Uses rays that are already stored numbers, with their primitives: the input of a step of a sweep.
    Band(scene::rays::RayBlock rays, std::vector<Primitive<double>> primitives, ProofLimit limit = {})
        : Band(scene::rays::RayGroup{std::move(rays), std::move(primitives)}, limit) {}
    /// `culler` has the same primitives and must outlive the band.
    explicit Band(scene::rays::RayGroup group, ProofLimit limit = {}, culling::Culler* culler = nullptr);
    /// Uses ideal rays among the primitives of a scene with own inputs. The scene must outlive the band.
    Band(const scene::file::Scene& scene, scene::rays::IdealRayBlock rays, ProofLimit limit = {});
    /// Uses ideal rays and primitives; if `is_paired`, ray i is tested only against primitive i.
    Band(scene::rays::IdealRayBlock rays, std::vector<Primitive<Real>> primitives, bool is_paired,
         ProofLimit limit = {});
    /// Uses one ray in stored numbers among the primitives of a scene with shared inputs. `culler` has the primitives
    /// of this scene and must outlive the band.
    Band(const scene::file::Scene& scene, scene::rays::RayBlock single_ray, culling::Culler& culler,
         ProofLimit limit = {});
    /// Range of ray i, before any format rounds it.
    [[nodiscard]] Range<double> range(std::size_t i) const { return ideal_ ? ideal_->range(i) : shared_.range(i); }
    /// Finds κ of every hit, in parallel.
    void find_condition();
    /// κ of ray i after `find_condition`; NaN for a miss.
    [[nodiscard]] double condition(std::size_t i, intersect::Convention convention) const;
    /// Bounds how far errors of the inputs can move the t of ray i, or its distance (see `truth::reach`); NaN for a
    /// miss. `inputs` gives the format, and the answer if it holds one. The unit is the power of two of this t, or
    /// distance.
    [[nodiscard]] double reach(std::size_t i, intersect::Convention convention, intersect::Direction direction,
                               const FormatInputs& inputs,
                               Perturbation perturbation = Perturbation::componentwise) const;
    /// Inputs of one format; computed in parallel over the pixels.
    [[nodiscard]] FormatInputs inputs(const Format& format, BandNeeds needs) const;
    /// Only the inputs that a form needs.
    [[nodiscard]] FormatInputs inputs_for(const Format& format, const intersect::Info& form) const {
        return inputs(format, {.unit_rays = form.direction == intersect::Direction::unit});
    }
    /// True if the format of the inputs rounded no number of ray i and of the primitives. `inputs` come from this band.
    [[nodiscard]] bool is_unrounded(const FormatInputs& inputs, std::size_t i) const;
    /// True if the format of the inputs rounded no number of any ray or primitive.
    [[nodiscard]] bool are_all_unrounded(const FormatInputs& inputs) const;
    /// Ray i before any format rounds or computes it.
    [[nodiscard]] Ray<Real> true_ray(std::size_t i) const;
    /// Camera whose rays each format computes; null if each format rounds rays that are stored.
    [[nodiscard]] const scene::rays::CameraFrame<Real>* camera_frame() const;
    /// Operations that compute ray i in a format; empty if the format rounds a stored ray.
    [[nodiscard]] std::optional<scene::rays::RecordedRay> recorded_ray(std::size_t i, const Format& format) const;
    /// Returns ray i before any format rounds it, with these `primitives`; if the set is empty, with
    /// all primitives and the constants of a march. Null for a pixel of a scene (its position identifies the ray), for
    /// an ideal ray, and if there are more than `max_original_primitives` primitives.
    [[nodiscard]] std::shared_ptr<const scene::rays::RayGroup> make_original_group(std::size_t i,
                                                                                   std::set<int> primitives) const;
    static constexpr std::size_t max_original_primitives = 64;

    /// Culler of the band's primitives; null if every primitive is tested.
    [[nodiscard]] culling::Culler* culler() const { return culler_; }
    [[nodiscard]] int y0() const { return y0_; }
    [[nodiscard]] int scanlines() const { return scanlines_; }
    [[nodiscard]] intersect::process::StopToken stop() const { return limit_.stop; }
    [[nodiscard]] std::size_t pixel_count() const { return truths_.size(); }
    /// Counts of the stages that settled the rays, for each ray and each primitive that it could meet.
    [[nodiscard]] const StageCounts& stages() const { return stages_; }
    /// Truth of ray i by the convention of a form.
    [[nodiscard]] Truth truth(std::size_t i, intersect::Convention convention) const;
    /// Truth of ray i for one primitive, as if there were no other.
    [[nodiscard]] Truth truth_of_primitive(std::size_t i, std::size_t primitive,
                                           intersect::Convention convention) const;
    /// True if the truth of ray i by the convention may differ from that of `truths`: the ray touches a primitive,
    /// starts in or on a primitive, or ends where the convention matters, or only one side counts.
    [[nodiscard]] bool may_differ(std::size_t i, intersect::Convention convention) const;
    /// Truth of every ray by the closed primitive's convention.
    [[nodiscard]] const RayTruths& truths() const { return truths_; }
    /// Truth of ray i (a hit), correctly rounded to the format: as t, or as a distance.
    [[nodiscard]] double rounded_truth(std::size_t i, const FloatFormat& format, intersect::Direction direction,
                                       intersect::Convention convention) const;

private:
    void find_all_truths();
    [[nodiscard]] bool is_ray_unrounded(const FormatInputs& inputs, std::size_t i) const;
    [[nodiscard]] bool is_primitive_unrounded(const FormatInputs& inputs, std::size_t k) const;
    /// True if it is proved that ray i first hits a side that counts (`facing`).
    [[nodiscard]] bool first_hit_faces(std::size_t i, intersect::Facing facing) const;

    [[nodiscard]] Truth find_ray_truth(std::size_t i, intersect::Convention convention) const;
    [[nodiscard]] double measure_condition(std::size_t i, Truth::Decision decision, int primitive_index,
                                           intersect::Convention convention) const;
    [[nodiscard]] double measure_reach(std::size_t i, const Truth& ray_truth, intersect::Convention convention,
                                       Length length, const FloatFormat& format, Perturbation perturbation) const;
    void find_reach(FormatInputs& in, BandNeeds needs) const;

    culling::Culler* culler_ = nullptr;
    const scene::file::Scene* scene_ = nullptr;  ///< set for own inputs, whose primitives each format rounds itself
    int y0_ = 0, scanlines_ = 0;
    ProofLimit limit_;
    bool binary32_holds_all_ = true;  ///< binary32 holds every shared number
    bool is_paired_ = false;          ///< ray i is tested only against primitive i
    scene::rays::RayBlock shared_;    ///< used if inputs = shared
    scene::rays::PrimitiveList<double> shared_primitives_;
    std::optional<scene::rays::IdealRayBlock> ideal_;  ///< used if inputs = own
    scene::rays::PrimitiveList<Real> ideal_primitives_;
    std::optional<intersect::MarchConstants<double>> shared_march_;
    /// True if a special convention needs a separate truth for ray i.
    [[nodiscard]] bool needs_special_truth(std::size_t i, intersect::Convention convention) const;
    /// Truth of a ray for which `truths().may_differ`. The first call finds it, since few forms have such a convention.
    [[nodiscard]] const Truth& special_truth(std::size_t i, intersect::Convention convention) const;
    template <class Function>
    auto with_ray(std::size_t i, Function&& function) const {
        return ideal_ ? function((*ideal_)[i], ideal_primitives_) : function(shared_[i], shared_primitives_);
    }

    RayTruths truths_;
    StageCounts stages_;
    std::vector<double> condition_;
    /// Truths and conditions that were requested, of rays for which the convention matters. Several threads may compute
    /// the same truth; the first result is stored.
    mutable tbb::concurrent_unordered_map<std::size_t, Truth> special_truths_;
    mutable tbb::concurrent_unordered_map<std::size_t, double> special_conditions_;
};

}  // namespace lostbits::measure::truth
