// An intersector from outside, asked a few rays whose answers anyone can check by hand.
#pragma once

#include <string>
#include <vector>

#include "intersect/doors/contract.hpp"

namespace lostbits::measure::contract {

/// What was found about one promise.
struct Observation {
    enum class Verdict {
        kept,    ///< it does as it says
        broken,  ///< it does something else
        told     ///< nothing was promised; what it does is worth knowing
    };
    std::string subject;  ///< `direction`, `roots`, `touching`, …
    Verdict verdict;
    std::string words;  ///< what it does, and what to write where that is not what it says
};

/// Asks the form whether it answers the same again, ray by ray, with a solid a ray and from several threads; whose
/// directions, roots and ends it takes; what it makes of a ray that touches, runs in a plane, starts on the surface,
/// inside or beyond; of all sizes, of many rays at solids that lie at random, of huge, zero and NaN numbers. What is
/// right is the truth by the form's own words; answers are right here to 2^-10 of themselves. A form that cannot answer
/// at all throws what it throws. A formula of both roots has a t of its own: `first` tells that one
/// (`doors::first_of`), and every probe tries it too.
std::vector<Observation> try_contract(const intersect::doors::ForeignForm& form,
                                      const intersect::doors::ForeignForm* first = nullptr);

/// Whether the processor computes after its calls, as far as it was called, as before; and how it computes in them.
Observation observe_state(const intersect::doors::ForeignForm& form);

}  // namespace lostbits::measure::contract
