// Points of a scene as computed by one form in one format.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "measure/offset/at_point.hpp"
#include "measure/rows.hpp"

namespace lostbits::test {

/// Points of a scene as computed by one form in one format, and the questions about them.
struct ScenePoints {
    scene::file::Scene scene;
    measure::evaluate::TestedForm of;
    scene::rays::PrimitiveList<double> primitives;
    std::vector<measure::offset::FormHit> met;

    ScenePoints(const std::string& name, std::string_view form, std::string_view format)
        : scene(load(name)), of(row(form, format)) {
        const measure::truth::Band band(scene, 0, scene.height);
        const auto inputs = band.inputs(of.format, {});
        primitives = inputs.primitives;
        const auto answers = measure::answer::evaluate(*of.form, inputs);
        for (std::size_t i = 0; i < answers.t.size(); ++i) {
            if (answers.hit[i] != 0 && answers.t[i] > 0)
                met.push_back({inputs.rays[i], answers.t[i], static_cast<std::size_t>(answers.primitive[i])});
        }
    }
};

}  // namespace lostbits::test
