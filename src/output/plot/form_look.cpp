#include "output/plot/form_look.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <span>
#include <string_view>

#include "intersect/catalogue.hpp"
#include "output/plot/line_plot_parts.hpp"
#include "output/shard/state_file.hpp"

namespace lostbits::output::plot {

namespace {

// Marches appear beside the forms for one shape. Forms for two shapes never appear beside each other.
constexpr std::size_t first_march = std::ranges::max(std::span(intersect::form_counts).first<shape_rows.size()>());
constexpr std::size_t first_free = first_march + intersect::SdfForms::size;
static_assert(first_free < look_count, "more colours and markers are needed: forms from outside need some too");

std::uint64_t hash_of(std::string_view name) {
    shard::InputHash hash;
    hash.add(name);
    return hash.value();
}

}  // namespace

std::size_t form_look(const intersect::table::Intersector& form) {
    const auto forms = intersect::table::intersectors(), catalogue_forms = intersect::table::catalogue();
    std::size_t look = is_primitive(form.shape) ? 0 : first_march;
    for (const auto& catalogue_row : catalogue_forms) {
        if (catalogue_row.info == form.info) return look;
        look += catalogue_row.shape == form.shape;
    }
    constexpr std::size_t free_looks = look_count - first_free;
    std::set<std::size_t> taken_looks;
    for (const auto& catalogue_row : forms.subspan(catalogue_forms.size())) {
        std::size_t free_look = hash_of(catalogue_row.info->name) % free_looks;
        while (taken_looks.contains(free_look) && taken_looks.size() < free_looks)
            free_look = (free_look + 1) % free_looks;
        taken_looks.insert(free_look);
        if (catalogue_row.info == form.info) return first_free + free_look;
    }
    return first_free + hash_of(form.info->name) % free_looks;
}

}  // namespace lostbits::output::plot
