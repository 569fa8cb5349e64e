// One ray, looked at closely.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "measure/answer/mesh_outcomes.hpp"
#include "measure/answer/owners.hpp"
#include "measure/truth/band.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::measure::answer {

/// A pixel of a scene, a ray of one's own among its solids, or a ray with solids of its own, with its truth: what a
/// form in a format is given there.
class OneRay {
public:
    /// The ray of pixel (x, y). InputError where the picture has no such pixel.
    OneRay(const scene::file::Scene& scene, int x, int y, truth::TruthLimit limit = {});
    /// A ray taken as it is given. Where the scene's inputs are shared, each of its numbers is rounded once to
    /// binary64, which most often changes none, and the solids are those of the scene's maps; where each format rounds
    /// its own, the ray is ideal as the scene is. What a format cannot hold it rounds, and that is input error.
    OneRay(const scene::file::Scene& scene, const Ray<Real>& ray, truth::TruthLimit limit = {});
    /// The first ray of a group: as it is stored, with the solids and constants it has there.
    explicit OneRay(scene::rays::RayGroup group);
    /// The ray of pixel (x, y) of a scene whose camera says who makes its rays, and behind it those of the pixels at
    /// most `columns_around` columns and a row away.
    static std::vector<OneRay> pixels_around(const scene::file::Scene& scene, int x, int y,
                                             truth::TruthLimit limit = {});
    static constexpr int columns_around = 10;
    /// Judged by this convention on touching; by each form's own word unless this is called.
    void judge_by(std::optional<intersect::Touching> convention) { judged_ = convention; }
    [[nodiscard]] std::optional<intersect::Touching> judged() const { return judged_; }

    /// What a form in a format receives: the ray as it takes directions, and its target. Valid as long as this is.
    struct Inputs {
        truth::FormatInputs all;
        std::size_t index;
        [[nodiscard]] Ray<double> ray(const intersect::Info& info) const { return all.rays_for(info)[index]; }
    };
    [[nodiscard]] Inputs inputs(const intersect::table::Intersector& form, const Format& format) const;
    /// The operations that make the ray of a camera's pixel; nothing where a format rounds it.
    [[nodiscard]] std::optional<scene::rays::RecordedRay> recorded_ray(const Format& format) const {
        return band_->recorded_ray(index_, format);
    }
    /// Whether a form gets the ray and the solids as they were given: its format rounds none of their numbers.
    [[nodiscard]] bool keeps(const Inputs& inputs) const { return band_->keeps(inputs.all, index_); }
    [[nodiscard]] truth::Truth truth(const intersect::Info& info) const {
        return band_->truth(index_, convention(info));
    }
    /// κ of the true hit; NaN for a miss.
    [[nodiscard]] double condition(const intersect::Info& info) const;
    /// How far half an ulp in each input can move t*, as the form's answer has it, see `truth::reach`; NaN for a miss.
    [[nodiscard]] double reach(const intersect::Info& info, const Format& format) const;
    /// The outcome of answers about these inputs where the solids of a mesh are told apart from others; `before` where
    /// they need not be.
    [[nodiscard]] Outcome outcome(const Inputs& inputs, const Answers& answers, const intersect::Info& info,
                                  Outcome before) const {
        const truth::Truth found = truth(info);
        return outcome_in_mesh({answers, inputs.all, *band_, convention(info)}, index_,
                               found.is_hit() ? found.object : -1, before);
    }
    /// Whether that primitive is among those that the ray truly meets first.
    [[nodiscard]] bool meets_first(std::int32_t primitive, const intersect::Info& info) const {
        return answer::meets_first(*band_, index_, primitive, convention(info));
    }
    /// t* in the unit of the form's answer; for a hit only.
    [[nodiscard]] truth::Certified true_t(const intersect::Info& info) const;
    [[nodiscard]] double rounded_truth(const intersect::Info& info, const FloatFormat& format) const {
        return band_->rounded_truth(index_, format, info.direction, convention(info));
    }

private:
    OneRay(std::shared_ptr<truth::Band> band, std::size_t index) : band_(std::move(band)), index_(index) {}
    [[nodiscard]] intersect::Convention convention(const intersect::Info& info) const {
        return info.convention(judged_);
    }

    /// Of a scene with shared inputs.
    void ask_among(const scene::file::Scene& scene, scene::rays::RayBlock one, truth::TruthLimit limit);

    std::unique_ptr<culling::Culler> culler_;
    std::shared_ptr<truth::Band> band_;  ///< several pixels of a row have one
    std::size_t index_ = 0;
    std::optional<intersect::Touching> judged_;
};

/// The march of a form that marches (`form.log`) along a ray.
intersect::table::MarchLog march_log(const intersect::table::Intersector& form, const Format& format,
                                     const OneRay& ray);

}  // namespace lostbits::measure::answer
