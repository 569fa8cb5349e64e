#include "scene/sweep/float_order.hpp"

#include <algorithm>

namespace lostbits::scene::sweep {

Binade binade_of(float x) {
    using K = Binade::Kind;
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const std::uint32_t sign = bits & 0x80000000U, size = bits & 0x7fffffffU;
    constexpr std::uint32_t infinity = 0x7f800000U, step = 0x00800000U;
    Binade b;
    b.negative = sign != 0;
    std::uint32_t first = size - size % step, last = first + step - 1;  // by |x|
    b.exponent = static_cast<int>(first / step) - 127;
    b.kind = K::normal;
    if (size == 0) b.kind = K::zero, last = 0;
    else if (size < step) b.kind = K::subnormal, first = 1;
    else if (size == infinity) b.kind = K::infinite, last = infinity;
    else if (size > infinity) b.kind = K::not_a_number, first = infinity + 1;
    const std::uint32_t a = index_of(std::bit_cast<float>(first | sign)),
                        c = index_of(std::bit_cast<float>(last | sign));
    b.low = std::min(a, c);
    b.high = std::max(a, c);
    return b;
}

std::string Binade::name() const {
    const std::string sign = negative ? "-" : "+";
    switch (kind) {
        case Kind::zero: return sign + "0";
        case Kind::subnormal: return sign + "subnormal";
        case Kind::normal: return sign + "2^" + std::to_string(exponent);
        case Kind::infinite: return sign + "inf";
        case Kind::not_a_number: break;
    }
    return sign + "nan";
}

}  // namespace lostbits::scene::sweep
