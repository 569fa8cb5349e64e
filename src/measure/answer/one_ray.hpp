// One ray with its primitives and its truth, for the commands that explain a single ray.
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

/// One ray, its primitives and its truth. It provides the inputs of each form in each format. The ray is a pixel of a
/// scene, a given ray among the primitives of a scene, or a ray that brings its own primitives.
class OneRay {
public:
    /// Takes the ray of pixel (x, y). Throws InputError if the picture has no such pixel.
    OneRay(const scene::file::Scene& scene, int x, int y, truth::ProofLimit limit = {});
    /// Takes a given ray among the primitives of a scene. If the scene's inputs are shared, each number of the ray is
    /// rounded once to binary64, which usually changes none of them, and the primitives are those of the scene's maps.
    /// If each format rounds its own inputs, the ray is ideal as the scene is, and the change when a format rounds it
    /// counts as an error of the input.
    OneRay(const scene::file::Scene& scene, const Ray<Real>& ray, truth::ProofLimit limit = {});
    /// Takes the first ray of a group as it is stored, with its own primitives and constants.
    explicit OneRay(scene::rays::RayGroup group);
    /// Makes the ray of pixel (x, y) of a scene whose camera names a ray generator. The other rays of the result are
    /// those of the pixels at most `columns_around` columns and one row away.
    static std::vector<OneRay> make_pixels_around(const scene::file::Scene& scene, int x, int y,
                                                  truth::ProofLimit limit = {});
    static constexpr int columns_around = 10;
    /// Sets the touching convention that the ray is judged by; by default each form is judged by its own.
    void set_touching(std::optional<intersect::Touching> convention) { touching_ = convention; }
    [[nodiscard]] std::optional<intersect::Touching> touching() const { return touching_; }

    /// Inputs of a form in a format: the ray, for the form's kind of direction, and its target. Valid as long as the
    /// OneRay is.
    struct Inputs {
        truth::FormatInputs format_inputs;  ///< inputs of the band that has the ray
        std::size_t index;                  ///< index of the ray in the band
        [[nodiscard]] Ray<double> ray(const intersect::Info& info) const { return format_inputs.rays_for(info)[index]; }
    };
    [[nodiscard]] Inputs inputs(const intersect::table::Intersector& form, const Format& format) const;
    /// Operations that make the ray of a camera's pixel; empty if the ray is rounded to the format.
    [[nodiscard]] std::optional<scene::rays::RecordedRay> recorded_ray(const Format& format) const {
        return band_->recorded_ray(index_, format);
    }
    /// True if the format rounds none of the numbers of the ray and the primitives, so that a form gets these numbers
    /// as given.
    [[nodiscard]] bool is_unrounded(const Inputs& inputs) const {
        return band_->is_unrounded(inputs.format_inputs, index_);
    }
    [[nodiscard]] truth::Truth find_truth(const intersect::Info& info) const {
        return band_->truth(index_, convention(info));
    }
    /// κ of the true hit; NaN for a miss.
    [[nodiscard]] double condition(const intersect::Info& info) const;
    /// Largest change of t*, in the unit of the form's answer, that half an ulp in each input can cause, see
    /// `truth::reach`; NaN for a miss.
    [[nodiscard]] double reach(const intersect::Info& info, const Format& format) const;
    /// Outcome of answers to these inputs, including the outcomes that only meshes have. Returns `plain_outcome` if the
    /// primitives have no mesh or the ray truly misses.
    [[nodiscard]] Outcome outcome(const Inputs& inputs, const Answers& answers, const intersect::Info& info,
                                  Outcome plain_outcome) const {
        const truth::Truth ray_truth = find_truth(info);
        return ray_truth.is_hit() ? outcome_in_mesh({answers, inputs.format_inputs, *band_, convention(info)}, index_,
                                                    ray_truth.primitive, plain_outcome)
                                  : plain_outcome;
    }
    /// True if the ray truly meets this primitive first, alone or together with others.
    [[nodiscard]] bool meets_first(std::int32_t primitive, const intersect::Info& info) const {
        return answer::meets_first(*band_, index_, primitive, convention(info));
    }
    /// t* in the unit of the form's answer; for a hit only.
    [[nodiscard]] truth::CertifiedNumber true_t(const intersect::Info& info) const;
    [[nodiscard]] double rounded_truth(const intersect::Info& info, const FloatFormat& format) const {
        return band_->rounded_truth(index_, format, info.direction, convention(info));
    }

private:
    OneRay(std::shared_ptr<truth::Band> band, std::size_t index) : band_(std::move(band)), index_(index) {}
    [[nodiscard]] intersect::Convention convention(const intersect::Info& info) const {
        return info.convention(touching_);
    }

    /// Builds the band of a scene with shared inputs.
    void make_band(const scene::file::Scene& scene, scene::rays::RayBlock ray, truth::ProofLimit limit);

    std::unique_ptr<culling::Culler> culler_;
    std::shared_ptr<truth::Band> band_;  ///< pixels of the same row share one
    std::size_t index_ = 0;
    std::optional<intersect::Touching> touching_;
};

/// Records the march of a form that marches (`form.log`) along a ray.
intersect::table::MarchLog record_march(const intersect::table::Intersector& form, const Format& format,
                                        const OneRay& ray);

}  // namespace lostbits::measure::answer
