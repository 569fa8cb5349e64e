#include "measure/apriori/subdivided.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "intersect/process/parallel.hpp"

namespace lostbits::measure::apriori {

namespace {

/// The number whose range is widest by its range in the whole; −1 where no range can be halved.
int widest(const InputBox& box, const InputBox& whole) {
    int found = -1;
    double most = 0;
    for (std::size_t k = 0; k < box.size(); ++k) {
        const double middle = box[k].low / 2 + box[k].high / 2;
        const double width = (box[k].high - box[k].low) / (whole[k].high - whole[k].low);
        if (!(box[k].low < middle && middle < box[k].high) || !(width > most)) continue;
        most = width;
        found = static_cast<int>(k);
    }
    return found;
}

/// What a box that is not known counts as in bits, more than any bound is too wide by.
constexpr double unknown_bits = 64;

}  // namespace

Subdivided::Subdivided(const TapeBound& bound, InputBox whole, std::size_t boxes,
                       const intersect::process::StopToken& stop) {
    free_ = static_cast<int>(std::ranges::count_if(whole, [](const Between& x) { return !x.is_point(); }));
    parts_.push_back({.bound = bound.over(whole)});
    parts_.front().box = std::move(whole);
    for (std::size_t leaves = 1; leaves < boxes;) {
        const auto chosen = worth_halving(std::min((leaves + 3) / 4, boxes - leaves));
        if (chosen.empty()) break;
        halve(chosen, bound, stop);
        leaves += chosen.size();
    }
}

/// By the volume times the bits that the bound is above the smallest one of all boxes.
std::vector<std::size_t> Subdivided::worth_halving(std::size_t at_most) const {
    double best = HUGE_VAL;
    for (const BoundedPart& p : parts_)
        if (!p.is_halved() && p.bound.error > 0) best = std::fmin(best, p.bound.error);
    std::vector<std::pair<double, std::size_t>> found;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const BoundedPart& p = parts_[i];
        if (p.is_halved() || p.bound.misses || p.bound.error == 0 || p.stale >= 2 * free_) continue;
        if (widest(p.box, parts_.front().box) < 0) continue;
        const double above = p.bound.error < HUGE_VAL ? 1 + std::log2(p.bound.error / best) : unknown_bits;
        found.emplace_back(-p.share * above, i);
    }
    std::ranges::sort(found);
    found.resize(std::min(at_most, found.size()));
    std::vector<std::size_t> chosen;
    for (const auto& [score, i] : found) chosen.push_back(i);
    return chosen;
}

void Subdivided::halve(std::span<const std::size_t> which, const TapeBound& bound,
                       const intersect::process::StopToken& stop) {
    const std::size_t first = parts_.size();
    for (const std::size_t i : which) {
        BoundedPart& p = parts_[i];
        p.axis = widest(p.box, parts_.front().box);
        Between& range = p.box[static_cast<std::size_t>(p.axis)];
        p.middle = range.low / 2 + range.high / 2;
        p.below = parts_.size();
        BoundedPart below = p, above = p;
        below.axis = above.axis = -1;
        below.share = above.share = p.share / 2;
        below.box[static_cast<std::size_t>(p.axis)].high = p.middle;
        above.box[static_cast<std::size_t>(p.axis)].low = p.middle;
        parts_.push_back(std::move(below));
        parts_.push_back(std::move(above));
    }
    intersect::process::in_parallel(first, parts_.size(), [&](std::size_t i) {
        stop.check();
        BoundedPart& p = parts_[i];
        const double before = p.bound.error;
        p.bound = bound.over(p.box);
        p.bound.error = std::fmin(p.bound.error, before);
        p.stale = p.bound.error > 0.98 * before ? p.stale + 1 : 0;
    });
}

const BoundedPart& Subdivided::part_of(std::span<const double> inputs) const {
    const BoundedPart* p = &parts_.front();
    while (p->is_halved()) p = &parts_[p->below + (inputs[static_cast<std::size_t>(p->axis)] > p->middle ? 1 : 0)];
    return *p;
}

std::vector<const BoundedPart*> Subdivided::leaves() const {
    std::vector<const BoundedPart*> all;
    for (const BoundedPart& p : parts_)
        if (!p.is_halved()) all.push_back(&p);
    return all;
}

}  // namespace lostbits::measure::apriori
