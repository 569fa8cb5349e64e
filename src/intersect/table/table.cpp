#include <algorithm>
#include <string>
#include <vector>

#include "intersect/table/fill_forms.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::table {

namespace {

/// The forms of the catalogue, then those that are registered.
struct AllRows {
    std::vector<Intersector> forms;
    std::size_t catalogue_size;

    AllRows() {
        append_forms<FirstForms>(forms);
        append_forms<SecondForms>(forms);
        fill_by_ray<SecondForms>(fill_by_ray<FirstForms>(forms));
        catalogue_size = forms.size();
    }
};

AllRows& all_rows() {
    static AllRows rows;
    return rows;
}

}  // namespace

std::span<const Intersector> intersectors() { return all_rows().forms; }

std::span<const Intersector> catalogue() { return intersectors().first(all_rows().catalogue_size); }

void register_intersectors(const std::vector<Intersector>& forms) {
    for (const Intersector& form : forms) {
        const auto has_same_name = [&form](const Intersector& other) { return other.info->name == form.info->name; };
        if (std::ranges::any_of(intersectors(), has_same_name))
            throw InputError(
                std::string(form.info->name) +
                ": two forms have this name; they come from two libraries, from one that is named twice, or from a "
                "library and lostbits; load one of them, or add a prefix to the names of a library: --plugin new=PATH "
                "calls its forms new.FORM");
        all_rows().forms.push_back(form);
    }
}

std::span<const Intersector> intersectors(Shape shape) {
    const auto all = catalogue();
    const auto first = std::ranges::find(all, shape, &Intersector::shape);
    const auto last = std::find_if(first, all.end(), [shape](const Intersector& form) { return form.shape != shape; });
    return {first, last};
}

}  // namespace lostbits::intersect::table
