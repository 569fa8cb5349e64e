// Claims about the origin of the next ray: which strategies are safe on a scene, and by how much too large they are.
#include <algorithm>

#include "measure/claim/claim_columns.hpp"
#include "measure/claim/claim_subjects.hpp"
#include "measure/offset/offsets.hpp"

namespace lostbits::measure::claim {

using offset::Fault;
using offset::OffsetSummary;
using scene::claim::Claim;

namespace {

std::vector<std::string> strategy_names() {
    std::vector<std::string> names;
    for (const offset::Strategy& s : offset::strategies()) names.emplace_back(s.name);
    return names;
}

/// Where in a measurement the number of a claim stands.
struct Place {
    std::size_t row = 0, strategy = 0;
    offset::Side side = offset::Side::outside;
};

/// The fault that a metric is a share of; of any other metric a self-hit, if there is one.
std::optional<offset::BadRay> shown_by(const Claim& claim, const offset::StrategySummary& s) {
    for (std::size_t f = 0; f < offset::fault_names.size(); ++f) {
        if (claim.metric == std::string(offset::fault_names[f]) + "_fraction") return s.first[f];
    }
    for (const Fault f : {Fault::self_hit, Fault::lost_occluder, Fault::lost_exit, Fault::self_hit_by_form}) {
        if (s.first_with(f)) return s.first_with(f);
    }
    return std::nullopt;
}

/// The respawned ray with the solid that it leaves: it pastes into `lostbits explain`.
map::WorstRay witness_of(const offset::BadRay& bad) {
    map::WorstRay w;
    w.x = bad.x;
    w.y = bad.y;
    w.object = bad.object;
    w.ray = bad.ray.ray;
    w.solid = bad.solid;
    w.size = 0;
    scene::rays::RayGroup group = scene::rays::group_of(bad.ray.ray);
    group.solids = {bad.solid};
    w.given = std::make_shared<const scene::rays::RayGroup>(std::move(group));
    return w;
}

}  // namespace

void measure_offsets(const std::vector<Claim>& claims, const Places& places, const ClaimRequest& run,
                     std::vector<ClaimResult>& results) {
    const Claim& first = claims[places.front()];
    const scene::file::Scene scene = one_scene(first, first.offsets, run);
    find_or_blame_claim(first, [&] {
        offset::require_few_solids(scene);
        return 0;
    });
    offset::OffsetRequest request{.scene = &scene, .rows = {}, .strategies = {}, .limit = {.stop = run.stop}};
    std::vector<Place> at;
    const auto place_in = [](auto& list, const auto& thing) {
        const auto found = std::ranges::find(list, thing);
        if (found != list.end()) return static_cast<std::size_t>(found - list.begin());
        list.push_back(thing);
        return list.size() - 1;
    };
    for (const std::size_t i : places) {
        const Claim& claim = claims[i];
        const map::MapRow row = row_for(claim, scene);
        if (!offset::can_be_asked(*row.form))
            scene::toml::fail(claim.where, claim.form +
                                               " does not tell where a ray meets a sphere or a box, so there "
                                               "is no point to leave; name another form");
        const auto point =
            static_cast<offset::HitPoint>(place_of_word(claim, "points", claim.points, offset::point_names));
        const offset::Strategy* const strategy =
            &offset::strategies()[place_of_word(claim, "strategy", claim.strategy, strategy_names())];
        at.push_back({place_in(request.rows, offset::OffsetRow{row, point}), place_in(request.strategies, strategy),
                      static_cast<offset::Side>(place_of_word(claim, "side", claim.side, offset::side_names))});
    }
    request.quiet = std::ranges::any_of(
        places, [&claims](std::size_t i) { return claims[i].metric.find("quiet") != std::string::npos; });
    const auto summaries = offset::run_offsets(request);
    for (std::size_t k = 0; k < places.size(); ++k) {
        const Claim& claim = claims[places[k]];
        const auto& [row, strategy, side] = at[k];
        const OffsetSummary& summary = summaries[row];
        ClaimResult& result = results[places[k]] =
            judge(claim, offset::offset_value(summary, side, strategy, claim.metric, claim.where.text()), nullptr);
        if (const auto bad = shown_by(claim, summary.on(side).strategies[strategy])) result.witness = witness_of(*bad);
        if (summary.unresolved == 0) continue;
        result.state = ClaimResult::State::broken;
        result.trouble = std::to_string(summary.unresolved) + " pixels have no proved truth";
    }
}

}  // namespace lostbits::measure::claim
