#include "measure/box_truth.hpp"

#include <cmath>

#include "measure/enclose_box.hpp"
#include "number/error.hpp"

namespace lostbits {
namespace {

template <class E>
Box<E> lift_box(const Box<double>& box) {
    return {lift_vec<E>(box.lo), lift_vec<E>(box.hi)};
}

/// Fills in a miss or a tightly enclosed hit; false where this number E does not settle it.
template <class E>
bool settle(const Ray<double>& ray, const Box<double>& box, double tmax, Touching convention, Truth& truth) {
    const E end = std::isinf(tmax) ? E(0) : E(tmax);
    const auto e = enclose(lift_ray<E>(ray), lift_box<E>(box), std::isinf(tmax) ? nullptr : &end, convention);
    if (e.hit.is_unknown()) return false;
    truth.touches = e.touching;
    if (e.hit.is_no()) return true;
    const auto t = certify(e.t);
    const auto distance = certify(e.distance);
    if (!t || !distance) return false;
    truth.decision = Truth::Decision::hit;
    truth.object = 0;
    truth.t = *t;
    truth.distance = *distance;
    return true;
}

}  // namespace

Truth find_truth(const Ray<double>& ray, const Box<double>& box, double tmax, Touching convention, TruthLimit limit) {
    Truth truth;
    if (tmax == -HUGE_VAL) return truth;
    truth.bits = 106;
    if (settle<Ball>(ray, box, tmax, convention, truth)) return truth;
    for (int bits = 192; bits <= limit.bits; bits *= 2) {
        const Interval::Precision precision(bits);
        truth.bits = bits;
        if (settle<Interval>(ray, box, tmax, convention, truth)) return truth;
    }
    truth.decision = Truth::Decision::unresolved;
    return truth;
}

double round_truth(const Truth& truth, const Ray<double>& ray, const Box<double>& box, const FloatFormat& format) {
    const auto [lower, upper] = round_ends(truth.t, format);
    if (lower == upper) return lower;
    for (int bits = 192; bits <= TruthLimit{}.bits; bits *= 2) {
        const Interval::Precision precision(bits);
        // The boundary that the bound straddles: midway between the two, or half a last place above the largest number.
        const Interval middle = std::isinf(upper) ? Interval(lower) + Interval(std::ldexp(1.0, format.emax - format.precision))
                                                  : (Interval(lower) + Interval(upper)) / Interval(2);
        const auto side = side_of(lift_ray<Interval>(ray), lift_box<Interval>(box), middle);
        if (!side) continue;
        if (*side != 0) return *side < 0 ? lower : upper;
        return ordinal(lower, format) % 2 == 0 ? lower : upper;
    }
    throw Error(Exit::internal, "no precision told the side of a rounding boundary");
}

}  // namespace lostbits
