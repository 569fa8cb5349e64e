// Rows, metrics and files for tests that loop over them.
#pragma once

#include <tbb/global_control.h>

#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "intersect/table/sets.hpp"
#include "measure/answer/steps.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "scene/file/scene.hpp"
#include "scratch.hpp"

namespace lostbits::test {

inline const intersect::table::Intersector& form_named(std::string_view name) {
    for (const intersect::table::Intersector& form : intersect::table::intersectors()) {
        if (form.info->name == name) return form;
    }
    if (const auto plus = name.find('+'); plus != std::string_view::npos)
        return intersect::table::find_or_add_set(
            {&form_named(name.substr(0, plus)), &form_named(name.substr(plus + 1))});
    throw std::logic_error("no form " + std::string(name));
}

/// A scene of the data by its name, `file.variant` too, in that size.
inline scene::file::Scene scene_named(const std::string& name, std::optional<std::pair<int, int>> size = {}) {
    const auto found = scene::file::find_scene(name, LOSTBITS_DATA_DIR);
    return std::move(scene::file::load_scene(found.path, {.variant = found.variant, .size = size}).front());
}

inline scene::file::Scene load(const std::string& name, int width = 12, int height = 9) {
    return scene_named(name, std::pair{width, height});
}

inline measure::evaluate::TestedForm row(std::string_view form, std::string_view format) {
    return {&form_named(form), find_format(format).value()};
}

/// Every form of the shape in each of these formats in which it exists.
inline std::vector<measure::evaluate::TestedForm> all_rows(Shape shape,
                                                           std::initializer_list<std::string_view> formats) {
    std::vector<measure::evaluate::TestedForm> tested_forms;
    for (const std::string_view name : formats) {
        const Format format = find_format(name).value();
        for (const intersect::table::Intersector& form : intersect::table::intersectors(shape)) {
            if (form.exists_in(format)) tested_forms.push_back({&form, format});
        }
    }
    return tested_forms;
}

/// The t that a form returns for one ray and one primitive alone; empty for a miss.
inline std::optional<double> evaluate_alone(const measure::evaluate::TestedForm& row, const Ray<double>& ray,
                                            const Primitive<double>& primitive, double tmax = HUGE_VAL) {
    return measure::answer::evaluate_one(*row.form, row.format, ray, primitive, tmax);
}

inline const std::vector<const measure::metric::Metric*> case_metrics{measure::metric::find_metric("lost_bits"),
                                                                      measure::metric::find_metric("excess_bits")};

/// A TOML file that is removed after the test.
struct TextFile : test::ScratchFile {
    explicit TextFile(const std::string& text) : ScratchFile("t.toml", text) {}
};

/// Limits the number of threads while it lives.
struct Threads {
    explicit Threads(std::size_t count) : control(tbb::global_control::max_allowed_parallelism, count) {}
    tbb::global_control control;
};

}  // namespace lostbits::test
