// Which operations of a form must be done in wider arithmetic so that it meets a wish on all rays of a scene.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "measure/mend/rewrite.hpp"

namespace lostbits::measure::mend {

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

/// From all operations those are taken, one after the other, whose loss costs least while the wish is met, until none
/// can be spared; then all smaller sets are tried as far as there are at most `affordable` of one size.
/// InputError for a form whose operations are not the same for every ray of the scene: held against the form, its tape
/// has other answers.
Mended mend(const MendRequest& request, std::uint64_t affordable = 600);

/// Whether the matrices of the solids are stored as the way to the solid; false without any. InputError as `recorded`.
bool are_inverses(const MendRequest& request);

/// Every operation of the request's form, as its solids are stored. Each way of storing a matrix has a tape of its own,
/// and a solid without one another: InputError where the solids are of several kinds.
Tape recorded(const MendRequest& request);

/// The form with a set of operations done wider.
Tape with_wider(const Mended& mended, const std::vector<NodeId>& operations);

}  // namespace lostbits::measure::mend
