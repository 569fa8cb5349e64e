#include "measure/apriori/seen.hpp"

#include <algorithm>
#include <cmath>

#include "intersect/process/parallel.hpp"
#include "measure/answer/self.hpp"
#include "measure/tape/tape_form.hpp"
#include "number/rounded.hpp"
#include "scene/rays/random.hpp"

namespace lostbits::measure::apriori {

namespace {

SeenErrors see_one(const Asking& a, const std::vector<double>& inputs) {
    const BoundedPart& part = a.parts.part_of(inputs);
    const Ray<double> ray = tape::ray_of(inputs);
    const Solid<double> solid = tape::solid_of(inputs, a.like);
    Tape tape;
    a.form.record(a.format, ray, intersect::Target<double>(solid), inputs.back(), tape);
    if (tape[tape.outputs.hit].value == 0) return {};
    const auto exact = answer::without_rounding(a.form, ray, intersect::Target<double>(solid));
    if (!exact) return {};
    SeenErrors seen{.hits = 1};
    if (part.bound.misses) seen.share = HUGE_VAL;  // it says that there is no hit
    if (!(part.bound.error < HUGE_VAL)) return seen;
    seen.bounded_hits = 1;
    seen.error = std::fabs(truth::scaled_difference(truth::exactly(tape[tape.outputs.t].value), *exact, 0));
    seen.share = seen.error == 0 ? 0 : seen.error / part.bound.error;
    if (!a.form.bounded) return seen;
    const auto own = a.form.bounded(a.format, ray, intersect::Target<double>(solid), inputs.back());
    if (!own || !(own->error < HUGE_VAL)) return seen;
    seen.running_hits = 1;
    seen.running = own->error;
    seen.wider = own->error > part.bound.error ? 1 : 0;
    return seen;
}

}  // namespace

void SeenErrors::append(const SeenErrors& after) {
    hits += after.hits;
    bounded_hits += after.bounded_hits;
    error = std::fmax(error, after.error);
    share = std::fmax(share, after.share);
    running_hits += after.running_hits;
    running = std::fmax(running, after.running);
    wider += after.wider;
}

SeenErrors see(const Asking& asking, const std::vector<std::vector<double>>& rays) {
    std::vector<SeenErrors> each(rays.size());
    intersect::process::in_parallel(std::size_t{0}, rays.size(), [&](std::size_t i) {
        asking.stop.check();
        each[i] = see_one(asking, rays[i]);
    });
    SeenErrors all;
    for (const SeenErrors& one : each) all.append(one);
    return all;
}

std::vector<std::vector<double>> drawn(const Asking& asking, std::size_t boxes, int each) {
    auto leaves = asking.parts.leaves();
    std::erase_if(leaves, [](const BoundedPart* p) { return p->bound.misses || !(p->bound.error < HUGE_VAL); });
    std::ranges::stable_sort(
        leaves, [](const BoundedPart* p, const BoundedPart* q) { return p->bound.error > q->bound.error; });
    if (leaves.size() > boxes) leaves.resize(boxes);
    scene::rays::Random random(1);
    std::vector<std::vector<double>> all;
    for (const BoundedPart* const part : leaves) {
        for (int k = 0; k < each; ++k) {
            std::vector<double> inputs;
            for (const auto& [low, high] : part->box) {
                // Rounding may lead out of the box, but not out of the ranges, whose ends are numbers of the format.
                const double x = low == high ? low : random.between(low, high);
                inputs.push_back(rounding::to_format(x, 0, asking.format.shape));
            }
            all.push_back(std::move(inputs));
        }
    }
    return all;
}

}  // namespace lostbits::measure::apriori
