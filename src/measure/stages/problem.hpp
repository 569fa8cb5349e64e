// Findings of a stage on one problem, or on a pack of problems, and the limits and tests that the stages share.
#pragma once

#include <cstdint>

#include "measure/stages/raw_stages.hpp"
#include "number/pack.hpp"
#include "number/wide/multiple.hpp"
#include "number/wide/two_words.hpp"

namespace lostbits::measure::stages {

using number::wide::binade;
using number::wide::product_of;
using number::wide::sum_of;
using number::wide::sum_of_three;
using number::wide::TwoWords;
using number::wide::word_error;

using lostbits::select;
template <class P>
TwoWords<P> select(const mask_t<P>& mask, const TwoWords<P>& a, const TwoWords<P>& b) {
    return {select(mask, a.hi, b.hi), select(mask, a.lo, b.lo)};
}

/// Relative error bound of t* in a stage of one word, and in a stage of two words; the second is
/// `truth::certified_tightness`.
inline constexpr double narrow_tightness = 0x1p-33, wide_tightness = 0x1p-72;

/// Largest relative distance between an input of 256 bits and the sum of its two words. Every other input has one word,
/// which is exact.
inline constexpr double input_error = 0x1p-104;

/// |x − (middle.hi + middle.lo)| ≤ bound.
template <class P>
struct Enclosure {
    TwoWords<P> middle;
    P bound;
};

/// Findings of a stage, valid only where `settled` is set. The requested lengths of a hit lie in one binade.
template <class P>
struct Finding {
    mask_t<P> settled, hit;
    Enclosure<P> t, distance;
};

/// Limits on the components of directions to normalise. Within these limits no product and no quotient over- or
/// underflows.
inline constexpr double largest_length = 0x1p+200, min_length = 0x1p-200;
/// Limits on the lengths that columns hold.
inline constexpr double min_result = 0x1p-900, largest_result = 0x1p+900;

template <class P>
mask_t<P> in_range(const P& x) {
    using lostbits::abs;
    const P size = abs(x);
    return size >= P(min_result) && size <= P(largest_result);
}

template <class P>
P sum_of_sizes(const P& x, const P& y, const P& z) {
    using lostbits::abs;
    return sum_of_three<P>(abs(x), abs(y), abs(z));
}

/// True if x − bound and x + bound lie in one binade. Then every number between them lies in this binade. x is not 0.
template <class P>
mask_t<P> in_one_binade(const P& x, const P& bound) {
    const P low = binade(x - bound), high = binade(x + bound);
    return low <= high && low >= high;
}
/// Same test for x = hi + lo, with a bound far below an ulp of hi. Only if |hi| is a power of two can [x − bound,
/// x + bound] contain one. It does not contain |hi| if |lo| > bound.
template <class P>
mask_t<P> in_one_binade(const TwoWords<P>& x, const P& bound) {
    using lostbits::abs;
    const P power = binade(x.hi);
    return power < abs(x.hi) || abs(x.lo) > bound;
}

/// Float nearest to x.
template <class Width>
Pack<double, Width> nearest_binary32(const Pack<double, Width>& x) {
    using P = Pack<double, Width>;
    if constexpr (has_pack_registers) {
        return P(typename P::Register(pack_round_to_float(x.registers())));
    } else {
        double lanes[P::lanes];
        x.store(lanes);
        for (double& lane : lanes) lane = static_cast<double>(static_cast<float>(lane));
        return P::load(lanes);
    }
}
inline double nearest_binary32(double x) { return static_cast<double>(static_cast<float>(x)); }

}  // namespace lostbits::measure::stages
