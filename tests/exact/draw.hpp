// Problems to ask about: random ones, and ones that are made so that something is exactly equal; under matrices too.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <vector>

#include "exact/primitives.hpp"

namespace lostbits::exact {

/// xoshiro256++ 1.0 by Blackman and Vigna, public domain.
class Chance {
public:
    explicit Chance(std::uint64_t seed);
    std::uint64_t bits();
    /// Evenly from 0 to n − 1.
    int below(int n) { return static_cast<int>((bits() >> 33) * static_cast<std::uint64_t>(n) >> 31); }
    /// Evenly from −1 to 1.
    double part() { return static_cast<double>(static_cast<std::int64_t>(bits())) * 0x1p-63; }

private:
    std::uint64_t s_[4];
};

/// x as a number of S.
template <class S>
double stored(double x) {
    return static_cast<double>(static_cast<S>(x));
}

/// As many rays as LOSTBITS_EXACT_RAYS says, or as usual.
inline std::size_t rays_or(std::size_t usual) {
    const char* const asked = std::getenv("LOSTBITS_EXACT_RAYS");
    return asked ? std::strtoull(asked, nullptr, 10) : usual;
}
/// True if it says so: then what was asked is told.
inline bool are_rays_asked() { return std::getenv("LOSTBITS_EXACT_RAYS") != nullptr; }

/// Open ends of the ranges of a batch.
struct Ends {
    bool open_tmin = false, open_tmax = false;
};

/// Rays of any length of direction that are aimed at primitives or beside them, from near, from far and from inside, in
/// floats or doubles; a third of the rays have a range.
void draw_random(const Shaped& shape, bool floats, Ends ends, Chance& chance, std::vector<Problem>& problems);

/// Small whole numbers times a power of two, so that rays touch, pass through edges, corners and rims, begin on
/// surfaces, run along them, and have components of zero; the power may make all of them subnormal, or take them to
/// where numbers end; one may be moved by an ulp. And numbers of any bits.
void draw_made(const Shaped& shape, bool floats, Ends ends, Chance& chance, std::vector<Problem>& problems);

/// Common property of the matrices of a batch.
struct Matrices {
    bool is_inverse = false;  ///< they lead from the world to the primitive
    int orientation = 1;      ///< the sign of their determinants
};

/// Puts each primitive under a matrix, and its ray to where it stands then, rounded to the format: matrices of random
/// numbers, of rows that are dependent but for 10⁻¹² of them, that stretch the axes by up to 2^20 and 2^-20, and that
/// lead 10⁶ away.
void place_at_random(bool floats, const Matrices& all, Chance& chance, std::vector<Problem>& problems);

/// Under matrices of small whole numbers and powers of two whose inverses are such too: what touches, runs along a
/// surface or begins on one does so there.
void place_as_made(bool floats, const Matrices& all, Chance& chance, std::vector<Problem>& problems);

}  // namespace lostbits::exact
