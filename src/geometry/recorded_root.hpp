// The search for the root of a quartic, recorded.
#pragma once

#include "geometry/first_root.hpp"
#include "number/wide/recorded_running.hpp"

namespace lostbits {

/// Records the search as one operation of a program; its steps are those of the function for packs.
inline number::wide::ColumnWord near_first_root(const QuarticChain<number::wide::ColumnWord>& chain,
                                                const number::wide::ColumnWord& begin,
                                                const number::wide::ColumnWord& bound, int /*steps*/) {
    using number::wide::ColumnOperation, number::wide::ColumnWord, number::wide::recorded;
    return ColumnWord::at(recorded(ColumnOperation::near_root_of_quartic, chain.n.place(), chain.p.place(),
                                   chain.q.place(), chain.r.place(), begin.place(), bound.place()));
}

}  // namespace lostbits
