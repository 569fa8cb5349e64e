// Problems whose solids stand under matrices.
#pragma once

#include "exact/draw.hpp"

namespace lostbits::exact {

/// What the matrices of a batch have in common.
struct Matrices {
    bool is_inverse = false;  ///< they lead from the world to the solid
    int orientation = 1;      ///< the sign of their determinants
};

/// Puts each solid under a matrix, and its ray to where it stands then, rounded to the format: matrices of random
/// numbers, of rows that are dependent but for 10⁻¹² of them, that stretch the axes by up to 2^20 and 2^-20, and that
/// lead 10⁶ away.
void place_at_random(bool floats, const Matrices& all, Chance& chance, std::vector<Problem>& problems);

/// Under matrices of small whole numbers and powers of two whose inverses are such too: what touches, runs along a
/// surface or begins on one does so there.
void place_as_made(bool floats, const Matrices& all, Chance& chance, std::vector<Problem>& problems);

}  // namespace lostbits::exact
