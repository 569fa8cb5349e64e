// Claims about tables: of arithmetic, and of what the nearest hit so far does as the end of a ray.
#include <algorithm>

#include "measure/claim/arithmetic.hpp"
#include "measure/claim/claim_subjects.hpp"
#include "measure/claim/closest.hpp"
#include "scene/toml/did_you_mean.hpp"

namespace lostbits::measure::claim {

using scene::claim::Claim;

namespace {

double arithmetic_value(const Claim& claim) {
    const auto rows = arithmetic_rows();
    const auto row = std::ranges::find(rows, claim.row, &ArithmeticRow::name);
    if (row != rows.end()) return row->fraction(claim_format(claim).shape, claim.at.front());
    std::vector<std::string> names;
    for (const ArithmeticRow& r : rows) names.emplace_back(r.name);
    scene::toml::fail(claim.where, "unknown row \"" + claim.row + "\"; " + scene::toml::did_you_mean(claim.row, names));
}

double closest_value(const Claim& claim) {
    Claim form = claim;
    form.form = claim.row;
    return find_or_blame_claim(claim, [&] { return differs_with_closest(claim_row(form), claim.at.front()); });
}

}  // namespace

void measure_table(const std::vector<Claim>& claims, const Places& places, std::vector<ClaimResult>& results) {
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
        results[i] =
            judge(claim, claim.table == "arithmetic" ? arithmetic_value(claim) : closest_value(claim), nullptr);
    }
}

}  // namespace lostbits::measure::claim
