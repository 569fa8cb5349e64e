// Ranges of inputs in boxes, each with its bound: halved where nothing is known yet or the bound is widest.
#pragma once

#include <span>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "measure/apriori/tape_bound.hpp"

namespace lostbits::measure::apriori {

/// A box, and its halves where it has been halved: at `middle` of number `axis`, which belongs to both.
struct BoundedPart {
    InputBox box = {};
    BoxBound bound = {};
    double share = 1;  ///< of the volume of the whole
    int stale = 0;     ///< so often in a row halving has not made the bound smaller by 2 %
    int axis = -1;
    double middle = 0;
    std::size_t below = 0;  ///< its place, before that of the other half

    [[nodiscard]] bool is_halved() const { return axis >= 0; }
};

class Subdivided {
public:
    /// In at most so many boxes, the same for any number of threads.
    Subdivided(const TapeBound& bound, InputBox whole, std::size_t boxes, const intersect::process::StopToken& stop);

    /// The box that holds these inputs, which are of the whole.
    [[nodiscard]] const BoundedPart& part_of(std::span<const double> inputs) const;
    /// The boxes that are not halved.
    [[nodiscard]] std::vector<const BoundedPart*> leaves() const;

private:
    [[nodiscard]] std::vector<std::size_t> worth_halving(std::size_t at_most) const;
    void halve(std::span<const std::size_t> which, const TapeBound& bound, const intersect::process::StopToken& stop);

    std::vector<BoundedPart> parts_;
    int free_ = 0;  ///< inputs that are not one number
};

}  // namespace lostbits::measure::apriori
