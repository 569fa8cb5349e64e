// One ray of a scene, looked at closely.
#pragma once

#include <memory>
#include <optional>

#include "measure/answer/outcome.hpp"
#include "measure/truth/band.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::measure::answer {

/// A pixel of a scene, or a ray of one's own among its solids, with its truth: what a form in a format is given there.
class OneRay {
public:
    /// The ray of pixel (x, y). InputError where the picture has no such pixel.
    OneRay(const scene::file::Scene& scene, int x, int y);
    /// `ray` is stored as it is; the scene's inputs must be shared (InputError otherwise: an ideal ray has no stored
    /// numbers).
    OneRay(const scene::file::Scene& scene, const Ray<double>& ray);

    /// What a form in a format receives: the ray as it takes directions, and its target. Valid as long as this is.
    struct Inputs {
        truth::FormatInputs all;
        std::size_t index;
        [[nodiscard]] Ray<double> ray(const intersect::Info& info) const { return all.rays_for(info)[index]; }
    };
    [[nodiscard]] Inputs inputs(const intersect::table::Intersector& form, const Format& format) const;
    /// By the form's own convention.
    [[nodiscard]] const truth::Truth& truth(const intersect::Info& info) const {
        return band_->truth(index_, info.convention());
    }
    /// κ of the true hit; NaN for a miss.
    [[nodiscard]] double condition(const intersect::Info& info) const;
    /// t* in the unit of the form's answer; for a hit only.
    [[nodiscard]] const truth::Certified& true_t(const intersect::Info& info) const;
    [[nodiscard]] double rounded_truth(const intersect::Info& info, const FloatFormat& format) const {
        return band_->rounded_truth(index_, format, info.direction, info.convention());
    }

private:
    std::unique_ptr<truth::Band> band_;
    std::size_t index_ = 0;
};

/// The march of a form that marches (`form.log`) along a ray.
intersect::table::MarchLog march_log(const intersect::table::Intersector& form, const Format& format,
                                     const OneRay& ray);

}  // namespace lostbits::measure::answer
