#include "measure/consistency/chord.hpp"

#include <algorithm>
#include <cmath>

#include "measure/truth/side.hpp"

namespace lostbits::measure::consistency {

namespace {

template <class E>
std::optional<Ends<E>> chord_of(const Ray<double>& ray, const Solid<double>& solid) {
    return with_span(lift_ray<E>(ray), lift_solid<E>(solid), [](const auto& span) { return ends_of(span); });
}

/// A number as a double that is off by no more than `error`.
std::optional<double> within(const Ball& x, double error) {
    if (!x.is_bounded() || x.radius() > error / 2) return std::nullopt;
    return x.hi() + x.lo();
}
std::optional<double> within(const Interval& x, double error) {
    if (!x.is_bounded()) return std::nullopt;
    const double low = mpfr_get_d(x.lower(), MPFR_RNDD), high = mpfr_get_d(x.upper(), MPFR_RNDU);
    if (!(high - low <= error)) return std::nullopt;
    return low + (high - low) / 2;
}

template <class E>
std::optional<ChordError> error_of(const EitherEnd& ends, const ToldChord& told, bool distances, double ulp) {
    const auto forth = chord_of<E>(ends.forth, ends.solid), back = chord_of<E>(ends.back, ends.solid);
    if (!forth || !back) return std::nullopt;
    const E size = distances ? length(lift_vec<E>(ends.forth.direction)) : E(1);
    ChordError most;
    const auto take = [&](const E& exact, double one, double other) {
        const E sum = E(one) + E(other);
        const auto apart = within(sum - size, ulp * 0x1p-10);
        const auto excess = within(sum - exact * size, ulp * 0x1p-10);
        if (!apart || !excess) return false;
        most.apart = std::max(most.apart, std::fabs(*apart / ulp));
        most.excess = std::max(most.excess, std::fabs(*excess / ulp));
        return true;
    };
    // Behind the origin by any doubt at all: then it is not compared.
    const bool ahead = (forth->near > E(0)).is_yes(), ahead_back = (back->near > E(0)).is_yes();
    if (ahead && !take(forth->near + back->far, told.near, told.far_back)) return std::nullopt;
    if (ahead_back && !take(forth->far + back->near, told.far, told.near_back)) return std::nullopt;
    return most;
}

}  // namespace

std::optional<ChordError> chord_error(const EitherEnd& ends, const ToldChord& told, bool distances, double ulp) {
    for (const double t : {told.near, told.far, told.near_back, told.far_back}) {
        if (!std::isfinite(t)) return ChordError{HUGE_VAL, HUGE_VAL};
    }
    return truth::by_rising_precision([&]<class E>() { return error_of<E>(ends, told, distances, ulp); });
}

}  // namespace lostbits::measure::consistency
