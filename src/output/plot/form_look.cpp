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

/// Ranges of looks. The first range is for forms of primitives: forms for different shapes share it, because they never
/// appear in one plot. Then come the looks of marches, which appear beside them, and the free looks, for forms from
/// outside. The sizes come from the table at run time, so that this file is not compiled again when a form changes.
struct LookRanges {
    std::size_t first_march = 0, first_free = 0;  ///< where the second and the third range begin

    LookRanges() {
        std::map<Shape, std::size_t> counts;
        for (const auto& known : intersect::table::catalogue()) ++counts[known.shape];
        std::size_t march_count = 0;
        for (const auto& [shape, count] : counts) {
            std::size_t& most = is_primitive(shape) ? first_march : march_count;
            most = std::max(most, count);
        }
        first_free = first_march + march_count;
        if (first_free >= look_count)
            throw std::logic_error(
                "the forms of the catalogue use all colours and markers, and forms from outside need some too; add "
                "markers");
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

    // A form of the catalogue has the look of its line among the forms of its shape.
    std::size_t look = is_primitive(form.shape) ? 0 : ranges.first_march;
    for (const auto& known : catalogue_forms) {
        if (known.info == form.info) return look;
        look += known.shape == form.shape;
    }

    // A form from outside has the free look of its hash, or the next one that no earlier form from outside has.
    const std::size_t free_look_count = look_count - ranges.first_free;
    std::set<std::size_t> used_looks;
    for (const auto& outside_form : forms.subspan(catalogue_forms.size())) {
        std::size_t free_look = hash_of(outside_form.info->name) % free_look_count;
        while (used_looks.contains(free_look) && used_looks.size() < free_look_count)
            free_look = (free_look + 1) % free_look_count;
        used_looks.insert(free_look);
        if (outside_form.info == form.info) return ranges.first_free + free_look;
    }
    return ranges.first_free + hash_of(form.info->name) % free_look_count;
}

}  // namespace lostbits::output::plot
