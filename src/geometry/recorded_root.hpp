// The search for the first root of a quartic, as a recorded operation.
#pragma once

#include "geometry/first_root.hpp"
#include "number/wide/recorded_running_error.hpp"

namespace lostbits {

/// Records the search as one operation of a program; the operation performs the steps of `approximate_first_root` for
/// packs.
inline number::wide::ColumnWord approximate_first_root(const QuarticChain<number::wide::ColumnWord>& chain,
                                                       const number::wide::ColumnWord& begin,
                                                       const number::wide::ColumnWord& bound, int /*steps*/) {
    using number::wide::ColumnOperation, number::wide::ColumnWord, number::wide::record_instruction;
    return ColumnWord::at(record_instruction(ColumnOperation::first_root_of_quartic, chain.n.index(), chain.p.index(),
                                             chain.q.index(), chain.r.index(), begin.index(), bound.index()));
}

}  // namespace lostbits
