// Rays of a scene or of files that tapes are run on one by one: where the bits go, and whether two formulas are the
// same without rounding.
#pragma once

#include <vector>

#include "measure/mend/judge.hpp"

namespace lostbits::measure::mend {

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
