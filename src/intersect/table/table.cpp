#include <algorithm>
#include <string>

#include "intersect/table/rows.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::table {

namespace {

std::vector<Intersector>& all_rows() {
    static std::vector<Intersector> rows = [] {
        std::vector<Intersector> new_rows(form_count);
        fill_batches(new_rows);
        fill_by_ray(new_rows);
        return new_rows;
    }();
    return rows;
}

}  // namespace

std::span<const Intersector> intersectors() { return all_rows(); }

std::span<const Intersector> catalogue() { return intersectors().first(form_count); }

void register_intersectors(const std::vector<Intersector>& rows) {
    for (const Intersector& form : rows) {
        const auto has_same_name = [&form](const Intersector& other) { return other.info->name == form.info->name; };
        if (std::ranges::any_of(all_rows(), has_same_name))
            throw InputError(
                std::string(form.info->name) +
                ": two forms have this name; they come from two libraries, from one that is named twice, or from a "
                "library and lostbits; load one of them, or add a prefix to the names of a library: --plugin new=PATH "
                "calls its forms new.FORM");
        all_rows().push_back(form);
    }
}

std::span<const Intersector> intersectors(Shape shape) {
    const auto all = catalogue();
    const auto first = std::ranges::find(all, shape, &Intersector::shape);
    const auto last = std::find_if(first, all.end(), [shape](const Intersector& i) { return i.shape != shape; });
    return {first, last};
}

}  // namespace lostbits::intersect::table
