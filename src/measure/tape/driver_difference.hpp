// Compares a driver's answers with those of the program that it compiled. If bits differ, finds the rewriting that
// explains them and the first operation that it changes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "intersect/table/table.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::tape {

/// A change that drivers make to the operations of a program.
struct DriverRewriting {
    std::string name;           ///< such as `rounds a*b + c once`
    std::vector<NodeId> sites;  ///< operations that the rewriting changes, in ascending order
};

struct DriverDifference {
    std::size_t ray_count = 0;            ///< number of rays compared
    std::size_t differing_ray_count = 0;  ///< number of these rays with different bits
    /// The smallest set of rewritings, with the fewest operations, with which the program has the driver's bits on all
    /// rays. Empty if no tested set has them.
    std::vector<DriverRewriting> rewritings;
    /// An operation whose results in the driver have an error of at most `ulps` units in the last place; `no_node` if
    /// the rewritings alone explain the bits.
    NodeId inexact_operation = no_node;
    int ulps = 0;

    [[nodiscard]] bool is_explained() const { return !rewritings.empty() || inexact_operation != no_node; }
    /// The first operation on the tape that a rewriting or the inexact operation changes; `no_node` if they change no
    /// operation.
    [[nodiscard]] NodeId first_changed() const;
};

/// Compares the driver's form with the form of the program that it compiled, in f32 on random rays. Both have one
/// shape.
DriverDifference find_driver_difference(const intersect::table::Intersector& driver,
                                        const intersect::table::Intersector& program_form);

/// Names of the rewritings that are tried.
std::vector<std::string> driver_rewriting_names();

/// A tape that was derived from another one. `origins` has, for each node, the node of the original tape that it
/// replaces.
struct DerivedTape {
    Tape tape;
    std::vector<NodeId> origins;
};

/// Applies the rewriting with index `rewriting` to the operations that replace the nodes `sites` of the original tape,
/// or to all operations if `sites` is null. `changed` receives the nodes that were changed.
DerivedTape rewrite_as_driver(const DerivedTape& source, std::size_t rewriting, const std::vector<NodeId>* sites,
                              std::vector<NodeId>& changed);

}  // namespace lostbits::measure::tape
