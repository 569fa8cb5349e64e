// Rounding to binary32, for packs of doubles and for one.
#pragma once

#include "number/pack.hpp"

namespace lostbits::measure::stages {

/// The float nearest to x.
template <class Width>
Pack<double, Width> nearest_binary32(const Pack<double, Width>& x) {
    using P = Pack<double, Width>;
    using Floats = stdx::simd<float, PackAbi<float, Registers<Width::bytes / 2>>>;
    return P(stdx::static_simd_cast<typename P::Simd>(stdx::static_simd_cast<Floats>(x.simd())));
}
inline double nearest_binary32(double x) { return static_cast<double>(static_cast<float>(x)); }

}  // namespace lostbits::measure::stages
