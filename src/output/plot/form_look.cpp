#include "output/plot/form_look.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>

#include "output/plot/line_plot_parts.hpp"
#include "output/shard/state_file.hpp"

namespace lostbits::output::plot {

namespace {

/// Looks by number: those of forms for one shape, which never appear beside forms for another shape; those of marches,
/// which do; and the free ones, for forms from outside. The numbers come from the table at run time, so that this file
/// is not compiled again when a form changes.
struct LookRanges {
    std::size_t first_march = 0, first_free = 0;

    LookRanges() {
        std::map<Shape, std::size_t> counts;
        for (const auto& catalogue_row : intersect::table::catalogue()) ++counts[catalogue_row.shape];
        std::size_t marches = 0;
        for (const auto& [shape, count] : counts) {
            std::size_t& most = is_primitive(shape) ? first_march : marches;
            most = std::max(most, count);
        }
        first_free = first_march + marches;
        if (first_free >= look_count)
            throw std::logic_error("more colours and markers are needed: forms from outside need some too");
    }
};

std::uint64_t hash_of(std::string_view name) {
    shard::InputHash hash;
    hash.add(name);
    return hash.value();
}

}  // namespace

std::size_t form_look(const intersect::table::Intersector& form) {
    const auto forms = intersect::table::intersectors(), catalogue_forms = intersect::table::catalogue();
    static const LookRanges ranges;
    std::size_t look = is_primitive(form.shape) ? 0 : ranges.first_march;
    for (const auto& catalogue_row : catalogue_forms) {
        if (catalogue_row.info == form.info) return look;
        look += catalogue_row.shape == form.shape;
    }
    const std::size_t free_looks = look_count - ranges.first_free;
    std::set<std::size_t> taken_looks;
    for (const auto& catalogue_row : forms.subspan(catalogue_forms.size())) {
        std::size_t free_look = hash_of(catalogue_row.info->name) % free_looks;
        while (taken_looks.contains(free_look) && taken_looks.size() < free_looks)
            free_look = (free_look + 1) % free_looks;
        taken_looks.insert(free_look);
        if (catalogue_row.info == form.info) return ranges.first_free + free_look;
    }
    return ranges.first_free + hash_of(form.info->name) % free_looks;
}

}  // namespace lostbits::output::plot
