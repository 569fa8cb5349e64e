#include "measure/truth/unit_direction.hpp"

#include "measure/truth/certified.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::truth {
namespace {

/// One component at one precision; nothing where the enclosure straddles a rounding boundary.
template <class E>
std::optional<double> component(double part, const E& length, const FloatFormat& format) {
    if (part == 0) return part;
    const auto x = certify(E(part) / length);
    return x ? round_certified(*x, format) : std::nullopt;
}

template <class E>
E length_of(const Vec<double>& d) {
    return length(Vec<E>(E(d.x), E(d.y), E(d.z)));
}

double settle(double part, const Vec<double>& d, const FloatFormat& format) {
    std::optional<Certified> last;
    for (int bits = 192; bits <= 8192; bits *= 2) {
        const Interval::Precision precision(bits);
        const Interval length = length_of<Interval>(d);
        if (const auto x = component(part, length, format)) return *x;
        last = certify(Interval(part) / length);
    }
    if (!last) return missing;
    // A component exactly half way (3/5 of a power of two, say, in a tiny format): to even, as the midpoint rounds.
    last->bound = 0;
    return round_certified(*last, format).value_or(missing);
}

}  // namespace

Vec<double> unit_direction(const Vec<double>& d, const FloatFormat& format) {
    const Ball length = length_of<Ball>(d);
    const auto part = [&](double x) {
        const auto quick = component(x, length, format);
        return quick ? *quick : settle(x, d, format);
    };
    return Vec<double>(part(d.x), part(d.y), part(d.z));
}

}  // namespace lostbits::measure::truth
