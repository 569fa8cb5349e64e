#include "scene/sweep/float_order.hpp"

#include <algorithm>

namespace lostbits::scene::sweep {

Binade binade_of(float x) {
    using K = Binade::Kind;
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const std::uint32_t sign = bits & 0x80000000U, size = bits & 0x7fffffffU;
    constexpr std::uint32_t infinity = 0x7f800000U, binade_size = 0x00800000U;
    Binade binade;
    binade.negative = sign != 0;
    std::uint32_t first = size - size % binade_size, last = first + binade_size - 1;  // by |x|
    binade.exponent = static_cast<int>(first / binade_size) - 127;
    binade.kind = K::normal;
    if (size == 0) binade.kind = K::zero, last = 0;
    else if (size < binade_size) binade.kind = K::subnormal, first = 1;
    else if (size == infinity) binade.kind = K::infinite, last = infinity;
    else if (size > infinity) binade.kind = K::not_a_number, first = infinity + 1;
    const std::uint32_t first_index = index_of(std::bit_cast<float>(first | sign)),
                        last_index = index_of(std::bit_cast<float>(last | sign));
    binade.low = std::min(first_index, last_index);
    binade.high = std::max(first_index, last_index);
    return binade;
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
