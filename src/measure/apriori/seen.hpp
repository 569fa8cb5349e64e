// What rays show of a bound over ranges: none may be off by more.
#pragma once

#include <cstdint>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/apriori/subdivided.hpp"

namespace lostbits::measure::apriori {

/// Errors are |t^ − t| of hits with and without rounding, in units of t.
struct SeenErrors {
    std::uint64_t hits = 0, bounded_hits = 0;  ///< pairs of a ray and a solid; of these, in boxes with a bound
    double error = 0;                          ///< the largest in a box with a bound
    double share = 0;                ///< the largest error over the bound of its box: at most 1, or some bound is wrong
    std::uint64_t running_hits = 0;  ///< in a box with a bound, where `Bounded` has a bound, too
    double running = 0;              ///< the largest of those
    std::uint64_t wider = 0;         ///< rays whose running bound is above that of their box

    void append(const SeenErrors& after);
};

/// What a form is asked: `like` is the solid of the ranges.
struct Asking {
    const intersect::table::Intersector& form;
    const Format& format;
    const Subdivided& parts;
    const Solid<double>& like;
    const intersect::process::StopToken& stop;
};

/// Of these inputs, all of them in the ranges.
SeenErrors see(const Asking& asking, const std::vector<std::vector<double>>& rays);

/// Inputs drawn in the boxes with the largest bounds, each a number of the format: `each` in each of so many boxes.
std::vector<std::vector<double>> drawn(const Asking& asking, std::size_t boxes, int each);

}  // namespace lostbits::measure::apriori
