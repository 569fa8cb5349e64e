#include "measure/apriori/enclosed_node.hpp"

#include <algorithm>
#include <cmath>

#include "number/rounded.hpp"

namespace lostbits::measure::apriori {

namespace {

const Interval& smaller(const Interval& a, const Interval& b, mpfr_srcptr (Interval::*end)() const) {
    return mpfr_less_p((a.*end)(), (b.*end)()) != 0 ? a : b;
}
Interval least(const Interval& a, const Interval& b) {
    return between(smaller(a, b, &Interval::lower), smaller(a, b, &Interval::upper));
}
Interval hull(const Interval& a, const Interval& b) { return select(Tri::unknown, a, b); }
Interval from_zero(const Interval& a) { return hull(Interval(0), a); }
Interval mean(const Interval& a, const Interval& b) { return (a + b) / Interval(2); }
/// +1 or −1 if all numbers are on that side of zero, else 0.
int sign_of(const Interval& x) { return mpfr_sgn(x.lower()) > 0 ? 1 : mpfr_sgn(x.upper()) < 0 ? -1 : 0; }

double largest_of(const FloatFormat& f) { return std::ldexp(2 - std::ldexp(1.0, 1 - f.precision), f.emax); }

/// Rounds to the nearest number of the format, in one step.
double nearest(mpfr_srcptr x, const FloatFormat& f) {
    const double near = mpfr_get_d(x, MPFR_RNDN);
    return f == binary64 ? near : rounding::to_format(near, mpfr_cmp_d(x, near), f);
}

/// ⌊log2⌋ of the largest magnitude.
long exponent_of(const Interval& x) {
    const double most = largest_magnitude(x);
    return most > 0 ? std::ilogb(most) : -100000;
}

/// Half of the last place of the largest magnitude in x, with both signs: 2^(e − p) below 2^(e + 1), and at least
/// 2^(emin − p), which is 2^-150 in binary32. (A double cannot hold half of its own least number; an interval can.)
Interval half_a_place(const Interval& x, const FloatFormat& f) {
    const double place = std::ldexp(1.0, static_cast<int>(ulp_exponent(f, exponent_of(x))));
    return Interval::between(-place, place) / Interval(2);
}

/// True if x is 1, 2, 4, 8, …: multiplying a number of the format by it is exact.
bool is_scale(const Interval& x) {
    int exponent = 0;
    return x.is_exact() && std::frexp(least_magnitude(x), &exponent) == 0.5 && exponent > 0 &&
           least_magnitude(x) == largest_magnitude(x);
}

/// True if the sum is exact. The difference of two numbers of a format that are within a factor 2 of each other is a
/// number of the format (Sterbenz). So is every sum below twice the least normal number: it is a multiple of the least
/// number.
bool is_exact_sum(const Interval& a, const Interval& b, const FloatFormat& f) {
    if (exponent_of(a + b) <= f.emin) return true;
    const int sign = sign_of(a);
    if (sign == 0 || sign_of(b) != -sign) return false;
    const Interval x = abs(a), y = abs(b), two(2);
    return (x <= two * y).is_yes() && (y <= two * x).is_yes();
}

/// Sets the computed value and the rounding error of an operation whose results on the computed operands lie in `raw`.
/// Rounding is monotone, so the ends of `raw` are rounded. If both go to one number c, the error is c − raw; otherwise
/// it is at most half of the last place of the largest magnitude.
void put_rounded(EnclosedNode& r, const Interval& raw, const FloatFormat& format, bool is_exact = false) {
    r.known = r.exact.is_bounded() && raw.is_bounded();
    if (!r.known) return;
    const double low = nearest(raw.lower(), format), high = nearest(raw.upper(), format);
    r.known = std::fabs(low) <= largest_of(format) && std::fabs(high) <= largest_of(format);
    if (!r.known) return;
    r.computed = Interval::between(low, high);
    r.rounding = is_exact ? Interval(0) : low == high ? r.computed - raw : half_a_place(raw, format);
}

bool holds(const FloatFormat& wide, const FloatFormat& narrow) {
    return wide.precision >= narrow.precision && wide.emin <= narrow.emin && wide.emax >= narrow.emax;
}

EnclosedNode sum(const EnclosedNode& a, const EnclosedNode& b, int sign, const FloatFormat& format) {
    const Interval to(sign);
    EnclosedNode r;
    r.exact = a.exact + to * b.exact;
    r.quotients = {Interval(1), to, {}};
    const Interval moved = to * b.computed;
    put_rounded(r, a.computed + moved, format, is_exact_sum(a.computed, moved, format));
    return r;
}

EnclosedNode product(const EnclosedNode& a, const EnclosedNode& b, const EnclosedNode* c, const NodeContext& context) {
    const bool is_square = context.node.operands[0] == context.node.operands[1];
    EnclosedNode r;
    r.exact = is_square ? square(a.exact) : a.exact * b.exact;
    Interval raw = is_square ? square(a.computed) : a.computed * b.computed;
    r.quotients = {mean(b.exact, b.computed), mean(a.exact, a.computed), {}};
    if (c) {
        r.exact = r.exact + c->exact;
        raw = raw + c->computed;
        r.quotients[2] = Interval(1);
    }
    put_rounded(r, raw, context.format, !c && (is_scale(a.computed) || is_scale(b.computed)));
    return r;
}

EnclosedNode quotient(const EnclosedNode& a, const EnclosedNode& b, const FloatFormat& format) {
    EnclosedNode r;
    if (sign_of(b.exact) == 0 || sign_of(b.computed) == 0) return r;
    const Interval one(1);
    r.exact = a.exact / b.exact;
    r.quotients = {mean(one / b.exact, one / b.computed), -(mean(a.exact, a.computed) / b.exact / b.computed), {}};
    put_rounded(r, a.computed / b.computed, format);
    return r;
}

EnclosedNode root(const EnclosedNode& a, const FloatFormat& format) {
    EnclosedNode r;
    const Interval raw = sqrt(a.computed);
    r.exact = sqrt(a.exact);
    const Interval both = r.exact + raw;
    const bool moves = !is_zero(a.exact - a.computed);
    if (!both.is_bounded() || (moves && sign_of(both) == 0)) return r;
    r.quotients[0] = moves ? Interval(1) / both : Interval(0);
    put_rounded(r, raw, format);
    return r;
}

EnclosedNode size(const EnclosedNode& a) {
    EnclosedNode r{.known = true, .exact = abs(a.exact), .computed = abs(a.computed), .rounding = Interval(0)};
    const int sign = sign_of(a.exact);
    r.quotients[0] = sign != 0 && sign == sign_of(a.computed) ? Interval(sign) : Interval::between(-1, 1);
    return r;
}

/// |a| with the sign of b. If the sign is open, it may differ with and without rounding; the two values are then |a^| +
/// |a| apart.
EnclosedNode signed_as(const EnclosedNode& a, const EnclosedNode& b) {
    EnclosedNode r = size(a);
    const int sign = sign_of(b.exact);
    if (sign != 0 && sign == sign_of(b.computed)) {
        const Interval to(sign);
        r.exact = to * r.exact;
        r.computed = to * r.computed;
        r.quotients[0] = to * r.quotients[0];
        return r;
    }
    const Interval both = Interval::between(-1, 1), apart = r.exact + r.computed;
    r.exact = both * r.exact;
    r.computed = both * r.computed;
    r.rounding = both * apart;
    r.jumps = true;
    r.quotients[0] = Interval(0);
    return r;
}

/// The next number of the format, which is at most one last place away.
EnclosedNode neighbour(const EnclosedNode& a, int sign, const FloatFormat& format) {
    EnclosedNode r{.known = true, .exact = a.exact};
    const double gap = std::ldexp(1.0, static_cast<int>(ulp_exponent(format, exponent_of(a.computed))));
    r.rounding = Interval(sign) * Interval::between(0, gap);
    r.computed = a.computed + r.rounding;
    r.quotients[0] = Interval(1);
    r.known = largest_magnitude(r.computed) <= largest_of(format);
    return r;
}

EnclosedNode converted(const EnclosedNode& a, const NodeContext& context) {
    EnclosedNode r{.known = true, .exact = a.exact, .computed = a.computed, .rounding = Interval(0)};
    r.quotients[0] = Interval(1);
    if (!holds(context.format, context.from)) put_rounded(r, a.computed, context.format);
    return r;
}

/// min(a^, b^) − min(a, b) = q (a^ − a) + (1 − q)(b^ − b) with q from 0 to 1.
EnclosedNode smaller_of(const EnclosedNode& a, const EnclosedNode& b) {
    EnclosedNode r{.known = true,
                   .exact = least(a.exact, b.exact),
                   .computed = least(a.computed, b.computed),
                   .rounding = Interval(0)};
    const Tri exact = a.exact < b.exact, computed = a.computed < b.computed;
    const Interval part =
        exact == computed && !exact.is_unknown() ? Interval(exact.is_yes() ? 1 : 0) : Interval::between(0, 1);
    r.quotients = {part, Interval(1) - part, {}};
    return r;
}

EnclosedNode negative(const EnclosedNode& a) {
    EnclosedNode r = a;
    r.exact = -a.exact;
    r.computed = -a.computed;
    r.rounding = -a.rounding;
    return r;
}

/// −min(−a, −b): the quotients are those of the smaller of −a and −b.
EnclosedNode larger_of(const EnclosedNode& a, const EnclosedNode& b) {
    return negative(smaller_of(negative(a), negative(b)));
}

/// Chooses a or b by a decision. If the decision may differ with and without rounding, then a^ − b = (a^ − a) + (a −
/// b), and b^ − a = (b^ − b) + (b − a).
EnclosedNode chosen(const EnclosedNode& mask, const EnclosedNode& a, const EnclosedNode& b) {
    const Tri exact = mask.exact_decision, computed = mask.computed_decision;
    EnclosedNode r;
    if (exact == computed && !exact.is_unknown()) {
        const EnclosedNode& side = exact.is_yes() ? a : b;
        r.known = side.known;
        if (!r.known) return r;
        r.exact = side.exact;
        r.computed = side.computed;
        r.quotients = {Interval(0), Interval(exact.is_yes() ? 1 : 0), Interval(exact.is_yes() ? 0 : 1)};
        return r;
    }
    r.known = a.known && b.known;
    if (!r.known) return r;
    r.exact = select(exact, a.exact, b.exact);
    r.computed = select(computed, a.computed, b.computed);
    const Interval apart = a.exact - b.exact;
    r.rounding = hull(from_zero(apart), -apart);
    r.jumps = true;
    r.quotients = {Interval(0), Interval::between(0, 1), Interval::between(0, 1)};
    return r;
}

EnclosedNode constant(const TapeNode& node) {
    EnclosedNode r = enclose_input(node.value, node.value);
    r.exact = Interval(static_cast<int>(node.operands[0]));
    r.rounding = r.computed - r.exact;
    return r;
}

EnclosedNode compared(const EnclosedNode& a, const EnclosedNode& b, bool strictly) {
    EnclosedNode r;
    if (!a.known || !b.known) return r;
    r.exact_decision = strictly ? a.exact < b.exact : a.exact <= b.exact;
    r.computed_decision = strictly ? a.computed < b.computed : a.computed <= b.computed;
    return r;
}

EnclosedNode decided(const EnclosedNode& a, const EnclosedNode& b, bool both) {
    EnclosedNode r;
    r.exact_decision = both ? a.exact_decision && b.exact_decision : a.exact_decision || b.exact_decision;
    r.computed_decision =
        both ? a.computed_decision && b.computed_decision : a.computed_decision || b.computed_decision;
    return r;
}

EnclosedNode opposite(const EnclosedNode& a) {
    EnclosedNode r;
    r.exact_decision = !a.exact_decision;
    r.computed_decision = !a.computed_decision;
    return r;
}

}  // namespace

bool is_zero(const Interval& x) { return x.is_exact() && mpfr_zero_p(x.lower()) != 0; }

double largest_magnitude(const Interval& x) {
    return std::max(std::fabs(mpfr_get_d(x.lower(), MPFR_RNDD)), std::fabs(mpfr_get_d(x.upper(), MPFR_RNDU)));
}

double least_magnitude(const Interval& x) {
    const int sign = sign_of(x);
    return sign > 0 ? mpfr_get_d(x.lower(), MPFR_RNDD) : sign < 0 ? -mpfr_get_d(x.upper(), MPFR_RNDU) : 0;
}

EnclosedNode enclose_input(double low, double high) {
    const auto lifted = [](double x) {
        if (!std::isinf(x)) return Interval(x);
        Interval beyond(0x1p1000);
        for (int k = 0; k < 3; ++k) beyond = beyond * beyond;
        return x > 0 ? beyond : -beyond;
    };
    EnclosedNode r{.known = true, .exact = between(lifted(low), lifted(high)), .rounding = Interval(0)};
    r.computed = r.exact;
    return r;
}

EnclosedNode enclose(const NodeContext& context) {
    const TapeOp op = context.node.op;
    if (op == TapeOp::constant) return constant(context.node);
    const EnclosedNode &a = *context.operands[0], &b = context.operands[1] ? *context.operands[1] : a;
    if (op == TapeOp::select) return chosen(a, b, *context.operands[2]);
    if (is_operation(op) && !std::ranges::all_of(context.operands, [](const auto* x) { return !x || x->known; }))
        return {};
    switch (op) {
        case TapeOp::add: return sum(a, b, 1, context.format);
        case TapeOp::sub: return sum(a, b, -1, context.format);
        case TapeOp::mul: return product(a, b, nullptr, context);
        case TapeOp::fma: return product(a, b, context.operands[2], context);
        case TapeOp::div: return quotient(a, b, context.format);
        case TapeOp::sqrt: return root(a, context.format);
        case TapeOp::neg: {
            EnclosedNode r{.known = true, .exact = -a.exact, .computed = -a.computed, .rounding = Interval(0)};
            r.quotients[0] = Interval(-1);
            return r;
        }
        case TapeOp::abs: return size(a);
        case TapeOp::copysign: return signed_as(a, b);
        case TapeOp::min: return smaller_of(a, b);
        case TapeOp::max: return larger_of(a, b);
        case TapeOp::next_up: return neighbour(a, 1, context.format);
        case TapeOp::next_down: return neighbour(a, -1, context.format);
        case TapeOp::convert: return converted(a, context);
        case TapeOp::less: return compared(a, b, true);
        case TapeOp::less_equal: return compared(a, b, false);
        case TapeOp::greater: return compared(b, a, true);
        case TapeOp::greater_equal: return compared(b, a, false);
        case TapeOp::both: return decided(a, b, true);
        case TapeOp::either: return decided(a, b, false);
        case TapeOp::opposite: return opposite(a);
        case TapeOp::any: return a;
        default: return {};  // a call has no enclosure; inputs and the rest are handled above
    }
}

}  // namespace lostbits::measure::apriori
