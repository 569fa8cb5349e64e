#include "output/offset/offset_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "measure/offset/offsets.hpp"
#include "output/offset/offset_pictures.hpp"

namespace lostbits::output::offset {

using measure::offset::OffsetRequest;
using measure::offset::OffsetSummary;

std::vector<std::string> row_in_words(const OffsetRequest& request, std::size_t r, const OffsetSummary& summary) {
    std::vector<std::string> lines;
    if (summary.points == 0) return lines;
    const measure::offset::OffsetRow& row = request.rows[r];
    const std::string of = fmt::format("{} {} {}", row.row.form->info->name, row.row.format.name, name_of(row.point));
    for (const measure::offset::Side side : measure::offset::both_sides) {
        const measure::offset::SideSummary& on = summary.on(side);
        std::string right;
        for (std::size_t k = 0; k < request.strategies.size(); ++k) {
            if (on.strategies[k].bad > 0) continue;
            right += fmt::format("{}{}", right.empty() ? "" : ", ", short_name(*request.strategies[k]));
        }
        const double largest = on.safe.quantile(1);
        const std::string safe =
            std::isnan(largest)
                ? fmt::format("no offset is safe at any of {} points", on.never_safe)
                : fmt::format("smallest safe offset up to {:.3g}{}", largest,
                              on.never_safe == 0 ? "" : fmt::format(" ({} points have none)", on.never_safe));
        lines.push_back(fmt::format("{} {}: {}; right for all {} rays: {}", of, name_of(side), safe, on.rays,
                                    right.empty() ? "no strategy" : right));
    }
    const auto safe =
        measure::offset::safe_strategies(summary, request.strategies, row.row.form->shape, measure::offset::both_sides);
    if (!safe.empty())
        lines.push_back(fmt::format("{}: the cheapest that is right on both sides: {}, {} operations", of,
                                    safe.front().strategy->name, safe.front().operations));
    return lines;
}

}  // namespace lostbits::output::offset
