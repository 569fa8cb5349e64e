// The angle between the normal at the hit point that a form computes and the true normal. The test of the recipe for a
// study adds this file to the list of studies.
#pragma once

#include "analysis/study/number_study.hpp"

namespace lostbits::analysis::study {

/// atan2(|n × n*|, n · n*) for the outward normals n at o + t d and n* at o + t* d, both without rounding.
struct Angle {
    static constexpr const char* name = "angle";
    static constexpr const char* title =
        "Measure the angle between the normal at the computed hit point and the true one";
    static constexpr const char* unit = "unit of --unit";
    static constexpr const char* meaning = "angle between the normal at the computed hit point and the true normal";

    static std::vector<StudyOption> options() {
        return {{"unit", "Unit of the angle: radian (default) or degree", {"radian"}, {"radian", "degree"}}};
    }
    static output::image::ColourScale scale() { return output::pixel::magnitude_scale(0x1p-52, 1); }

    explicit Angle(const StudyValues& values)
        : radians(values.at("unit").front() == "degree" ? std::acos(-1.0) / 180 : 1) {}

    double operator()(const CorrectHit& hit) const {
        const auto normal = [&](const Real& t) {
            const Vec<Real> p(hit.ray().origin + t * hit.ray().direction);
            return visit(hit.primitive(),
                         [&](const auto& shape) { return lift_vec<Real>(shape.outward_normal(hit.ray(), p)); });
        };
        const Vec<Real> n = normal(hit.t()), exact = normal(hit.true_t());
        return Real(atan2(length(cross(n, exact)), dot(n, exact))).convert_to<double>() / radians;
    }

    double radians;  ///< in one unit
};

using AngleAdapter = NumberAdapter<Angle>;

}  // namespace lostbits::analysis::study
