// Prints notes about numbers of scenes, sweeps and cases that vanish or overflow in a format, and about settings that
// change nothing.
#include "analysis/selection/select.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "output/file/number_text.hpp"
#include "scene/file/march_table.hpp"
#include "scene/rays/unrepresentable_lengths.hpp"

namespace lostbits::analysis::selection {

using measure::evaluate::TestedForm;
using scene::rays::RayGroup;
using scene::rays::UnrepresentableLengths;

namespace {

std::vector<Format> distinct_formats(const std::vector<TestedForm>& tested_forms) {
    std::vector<Format> formats;
    for (const TestedForm& tested_form : tested_forms) {
        if (std::ranges::find(formats, tested_form.format) == formats.end()) formats.push_back(tested_form.format);
    }
    return formats;
}

void print_unrepresentable(const std::string& id, const Format& format, const std::vector<std::string>& lost) {
    for (const std::string& line : lost) fmt::print(stderr, "lostbits: {} in {}: {}\n", id, format.name, line);
}

/// `distance = 4, height = 1`
std::string position_text(const scene::sweep::SweepFile& sweep, const std::vector<double>& values) {
    std::string text;
    for (std::size_t a = 0; a < values.size(); ++a) {
        text += (a > 0 ? ", " : "") + sweep.axes[a].name + " = " + output::file::decimal(values[a]);
    }
    return text;
}

bool marches(const TestedForm& tested_form) { return !is_primitive(tested_form.form->shape); }

bool marches_in(const Format& format, const std::vector<TestedForm>& tested_forms) {
    return std::ranges::any_of(tested_forms, [&](const TestedForm& tested_form) {
        return marches(tested_form) && tested_form.format == format;
    });
}

void add_unrepresentable_numbers(const RayGroup& group, bool includes_march,
                                 const UnrepresentableLengths::DescribePosition& where, UnrepresentableLengths& lost) {
    lost.add_point(group.rays[0].origin, "a coordinate of the eye", where);
    for (const Primitive<double>& primitive : group.primitives) lost.add(primitive, where);
    if (!includes_march || !group.march) return;
    std::size_t i = 0;
    // `convert_numbers` calls the function for each number; its result is not needed.
    convert_numbers(*group.march, [&](double x) {
        lost.add_number(x, "march." + std::string(intersect::march_number_names[i++]), where);
        return x;
    });
}

}  // namespace

void note_unrepresentable_numbers(const scene::file::Scene& scene, const std::vector<TestedForm>& tested_forms) {
    for (const Format& format : distinct_formats(tested_forms)) {
        print_unrepresentable(scene.id, format, scene::rays::find_unrepresentable_lengths(scene, format.parameters));
        if (!marches_in(format, tested_forms)) continue;
        for (const std::string& lost : scene::file::find_unrepresentable_constants(scene, format.parameters))
            print_unrepresentable(scene.id, format, {"march." + lost});
    }
}

void note_unrepresentable_numbers(const scene::sweep::SweepFile& sweep, const std::vector<TestedForm>& tested_forms,
                                  intersect::process::StopToken stop) {
    const std::vector<Format> formats = distinct_formats(tested_forms);
    std::vector<UnrepresentableLengths> lost;
    std::vector<bool> includes_march;
    for (const Format& format : formats) {
        lost.emplace_back(format.parameters);
        includes_march.push_back(marches_in(format, tested_forms));
    }

    // Visits every step, on one axis or two.
    const std::vector<double> no_second_axis{0};
    const bool has_two_axes = sweep.axes.size() > 1;
    for (const double first : sweep.axes.front().values) {
        for (const double second : has_two_axes ? sweep.axes[1].values : no_second_axis) {
            stop.check();
            const std::vector<double> values = has_two_axes ? std::vector{first, second} : std::vector{first};
            const auto where = [&] { return position_text(sweep, values); };
            for (const RayGroup& group : sweep.rays(values)) {
                for (std::size_t i = 0; i < lost.size(); ++i)
                    add_unrepresentable_numbers(group, includes_march[i], where, lost[i]);
            }
        }
    }

    for (std::size_t i = 0; i < formats.size(); ++i) print_unrepresentable(sweep.id, formats[i], lost[i].lines());
}

void note_unrepresentable_numbers(const scene::sweep::CaseFile& file, const std::vector<TestedForm>& tested_forms) {
    for (const Format& format : distinct_formats(tested_forms)) {
        UnrepresentableLengths lost(format.parameters);
        for (std::size_t i = 0; i < file.size(); ++i) {
            const std::vector<RayGroup> unrounded = file.unrounded_rays(i, format.parameters),
                                        rounded = file.rays(i, format.parameters);
            for (std::size_t g = 0; g < rounded.size(); ++g) {
                for (std::size_t s = 0; s < rounded[g].primitives.size(); ++s)
                    lost.add(unrounded[g].primitives[s], rounded[g].primitives[s],
                             [&] { return "case \"" + file.name(i) + "\""; });
            }
        }
        print_unrepresentable(file.id, format, lost.lines());
    }
}

void note_ineffective_settings(const std::vector<std::string>& set, const std::string& id,
                               const std::vector<TestedForm>& tested_forms) {
    if (std::ranges::any_of(tested_forms, marches)) return;
    for (const std::string& assignment : set) {
        if (assignment.starts_with("march."))
            fmt::print(stderr,
                       "lostbits: --set {}: changes nothing in {} because no selected form marches; add -i 'sdf.*'\n",
                       assignment, id);
    }
}

void warn_of_ineffective_numbers(const scene::file::Scene& scene, const std::vector<std::string>& set,
                                 const std::vector<TestedForm>& tested_forms, bool quiet) {
    if (quiet) return;
    note_unrepresentable_numbers(scene, tested_forms);
    note_ineffective_settings(set, scene.id, tested_forms);
}

}  // namespace lostbits::analysis::selection
