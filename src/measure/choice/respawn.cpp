#include "measure/choice/respawn.hpp"

#include <algorithm>
#include <array>

#include "measure/choice/candidates.hpp"

namespace lostbits::measure::choice {

std::optional<SafeOffsets> safe_offsets(const scene::file::Scene& scene, const evaluate::TestedForm& row,
                                        truth::TruthLimit limit, int pixels) {
    constexpr std::size_t most_asked = 1 << 16;
    const std::size_t solids = scene.solid_count();
    if (solids == 0 || solids > offset::most_solids || !offset::can_be_asked(*row.form)) return std::nullopt;
    const auto affordable = static_cast<int>(std::clamp<std::size_t>(most_asked / solids, 64, 65536));
    const scene::file::Scene thin = thinned(scene, std::min(pixels, affordable));
    const offset::OffsetRequest request{
        .scene = &thin, .rows = {{row}}, .strategies = offset::all_strategies(), .limit = limit, .quiet = false};
    const offset::OffsetSummary summary = std::move(offset::run_offsets(request).front());
    SafeOffsets safe;
    safe.points = summary.points;
    for (const offset::Side side : offset::both_sides) safe.rays += summary.on(side).rays;
    safe.outside =
        offset::safe_strategies(summary, request.strategies, row.form->shape, std::array{offset::Side::outside});
    safe.both = offset::safe_strategies(summary, request.strategies, row.form->shape);
    return safe;
}

}  // namespace lostbits::measure::choice
