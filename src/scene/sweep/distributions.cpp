#include "scene/sweep/distributions.hpp"

// clang-format off
#define LOSTBITS_SHAPE_FILE(folder) LOSTBITS_PATH(shapes/folder/distribution/distribution.hpp)
// clang-format on
#include "shapes/list.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::scene::sweep {
namespace {

template <class F>
Drawer make_drawer(toml::TableReader table) {
    return [distribution = F::read(table)](std::uint64_t seed_offset) mutable {
        distribution.seed += seed_offset;
        return distribution.draw();
    };
}

template <class F>
constexpr DistributionRow row_of(Shape shape) {
    DistributionRow distribution_row{.shape = shape,
                                     .table = F::table,
                                     .read = make_drawer<F>,
                                     .ray_sets = F::ray_sets,
                                     .draw_timed_rays = F::draw_timed_rays};
    if constexpr (requires { F::aims; }) distribution_row.aims = F::aims, distribution_row.draw_target = F::draw_target;
    return distribution_row;
}

}  // namespace

std::span<const DistributionRow> distributions() {
#define LOSTBITS_LINE(folder, S) row_of<folder::S##Distribution>(shape_as<S>),
    static constexpr DistributionRow rows[] = {LOSTBITS_SHAPES(LOSTBITS_LINE)};
#undef LOSTBITS_LINE
    return rows;
}

std::string distribution_tables_text() {
    std::string text;
    for (const DistributionRow& distribution_row : distributions()) {
        const bool is_last = &distribution_row == &distributions().back();
        if (!text.empty()) text += is_last ? " and " : ", ";
        text += "[" + std::string(distribution_row.table) + "]";
    }
    return text;
}

}  // namespace lostbits::scene::sweep
