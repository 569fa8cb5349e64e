#include "measure/claim/closest.hpp"

#include <cmath>
#include <vector>

#include "number/error.hpp"
#include "shapes/box/family/family.hpp"

namespace lostbits::measure::claim {

using truth::FormatInputs;

namespace {

/// The nearest t over the solids, infinite for a miss.
std::vector<double> nearest(const evaluate::TestedForm& row, const FormatInputs& in, bool pass_on) {
    const std::size_t n = in.rays.size();
    std::vector<double> best(n, HUGE_VAL);
    for (const Solid<double>& solid : in.solids.listed()) {
        FormatInputs one{.format = in.format, .rays = in.rays, .solids = std::vector{solid}, .stop = in.stop};
        if (pass_on) one.rays.tmax = best;
        const answer::Answers answers = answer::evaluate(*row.form, one);
        for (std::size_t i = 0; i < n; ++i) {
            if (answers.hit[i] != 0 && answers.t[i] < best[i]) best[i] = answers.t[i];
        }
    }
    return best;
}

}  // namespace

double differs_with_closest(const evaluate::TestedForm& row, double distance, std::uint64_t seed,
                            truth::TruthLimit limit) {
    if (!told_end(row.form->shape))
        throw InputError(std::string(row.form->info->name) + " does not take the end of a ray");
    scene::box::BoxFamily family;
    family.adjoining = true;
    family.distance = distance;
    family.seed = seed;
    std::size_t rays = 0, different = 0;
    for (scene::rays::RayGroup& group : family.draw()) {
        const truth::Band band(std::move(group), limit);
        const FormatInputs in = band.inputs(row.format, {});
        const auto apart = nearest(row, in, false), passed = nearest(row, in, true);
        rays += apart.size();
        for (std::size_t i = 0; i < apart.size(); ++i) different += apart[i] != passed[i];
    }
    return static_cast<double>(different) / static_cast<double>(rays);
}

}  // namespace lostbits::measure::claim
