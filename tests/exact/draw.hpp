// Problems for comparisons: random ones, and ones in which something is exactly equal; both also with transforms.
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

/// Number of rays: LOSTBITS_EXACT_RAYS, or the default.
inline std::size_t ray_count_or(std::size_t usual) {
    const char* const text = std::getenv("LOSTBITS_EXACT_RAYS");
    return text ? std::strtoull(text, nullptr, 10) : usual;
}
/// True if the environment gives the number of rays; the tests then print their counts.
inline bool is_ray_count_given() { return std::getenv("LOSTBITS_EXACT_RAYS") != nullptr; }

/// Open ends of the ranges of a batch.
struct Ends {
    bool open_tmin = false, open_tmax = false;
};

/// Rays of any length of direction that are aimed at primitives or beside them, from near, from far and from inside, in
/// floats or doubles; a third of the rays have a range.
void draw_random(const ShapeTest& shape, bool floats, Ends ends, Chance& chance, std::vector<Problem>& problems);

/// Small whole numbers times a power of two, so that rays touch, pass through edges, corners and rims, begin on
/// surfaces, run along them, and have components of zero. The power may make all numbers subnormal or bring them near
/// overflow, and one number may be moved by an ulp. Also numbers with any bits.
void draw_made(const ShapeTest& shape, bool floats, Ends ends, Chance& chance, std::vector<Problem>& problems);

/// Common property of the matrices of a batch.
struct Matrices {
    bool is_inverse = false;  ///< they lead from the world to the primitive
    int orientation = 1;      ///< the sign of their determinants
};

/// Gives each primitive a transform, moves its ray accordingly, and rounds both to the format. The matrices have random
/// numbers, or rows that are dependent except for 10⁻¹² of them, or they stretch the axes by up to 2^20 and 2^-20, or
/// move 10⁶ away.
void place_at_random(bool floats, const Matrices& all, Chance& chance, std::vector<Problem>& problems);

/// Uses matrices of small whole numbers and powers of two with inverses of the same kind: a ray that touches, runs
/// along a surface or begins on it still does so with the transform.
void place_as_made(bool floats, const Matrices& all, Chance& chance, std::vector<Problem>& problems);

}  // namespace lostbits::exact
