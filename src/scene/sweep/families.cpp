#include "scene/sweep/families.hpp"

// clang-format off
#define LOSTBITS_SHAPE_FILE(folder) LOSTBITS_PATH(shapes/folder/family/family.hpp)
// clang-format on
#include "shapes/list.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::scene::sweep {
namespace {

template <class F>
Drawer drawer(toml::TableReader table) {
    return [family = F::read(table)](std::uint64_t further) mutable {
        family.seed += further;
        return family.draw();
    };
}

template <class F>
constexpr FamilyRow row_of(Shape shape) {
    FamilyRow row{.shape = shape, .table = F::table, .read = drawer<F>, .sets = F::sets, .timed = F::timed};
    if constexpr (requires { F::aims; }) row.aims = F::aims, row.aimed_at = F::aimed_at;
    return row;
}

}  // namespace

std::span<const FamilyRow> families() {
#define LOSTBITS_LINE(folder, S) row_of<folder::S##Family>(shape_as<S>),
    static constexpr FamilyRow rows[] = {LOSTBITS_SHAPES(LOSTBITS_LINE)};
#undef LOSTBITS_LINE
    return rows;
}

std::string tables_of_families() {
    std::string text;
    for (const FamilyRow& row : families()) {
        const bool last = &row == &families().back();
        if (!text.empty()) text += last ? " or " : ", ";
        const std::string shape = with_article(row.shape);
        text += shape.substr(0, shape.find(' ')) + " [" + std::string(row.table) + "]";
    }
    return text + " table";
}

}  // namespace lostbits::scene::sweep
