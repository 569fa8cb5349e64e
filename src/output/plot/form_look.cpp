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

// Marches stand beside the forms for one shape. Forms for two shapes never stand beside each other.
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
    const auto all = intersect::table::intersectors(), own = intersect::table::catalogue();
    std::size_t place = is_primitive(form.shape) ? 0 : first_march;
    for (const auto& row : own) {
        if (row.info == form.info) return place;
        place += row.shape == form.shape;
    }
    constexpr std::size_t left = look_count - first_free;
    std::set<std::size_t> taken;
    for (const auto& row : all.subspan(own.size())) {
        std::size_t look = hash_of(row.info->name) % left;
        while (taken.contains(look) && taken.size() < left) look = (look + 1) % left;
        taken.insert(look);
        if (row.info == form.info) return first_free + look;
    }
    return first_free + hash_of(form.info->name) % left;
}

}  // namespace lostbits::output::plot
