// A band of a picture: rays made once, their truth found once, and the same numbers handed to every form and format.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <unordered_map>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "measure/truth/format_inputs.hpp"
#include "measure/truth/truth_columns.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/made_rays.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::truth {

/// Rows [y0, y1) of a scene.
class Band {
public:
    /// Finds the truth of every pixel, in parallel over the pixels. `culler`, of the same scene, spares the solids that
    /// cannot matter; it outlives the band.
    Band(const scene::file::Scene& scene, int y0, int y1, TruthLimit limit = {}, culling::Culler* culler = nullptr);
    /// Rays that are already stored numbers, with their solids: what a step of a sweep evaluates.
    Band(scene::rays::RayBlock rays, std::vector<Solid<double>> solids, TruthLimit limit = {})
        : Band(scene::rays::RayGroup{std::move(rays), std::move(solids)}, limit) {}
    /// `culler`: of the same solids; it must outlive the band.
    explicit Band(scene::rays::RayGroup group, TruthLimit limit = {}, culling::Culler* culler = nullptr);
    /// Ideal rays of one's own among the solids of a scene with own inputs, which outlives the band.
    Band(const scene::file::Scene& scene, scene::rays::IdealRayBlock rays, TruthLimit limit = {});
    /// Ideal rays and solids of one's own; where they are paired, ray i is aimed at solid i alone.
    Band(scene::rays::IdealRayBlock rays, std::vector<Solid<Real>> solids, bool paired, TruthLimit limit = {});
    /// One ray, which is a stored number, among the solids of a scene with shared inputs, which `culler` is of; it
    /// outlives the band.
    Band(const scene::file::Scene& scene, scene::rays::RayBlock one, culling::Culler& culler, TruthLimit limit = {});
    /// The range of ray i, as it was given.
    [[nodiscard]] Range<double> range(std::size_t i) const { return ideal_ ? ideal_->range(i) : shared_.range(i); }
    /// Finds κ of every hit, in parallel.
    void find_condition();
    /// κ of ray i after `find_condition`; NaN for a miss.
    [[nodiscard]] double condition(std::size_t i, intersect::Convention convention) const;
    /// How far errors of the inputs can move the t of ray i, or its distance, see `truth::reach`; NaN for a miss. `of`
    /// says the format, and the answer where it holds it. In units of the power of two of that t, or distance.
    [[nodiscard]] double reach(std::size_t i, intersect::Convention convention, intersect::Direction unit_of,
                               const FormatInputs& of, Perturbed perturbed = Perturbed::componentwise) const;
    /// The inputs of one format; parallel over the pixels where it computes.
    [[nodiscard]] FormatInputs inputs(const Format& format, BandNeeds needs) const;
    /// What a form alone needs of them.
    [[nodiscard]] FormatInputs inputs_for(const Format& format, const intersect::Info& form) const {
        return inputs(format, {.unit_rays = form.direction == intersect::Direction::unit});
    }
    /// Whether ray i and the solids are in `inputs`, which are of this band, as they were given: the format rounded
    /// none of their numbers.
    [[nodiscard]] bool keeps(const FormatInputs& inputs, std::size_t i) const;
    /// Whether all rays and solids are in them so.
    [[nodiscard]] bool keeps_all(const FormatInputs& inputs) const;
    /// Ray i before any format rounds or makes it.
    [[nodiscard]] Ray<Real> true_ray(std::size_t i) const;
    /// The camera whose rays each format makes; null where it rounds them.
    [[nodiscard]] const scene::rays::CameraFrame<Real>* frame() const;
    /// The operations that make ray i in a format; nothing where it rounds them.
    [[nodiscard]] std::optional<scene::rays::RecordedRay> recorded_ray(std::size_t i, const Format& format) const;
    /// Ray i alone as it was given, before any format rounded it, with these of the solids; with all, and the
    /// constants of a march along them, where none is named. Nothing for a pixel of a scene, which its place names, for
    /// an ideal ray, and where it would be more than `most_given` solids.
    [[nodiscard]] std::shared_ptr<const scene::rays::RayGroup> given(std::size_t i, std::set<int> solids) const;
    static constexpr std::size_t most_given = 64;

    [[nodiscard]] int y0() const { return y0_; }
    [[nodiscard]] int rows() const { return rows_; }
    [[nodiscard]] intersect::process::StopToken stop() const { return limit_.stop; }
    [[nodiscard]] std::size_t pixels() const { return truths_.size(); }
    /// Which stages settled the rays, each with each solid that it could meet.
    [[nodiscard]] const StageCounts& stages() const { return stages_; }
    /// The truth of ray i by the convention of a form.
    [[nodiscard]] Truth truth(std::size_t i, intersect::Convention convention) const;
    /// The truth of ray i at one of the solids alone, as if there were no other.
    [[nodiscard]] Truth truth_of_solid(std::size_t i, std::size_t solid, intersect::Convention convention) const;
    /// Whether ray i must be asked anew by a convention that is special: where it starts in a solid or on one, where it
    /// ends, and what it meets where one side counts.
    [[nodiscard]] bool asks_anew(std::size_t i, intersect::Convention convention) const;
    /// That of every ray by the closed solid's convention. Others that are not special can differ on rays of its
    /// `whole` alone.
    [[nodiscard]] const RayTruths& truths() const { return truths_; }
    /// The truth of ray i (a hit), correctly rounded to the format: as t, or as a distance.
    [[nodiscard]] double rounded_truth(std::size_t i, const FloatFormat& format, intersect::Direction unit_of,
                                       intersect::Convention convention) const;

private:
    void find_truth_of_all();
    [[nodiscard]] bool keeps_ray(const FormatInputs& inputs, std::size_t i) const;
    [[nodiscard]] bool keeps_solid(const FormatInputs& inputs, std::size_t k) const;
    /// Whether what ray i truly meets first is proved to be met from a side that counts.
    [[nodiscard]] bool shows_side(std::size_t i, intersect::Facing facing) const;

    [[nodiscard]] Truth find_truth_of(std::size_t i, intersect::Convention convention) const;
    [[nodiscard]] double condition_of(std::size_t i, Truth::Decision decision, int object,
                                      intersect::Convention convention) const;
    [[nodiscard]] double reach_of(std::size_t i, const Truth& found, intersect::Convention convention, Length length,
                                  const FloatFormat& format, Perturbed perturbed) const;
    void find_reach(FormatInputs& in, BandNeeds needs) const;

    culling::Culler* culler_ = nullptr;
    const scene::file::Scene* scene_ = nullptr;  ///< for own inputs, whose solids each format rounds itself
    int y0_ = 0, rows_ = 0;
    TruthLimit limit_;
    bool in_binary32_ = true;       ///< every shared number is one of binary32
    bool paired_ = false;           ///< ray i is aimed at solid i alone
    scene::rays::RayBlock shared_;  ///< inputs = shared
    scene::rays::SolidList<double> shared_solids_;
    std::optional<scene::rays::IdealRayBlock> ideal_;  ///< inputs = own
    scene::rays::SolidList<Real> ideal_solids_;
    std::optional<intersect::MarchConstants<double>> shared_march_;
    /// A truth by a convention that differs from the closed solid's.
    struct Apart {
        Truth truth;
        double condition = 0;
    };
    /// Where the convention makes a difference on ray i; else null.
    [[nodiscard]] const Apart* find_apart(std::size_t i, intersect::Convention convention) const;
    template <class Function>
    auto with_ray(std::size_t i, Function&& function) const {
        return ideal_ ? function((*ideal_)[i], ideal_solids_) : function(shared_[i], shared_solids_);
    }

    RayTruths truths_;
    StageCounts stages_;
    std::vector<double> condition_;
    std::unordered_map<std::size_t, Apart> apart_;  ///< by `key_of`, where the convention makes a difference
};

}  // namespace lostbits::measure::truth
