// How forms and rows are called in pictures and file names, and their places in a table of forms by formats.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::output::map {

/// Whether a form is of the catalogue, whose names begin with a shape; no name from outside does.
[[nodiscard]] inline bool is_of_catalogue(const intersect::Info& info) {
    return std::ranges::find(shape_names, info.name.substr(0, info.name.find('.'))) != shape_names.end();
}

/// `unified` of `sphere.unified`: where all forms are of one shape. What is not of the catalogue keeps its whole name,
/// and so does a set.
[[nodiscard]] inline std::string short_name(const intersect::Info& info) {
    const bool is_alone = is_of_catalogue(info) && info.name.find('.') == info.name.rfind('.');
    return std::string(info.name.substr(is_alone ? info.name.find('.') + 1 : 0));
}

/// What a form says of itself, for captions; one from outside need not say anything.
[[nodiscard]] inline std::string title_of(const intersect::Info& info) {
    if (!info.title.empty()) return std::string(info.title);
    return info.source.empty() ? "a form from outside" : "a form from outside: " + std::string(info.source);
}

/// `sphere.unified.f32`
[[nodiscard]] inline std::string row_name(const measure::evaluate::TestedForm& row) {
    return std::string(row.form->info->name) + "." + row.format.name;
}

/// The place of a name in a list, at the end of which a new one is put.
[[nodiscard]] inline std::size_t find_or_add(std::vector<std::string>& names, const std::string& name) {
    const auto at = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    if (at == names.size()) names.push_back(name);
    return at;
}

/// Forms across, formats down, both in the order in which the rows have them first.
struct RowGrid {
    struct Place {
        std::size_t form, format;
    };
    std::vector<std::string> forms, formats;
    std::vector<Place> places;  ///< one a row

    explicit RowGrid(const std::vector<measure::evaluate::TestedForm>& rows) {
        for (const measure::evaluate::TestedForm& row : rows)
            places.push_back({find_or_add(forms, short_name(*row.form->info)), find_or_add(formats, row.format.name)});
    }
};

}  // namespace lostbits::output::map
