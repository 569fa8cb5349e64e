// Which operations of a form must be done in wider arithmetic so that it meets a wish on all rays of a scene, and other
// ways of writing it, the same in real arithmetic, that keep more.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "measure/identity/rules.hpp"
#include "measure/mend/judge.hpp"

namespace lostbits::measure::mend {

/// A set of operations done wider, from which nothing can be taken.
struct WiderSet {
    std::vector<NodeId> operations;  ///< of the form's tape
    Worth worth{};
    std::vector<Worth> without = {};  ///< with each of the operations as it was, the others wider: none meets the wish
    /// No set of so many operations or fewer meets the wish: all were tried. One less than its own size: it is one of
    /// the smallest.
    std::size_t none_of = 0;
};

/// From all operations, with which the wish is met, those are taken away, one after the other, whose loss costs least
/// while it is, until none can be spared; then all smaller sets are tried as far as there are at most `affordable` of
/// one size.
WiderSet smallest_set(const Tape& tape, const FloatFormat& wider, const Worth& with_all, const MendRequest& request,
                      Judge& judge, std::uint64_t affordable);

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

struct Mended {
    Tape tape;                         ///< of the form
    FloatFormat wider;                 ///< what operations are done in
    std::size_t operations = 0;        ///< that round, and so could be done wider
    Worth own{}, all{};                ///< as it is, and with every operation wider
    std::optional<WiderSet> set = {};  ///< none: with every operation wider it does not meet the wish; empty: it does
                                       ///< as it is
    Rewriting rewriting = {};          ///< other ways of writing it; none where it meets the wish as it is
    std::uint64_t tried = 0;           ///< candidates, each on all rays
    scene::file::Scene apart = {};     ///< the scene in other pixels: rays that were not searched on
    Worth own_apart{}, apart_worth{};  ///< of the form and of the set there; of files on all their rays
};

/// `affordable` is that of `smallest_set`. InputError for a form whose operations are not the same for every ray of the
/// scene: held against the form, its tape has other answers.
Mended mend(const MendRequest& request, std::uint64_t affordable = 600);

/// Whether the matrices of the solids are stored as the way to the solid; false without any. InputError as `recorded`.
bool are_inverses(const MendRequest& request);

/// Every operation of the request's form, as its solids are stored. Each way of storing a matrix has a tape of its own,
/// and a solid without one another: InputError where the solids are of several kinds.
Tape recorded(const MendRequest& request);

/// The form with a set of operations done wider.
Tape with_wider(const Mended& mended, const std::vector<NodeId>& operations);

class RaySample {
public:
    /// About so many rays, evenly over the picture or the file, each with the solid that it truly hits, or the first.
    explicit RaySample(const MendRequest& request, int rays = 64);

    /// How often each operation of a tape loses most.
    [[nodiscard]] std::vector<int> culprits(Tape tape) const;

    /// Whether two tapes of one form have the same answers on these rays in real arithmetic: both miss, or hit at the
    /// same t to 45 bits, where no division by zero leaves either of them undefined. Directions are turned to an axis
    /// where the form promises that they have length one, so that they have.
    [[nodiscard]] bool agree(const Tape& a, const Tape& b) const;

private:
    std::vector<std::vector<double>> inputs_, exact_inputs_;  ///< of each ray, in the order of the tape's
};

/// The tape with other inputs, and all values that follow: as the format has them, or without rounding.
Tape filled(Tape tape, const std::vector<double>& inputs, bool rounds);

/// Whether its values are of a division by zero.
bool divides_by_zero(const Tape& tape);

}  // namespace lostbits::measure::mend
