#include "analysis/selection/suspicions.hpp"

#include <fmt/format.h>

#include "intersect/table/table.hpp"

namespace lostbits::analysis::selection {

std::vector<std::string> suspicions_of(
    const std::vector<measure::evaluate::TestedForm>& rows,
    const std::function<std::string(const measure::evaluate::TestedForm&)>& suspicion) {
    const auto own = intersect::table::catalogue();
    std::vector<std::string> lines;
    for (const measure::evaluate::TestedForm& row : rows) {
        if (row.form >= own.data() && row.form < own.data() + own.size()) continue;
        const std::string words = suspicion(row);
        if (!words.empty()) lines.push_back(fmt::format("{} {}: {}", row.form->info->name, row.format.name, words));
    }
    return lines;
}

}  // namespace lostbits::analysis::selection
