// A driver's answers beside those of the program that it compiled: where bits differ, the rewriting that explains them
// and the first operation that it changes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "intersect/table/table.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::tape {

/// Changes that drivers make to the operations of a program.
struct DriverRewriting {
    std::string name;           ///< `a b + c rounded once`
    std::vector<NodeId> sites;  ///< operations that it changes, the first one first
};

struct DriverDifference {
    std::size_t rays = 0, differ = 0;
    /// The fewest of the rewritings, with the fewest operations, with which the program has the driver's bits on all
    /// rays; none: no rewriting that was tried has.
    std::vector<DriverRewriting> rewritings;
    /// An operation of which the driver's results are so many units in the last place off; 0: exact.
    NodeId inexact = no_node;
    int ulps = 0;

    [[nodiscard]] bool is_explained() const { return !rewritings.empty() || inexact != no_node; }
    [[nodiscard]] NodeId first() const;
};

/// Compares both rows, of one shape and in f32, on random rays.
DriverDifference driver_difference(const intersect::table::Intersector& driver,
                                   const intersect::table::Intersector& program);

/// The rewritings that are tried, by name.
std::vector<std::string> driver_rewritings();

/// A tape that was made from another one, and the node there that each node stands for.
struct DerivedTape {
    Tape tape;
    std::vector<NodeId> origins;
};

/// Rewrites operations, by the nodes that they stand for: these, or all if `sites` is null. `changed` receives those
/// that were changed.
DerivedTape rewritten_by_driver(const DerivedTape& from, std::size_t which, const std::vector<NodeId>* sites,
                                std::vector<NodeId>& changed);

}  // namespace lostbits::measure::tape
