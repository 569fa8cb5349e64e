// Other ways of writing a form, the same in real arithmetic, that keep more: a bounded search over the rules.
#pragma once

#include <cstdint>
#include <vector>

#include "measure/identity/rules.hpp"
#include "measure/mend/wider_set.hpp"

namespace lostbits::measure::mend {

using identity::Rule;

/// A form written another way.
struct Rewritten {
    Tape tape;
    std::vector<const Rule*> rules;  ///< that made it, in order
    Worth worth{}, apart{};          ///< on the scene, and on rays that were not searched on
    std::size_t operations = 0;      ///< that round
    /// Where it does not meet the wish by itself and with operations wider does: the fewest of them, which `tape` has.
    std::optional<WiderSet> set = {};
};

struct Rewriting {
    /// Of those that meet the wish what nothing tried beats in both, accuracy and work (`work_of`), the most accurate
    /// first; where none meets it the most accurate alone, if it is more accurate than the form, or as accurate with
    /// less work.
    std::vector<Rewritten> found;
    std::uint64_t tried = 0;    ///< candidates, each on all rays
    std::uint64_t refused = 0;  ///< that in real arithmetic answered otherwise on some ray, and were not tried
};

struct SearchLimit {
    std::size_t rounds = 8;     ///< in each, the most promising are rewritten once
    std::size_t beam = 4;       ///< so many of them by accuracy, and as many by work
    std::size_t places = 24;    ///< candidates from each, first those that replace what loses most bits
    std::size_t proposals = 3;  ///< that are kept in the end
};

/// From the form on: what rules make of the most accurate so far, and of what meets the wish with least work, is held
/// against the truth on all rays; until nothing new comes, or for so many rounds. A candidate that is not the form in
/// real arithmetic (on a sample of the rays, see `RaySample::agree`) is dropped.
Rewriting rewrite(const MendRequest& request, const Tape& form, const Worth& own, Judge& judge,
                  const SearchLimit& limit = {});

/// What stands for time while it is not known: operations that round, each division and root counted eight times. It
/// orders the search and is not printed.
std::size_t work_of(const Tape& tape);

}  // namespace lostbits::measure::mend
