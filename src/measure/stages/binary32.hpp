// Rounding to binary32, for packs of doubles and for one.
#pragma once

#include "number/pack.hpp"

namespace lostbits::measure::stages {

/// The float nearest to x.
template <class Width>
Pack<double, Width> nearest_binary32(const Pack<double, Width>& x) {
    using P = Pack<double, Width>;
    if constexpr (has_pack_registers) {
        return P(typename P::Register(pack_rounded(x.registers())));
    } else {
        double lanes[P::lanes];
        x.store(lanes);
        for (double& lane : lanes) lane = static_cast<double>(static_cast<float>(lane));
        return P::load(lanes);
    }
}
inline double nearest_binary32(double x) { return static_cast<double>(static_cast<float>(x)); }

}  // namespace lostbits::measure::stages
