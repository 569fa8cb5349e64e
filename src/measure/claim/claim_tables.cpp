// Claims about tables: of arithmetic, and of what the nearest hit so far does as the end of a ray.
#include <algorithm>

#include "measure/claim/arithmetic.hpp"
#include "measure/claim/claim_subjects.hpp"
#include "measure/claim/closest.hpp"
#include "scene/toml/did_you_mean.hpp"
#include "shapes/box/family/family.hpp"

namespace lostbits::measure::claim {

using scene::claim::Claim;

namespace {

ClaimResult judge_arithmetic(const Claim& claim, std::uint64_t seed) {
    const auto rows = arithmetic_rows();
    const auto row = std::ranges::find(rows, claim.row, &ArithmeticRow::name);
    if (row != rows.end()) {
        auto result = judge(claim, row->fraction(claim_format(claim).shape, claim.at.front(), seed), nullptr);
        result.samples = static_cast<std::uint64_t>(row->samples);
        return result;
    }
    std::vector<std::string> names;
    for (const ArithmeticRow& r : rows) names.emplace_back(r.name);
    scene::toml::fail(claim.where, "unknown row \"" + claim.row + "\"; " + scene::toml::did_you_mean(claim.row, names));
}

ClaimResult judge_closest(const Claim& claim, std::uint64_t seed, truth::TruthLimit limit) {
    Claim form = claim;
    form.form = claim.row;
    const double differs = find_or_blame_claim(
        claim, [&] { return differs_with_closest(claim_row(form), claim.at.front(), seed, limit); });
    auto result = judge(claim, differs, nullptr);
    result.samples = scene::box::BoxFamily{}.views;
    return result;
}

}  // namespace

void measure_table(const std::vector<Claim>& claims, const Places& places, const ClaimRequest& run, int draw,
                   std::vector<ClaimResult>& results) {
    const auto seed = 1 + static_cast<std::uint64_t>(draw);
    for (const std::size_t i : places) {
        const Claim& claim = claims[i];
        if (claim.table != "arithmetic" && claim.table != "closest_as_tmax") {
            scene::toml::fail(claim.where,
                              "unknown table \"" + claim.table +
                                  "\"; there are \"arithmetic\" and \"closest_as_tmax\", whose rows are box forms");
        }
        if (claim.metric != "fraction")
            scene::toml::fail(claim.where,
                              "unknown metric \"" + claim.metric + "\"; the only metric of a table is fraction");
        results[i] = claim.table == "arithmetic" ? judge_arithmetic(claim, seed)
                                                 : judge_closest(claim, seed, {.stop = run.stop});
    }
}

}  // namespace lostbits::measure::claim
