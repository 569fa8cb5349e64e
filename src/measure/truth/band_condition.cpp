#include <utility>

#include "intersect/process/parallel.hpp"
#include "measure/truth/band.hpp"
#include "measure/truth/conditioning.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::truth {

using intersect::AtOrigin;
using intersect::Convention;
using intersect::Touching;

void Band::find_condition() {
    condition_.resize(pixels());
    intersect::process::in_parallel(tbb::blocked_range<std::size_t>(0, pixels(), 256), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            limit_.stop.check();
            condition_[i] = condition_of(i, truths_.decision[i], truths_.object[i], {});
        }
    });
    for (auto& [key, apart] : apart_)
        apart.condition = condition_of(
            key / 4, apart.truth.decision, apart.truth.object,
            {key % 4 >= 2 ? Touching::miss : Touching::hit, key % 2 == 1 ? AtOrigin::miss : AtOrigin::hit});
}

double Band::condition_of(std::size_t i, Truth::Decision decision, int object, Convention convention) const {
    if (decision != Truth::Decision::hit) return missing;
    return with_ray(i, [&](const auto& ray, const auto& solids) {
        const auto solid = solids[static_cast<std::size_t>(object)];
        return lostbits::measure::truth::condition(ray, solid, convention.of(solid.shape), range(i));
    });
}

double Band::condition(std::size_t i, Convention convention) const {
    if (convention.is_special() && asks_anew(i, convention)) {
        const Truth truth = find_truth_of(i, convention);
        return condition_of(i, truth.decision, truth.object, convention);
    }
    const Apart* const apart = find_apart(i, convention);
    return apart ? apart->condition : condition_[i];
}

double Band::reach_of(std::size_t i, const Truth& found, Length length, const FloatFormat& format,
                      Perturbed perturbed) const {
    if (!found.is_hit()) return missing;
    return with_ray(i, [&](const auto& ray, const auto& solids) {
        const auto solid = solids[static_cast<std::size_t>(found.object)];
        const Certified& answer = length == Length::distance ? found.distance : found.t;
        return lostbits::measure::truth::reach(ray, solid, answer, length, format, perturbed);
    });
}

double Band::reach(std::size_t i, Convention convention, intersect::Direction unit_of, const FormatInputs& of,
                   Perturbed perturbed) const {
    const Length length = length_of(unit_of);
    const auto& known = of.reach[static_cast<std::size_t>(perturbed)][static_cast<std::size_t>(length)];
    const bool closed = !known.empty() && !(convention.is_special() && asks_anew(i, convention)) &&
                        find_apart(i, convention) == nullptr;
    return closed ? known[i] : reach_of(i, truth(i, convention), length, of.format.parameters, perturbed);
}

void Band::find_reach(FormatInputs& in, BandNeeds needs) const {
    for (const Perturbed perturbed : {Perturbed::componentwise, Perturbed::normwise}) {
        for (const Length length : {Length::parameter, Length::distance}) {
            const auto place = std::pair(static_cast<std::size_t>(perturbed), static_cast<std::size_t>(length));
            if (!needs.reach[place.first][place.second]) continue;
            std::vector<double>& all = in.reach[place.first][place.second];
            all.resize(pixels());
            intersect::process::in_parallel(tbb::blocked_range<std::size_t>(0, pixels(), 256), [&](const auto& range) {
                limit_.stop.check();
                for (std::size_t i = range.begin(); i < range.end(); ++i)
                    all[i] = reach_of(i, truths_[i], length, in.format.parameters, perturbed);
            });
        }
    }
}

}  // namespace lostbits::measure::truth
