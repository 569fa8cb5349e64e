// Names of forms and of tested forms (forms in formats) in pictures and file names, and their cells in a table of forms
// by formats.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "scene/rays/composed_forms.hpp"

namespace lostbits::output::map {

using intersect::Info;
using measure::evaluate::TestedForm;

/// True if a form belongs to the catalogue. Names in the catalogue begin with a shape; names from outside do not.
[[nodiscard]] inline bool is_in_catalogue(const Info& info) {
    return std::ranges::find(shape_names, info.name.substr(0, info.name.find('.'))) != shape_names.end();
}

/// Name of a form without its shape, for tables whose forms all have one shape: `unified` for `sphere.unified`. Forms
/// outside the catalogue and sets keep their whole names.
[[nodiscard]] inline std::string short_name(const Info& info) {
    const bool is_single_form = is_in_catalogue(info) && info.name.find('.') == info.name.rfind('.');
    return std::string(info.name.substr(is_single_form ? info.name.find('.') + 1 : 0));
}

/// Title of a form for captions. A form from outside the catalogue need not have a title; its source stands in then.
[[nodiscard]] inline std::string title_of(const Info& info) {
    if (!info.title.empty()) return std::string(info.title);
    return info.source.empty() ? "a form from outside" : "a form from outside: " + std::string(info.source);
}

/// Name of a tested form in file names: `sphere.unified.f32`.
[[nodiscard]] inline std::string tested_form_name(const TestedForm& tested_form) {
    return std::string(tested_form.form->info->name) + "." + tested_form.format.name;
}

/// A name in words: `wrong primitive` for `wrong_primitive`.
[[nodiscard]] inline std::string name_in_words(std::string_view name) {
    std::string text(name);
    std::ranges::replace(text, '_', ' ');
    return text;
}

/// Index of a name in a list; a new name is appended.
[[nodiscard]] inline std::size_t find_or_add(std::vector<std::string>& names, const std::string& name) {
    const auto index = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    if (index == names.size()) names.push_back(name);
    return index;
}

/// Properties of a tested form that its true answers depend on. Tested forms with equal properties share the truth of
/// every ray.
struct TruthKey {
    intersect::Direction direction;
    intersect::Convention convention;
    const scene::camera::RayGenerator* generator;  ///< its ideal rays may have other origins
    friend bool operator==(const TruthKey&, const TruthKey&) = default;
};
[[nodiscard]] inline TruthKey truth_key(const TestedForm& tested_form) {
    return {tested_form.form->info->direction, tested_form.convention(), scene::rays::generator_of(*tested_form.form)};
}

/// Grid with forms across and formats down, both in the order of the first tested form that has them.
struct FormGrid {
    /// Indices of the form and the format of a tested form in the grid.
    struct GridCell {
        std::size_t form_index, format_index;
    };
    std::vector<std::string> forms, formats;
    std::vector<GridCell> cells;  ///< one per tested form

    explicit FormGrid(const std::vector<TestedForm>& tested_forms) {
        for (const TestedForm& tested_form : tested_forms)
            cells.push_back({find_or_add(forms, short_name(*tested_form.form->info)),
                             find_or_add(formats, tested_form.format.name)});
    }
};

}  // namespace lostbits::output::map
