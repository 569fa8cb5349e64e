// Claims about tables: of arithmetic, and of what the nearest hit so far does as the end of a ray.
#include <algorithm>

#include "measure/claim/arithmetic.hpp"
#include "measure/claim/claim_subjects.hpp"
#include "measure/claim/closest.hpp"
#include "scene/toml/did_you_mean.hpp"
#include "shapes/box/family/family.hpp"

namespace lostbits::measure::claim {

using scene::claim::Claim;
using scene::claim::TableSubject;

namespace {

ClaimResult judge_arithmetic(const Claim& claim, const TableSubject& on, std::uint64_t seed) {
    const auto rows = arithmetic_rows();
    const auto row = std::ranges::find(rows, on.row, &ArithmeticRow::name);
    if (row != rows.end()) {
        auto result = judge(claim, row->fraction(claim_format(claim).shape, on.at, seed), nullptr);
        result.samples = static_cast<std::uint64_t>(row->samples);
        return result;
    }
    std::vector<std::string> names;
    for (const ArithmeticRow& r : rows) names.emplace_back(r.name);
    scene::toml::fail(claim.where, "unknown row \"" + on.row + "\"; " + scene::toml::did_you_mean(on.row, names));
}

ClaimResult judge_closest(const Claim& claim, const TableSubject& on, std::uint64_t seed, truth::TruthLimit limit) {
    Claim form = claim;
    form.form = on.row;
    const double differs =
        find_or_blame_claim(claim, [&] { return differs_with_closest(claim_row(form), on.at, seed, limit); });
    auto result = judge(claim, differs, nullptr);
    result.samples = scene::box::BoxFamily{}.views;
    return result;
}

}  // namespace

void measure(const ClaimsOn<TableSubject>& claims, const ClaimRequest& run) {
    measure_draws(claims, run, [&run](const ClaimsOn<TableSubject>& some, int draw) {
        const auto seed = 1 + static_cast<std::uint64_t>(draw);
        for (const auto& [claim, on, result] : some) {
            if (on.name != "arithmetic" && on.name != "closest_as_tmax") {
                scene::toml::fail(claim.where,
                                  "unknown table \"" + on.name +
                                      "\"; there are \"arithmetic\" and \"closest_as_tmax\", whose rows are box forms");
            }
            if (claim.metric != "fraction")
                scene::toml::fail(claim.where,
                                  "unknown metric \"" + claim.metric + "\"; the only metric of a table is fraction");
            result = on.name == "arithmetic" ? judge_arithmetic(claim, on, seed)
                                             : judge_closest(claim, on, seed, {.stop = run.stop});
        }
    });
}

}  // namespace lostbits::measure::claim
