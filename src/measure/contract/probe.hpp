// Probes an external intersector with a few rays whose answers can be checked by hand.
#pragma once

#include <string>
#include <vector>

#include "intersect/external/contract.hpp"

namespace lostbits::measure::contract {

/// Result of one probe of a contract.
struct Observation {
    enum class Verdict {
        kept,    ///< the form has the property
        broken,  ///< the form does something else
        warned,  ///< no property is broken, but answers are wrong
        noted    ///< no property is broken; the behaviour is worth knowing
    };
    std::string subject;  ///< `direction`, `roots`, `touching`, …
    Verdict verdict;
    std::string text;  ///< what the form does and, if that breaks a property, what to write
};

/// Probes a form with:
///
/// - the same rays alone, in batches, with one primitive for each ray, and from several threads;
/// - directions, roots and ends of rays;
/// - rays that touch, run in a plane, or start on the surface, inside or beyond;
/// - all sizes, many rays at primitives in random positions, and huge, zero and NaN numbers.
///
/// The right answer is the truth by the form's own properties, to within 2^-10 of itself or of 1, whichever is larger.
/// If a form cannot answer at all, its exception is passed on. A formula of both roots also has a t of its own.
/// `first_root_form` is the form that answers this t (`external::find_first_root_form`), and every probe tests that
/// form too.
std::vector<Observation> try_contract(const intersect::external::ForeignForm& form,
                                      const intersect::external::ForeignForm* first_root_form = nullptr);

/// Tests that the calls of the form so far left the processor's floating-point state unchanged, and reports the state
/// in which they ran.
Observation observe_state(const intersect::external::ForeignForm& form);

}  // namespace lostbits::measure::contract
