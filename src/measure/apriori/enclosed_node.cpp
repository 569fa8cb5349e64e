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
    return enclose_between(smaller(a, b, &Interval::lower), smaller(a, b, &Interval::upper));
}
Interval hull(const Interval& a, const Interval& b) { return select(Tri::unknown, a, b); }
Interval from_zero(const Interval& a) { return hull(Interval(0), a); }
Interval mean(const Interval& a, const Interval& b) { return (a + b) / Interval(2); }
/// Returns +1 or −1 if all numbers are on that side of zero, else 0.
int sign_of(const Interval& x) { return mpfr_sgn(x.lower()) > 0 ? 1 : mpfr_sgn(x.upper()) < 0 ? -1 : 0; }

double largest_of(const FloatFormat& format) {
    return std::ldexp(2 - std::ldexp(1.0, 1 - format.precision), format.emax);
}

/// The nearest number of the format to x, rounded once.
double nearest(mpfr_srcptr x, const FloatFormat& format) {
    const double nearest_double = mpfr_get_d(x, MPFR_RNDN);
    return format == binary64 ? nearest_double
                              : rounding::to_format(nearest_double, mpfr_cmp_d(x, nearest_double), format);
}

/// ⌊log2⌋ of the largest magnitude in x.
long exponent_of(const Interval& x) {
    const double magnitude = upper_magnitude(x);
    return magnitude > 0 ? std::ilogb(magnitude) : -100000;
}

/// Half of the last place of the largest magnitude in x, with both signs: 2^(e − p) below 2^(e + 1), and at least
/// 2^(emin − p), which is 2^-150 in binary32. (A double cannot hold half of its own least number; an interval can.)
Interval half_a_place(const Interval& x, const FloatFormat& format) {
    const double last_place = std::ldexp(1.0, static_cast<int>(ulp_exponent(format, exponent_of(x))));
    return Interval::between(-last_place, last_place) / Interval(2);
}

/// True if x is 1, 2, 4, 8, …, so that the product of x and a number of the format is exact.
bool is_scale(const Interval& x) {
    int exponent = 0;
    return x.is_exact() && std::frexp(lower_magnitude(x), &exponent) == 0.5 && exponent > 0 &&
           lower_magnitude(x) == upper_magnitude(x);
}

/// True if a + b is exact. The difference of two numbers of a format that are within a factor 2 of each other is a
/// number of the format (Sterbenz). Every sum below twice the least normal number is one too, because it is a multiple
/// of the least number.
bool is_exact_sum(const Interval& a, const Interval& b, const FloatFormat& format) {
    if (exponent_of(a + b) <= format.emin) return true;
    const int sign = sign_of(a);
    if (sign == 0 || sign_of(b) != -sign) return false;
    const Interval x = abs(a), y = abs(b), two(2);
    return (x <= two * y).is_yes() && (y <= two * x).is_yes();
}

/// Sets the computed value and the rounding error of an operation whose exact results on the computed operands lie in
/// `raw`. Rounding is monotone, so the ends of `raw` are rounded. If both ends round to the same number c, the error is
/// c − raw. Otherwise it is at most half of the last place of the largest magnitude.
void set_rounded(EnclosedNode& r, const Interval& raw, const FloatFormat& format, bool is_exact = false) {
    r.is_known = r.exact.is_bounded() && raw.is_bounded();
    if (!r.is_known) return;
    const double low = nearest(raw.lower(), format), high = nearest(raw.upper(), format);
    r.is_known = std::fabs(low) <= largest_of(format) && std::fabs(high) <= largest_of(format);
    if (!r.is_known) return;
    r.computed = Interval::between(low, high);
    r.rounding = is_exact ? Interval(0) : low == high ? r.computed - raw : half_a_place(raw, format);
}

bool holds(const FloatFormat& wide, const FloatFormat& narrow) {
    return wide.precision >= narrow.precision && wide.emin <= narrow.emin && wide.emax >= narrow.emax;
}

EnclosedNode sum(const EnclosedNode& a, const EnclosedNode& b, int sign, const FloatFormat& format) {
    const Interval factor(sign);
    EnclosedNode r;
    r.exact = a.exact + factor * b.exact;
    r.quotients = {Interval(1), factor, {}};
    const Interval signed_b = factor * b.computed;
    set_rounded(r, a.computed + signed_b, format, is_exact_sum(a.computed, signed_b, format));
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
    set_rounded(r, raw, context.format, !c && (is_scale(a.computed) || is_scale(b.computed)));
    return r;
}

EnclosedNode quotient(const EnclosedNode& a, const EnclosedNode& b, const FloatFormat& format) {
    EnclosedNode r;
    if (sign_of(b.exact) == 0 || sign_of(b.computed) == 0) return r;
    const Interval one(1);
    r.exact = a.exact / b.exact;
    r.quotients = {mean(one / b.exact, one / b.computed), -(mean(a.exact, a.computed) / b.exact / b.computed), {}};
    set_rounded(r, a.computed / b.computed, format);
    return r;
}

EnclosedNode root(const EnclosedNode& a, const FloatFormat& format) {
    EnclosedNode r;
    const Interval raw = sqrt(a.computed);
    r.exact = sqrt(a.exact);
    const Interval root_sum = r.exact + raw;
    const bool has_error = !is_zero(a.exact - a.computed);
    if (!root_sum.is_bounded() || (has_error && sign_of(root_sum) == 0)) return r;
    r.quotients[0] = has_error ? Interval(1) / root_sum : Interval(0);
    set_rounded(r, raw, format);
    return r;
}

EnclosedNode absolute_value(const EnclosedNode& a) {
    EnclosedNode r{.is_known = true, .exact = abs(a.exact), .computed = abs(a.computed), .rounding = Interval(0)};
    const int sign = sign_of(a.exact);
    r.quotients[0] = sign != 0 && sign == sign_of(a.computed) ? Interval(sign) : Interval::between(-1, 1);
    return r;
}

/// |a| with the sign of b. If the sign is not known, it may differ with and without rounding. The two values are then
/// |a^| + |a| apart.
EnclosedNode with_sign_of(const EnclosedNode& a, const EnclosedNode& b) {
    EnclosedNode r = absolute_value(a);
    const int sign = sign_of(b.exact);
    if (sign != 0 && sign == sign_of(b.computed)) {
        const Interval factor(sign);
        r.exact = factor * r.exact;
        r.computed = factor * r.computed;
        r.quotients[0] = factor * r.quotients[0];
        return r;
    }
    const Interval any_sign = Interval::between(-1, 1), jump = r.exact + r.computed;
    r.exact = any_sign * r.exact;
    r.computed = any_sign * r.computed;
    r.rounding = any_sign * jump;
    r.may_jump = true;
    r.quotients[0] = Interval(0);
    return r;
}

/// The next number of the format, whose distance is at most one last place.
EnclosedNode neighbour(const EnclosedNode& a, int sign, const FloatFormat& format) {
    EnclosedNode r{.is_known = true, .exact = a.exact};
    const double gap = std::ldexp(1.0, static_cast<int>(ulp_exponent(format, exponent_of(a.computed))));
    r.rounding = Interval(sign) * Interval::between(0, gap);
    r.computed = a.computed + r.rounding;
    r.quotients[0] = Interval(1);
    r.is_known = upper_magnitude(r.computed) <= largest_of(format);
    return r;
}

EnclosedNode convert_node(const EnclosedNode& a, const NodeContext& context) {
    EnclosedNode r{.is_known = true, .exact = a.exact, .computed = a.computed, .rounding = Interval(0)};
    r.quotients[0] = Interval(1);
    if (!holds(context.format, context.operand_format)) set_rounded(r, a.computed, context.format);
    return r;
}

/// min(a^, b^) − min(a, b) = q (a^ − a) + (1 − q)(b^ − b) with q from 0 to 1.
EnclosedNode smaller_of(const EnclosedNode& a, const EnclosedNode& b) {
    EnclosedNode r{.is_known = true,
                   .exact = least(a.exact, b.exact),
                   .computed = least(a.computed, b.computed),
                   .rounding = Interval(0)};
    const Tri exact = a.exact < b.exact, computed = a.computed < b.computed;
    const Interval first_fraction =
        exact == computed && !exact.is_unknown() ? Interval(exact.is_yes() ? 1 : 0) : Interval::between(0, 1);
    r.quotients = {first_fraction, Interval(1) - first_fraction, {}};
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

/// Selects a or b by a decision. If the decision may differ with and without rounding, then a^ − b = (a^ − a) + (a −
/// b), and b^ − a = (b^ − b) + (b − a).
EnclosedNode select_side(const EnclosedNode& mask, const EnclosedNode& a, const EnclosedNode& b) {
    const Tri exact = mask.exact_decision, computed = mask.computed_decision;
    EnclosedNode r;
    if (exact == computed && !exact.is_unknown()) {
        const EnclosedNode& selected = exact.is_yes() ? a : b;
        r.is_known = selected.is_known;
        if (!r.is_known) return r;
        r.exact = selected.exact;
        r.computed = selected.computed;
        r.quotients = {Interval(0), Interval(exact.is_yes() ? 1 : 0), Interval(exact.is_yes() ? 0 : 1)};
        return r;
    }

    r.is_known = a.is_known && b.is_known;
    if (!r.is_known) return r;
    r.exact = select(exact, a.exact, b.exact);
    r.computed = select(computed, a.computed, b.computed);

    const Interval jump = a.exact - b.exact;
    r.rounding = hull(from_zero(jump), -jump);
    r.may_jump = true;
    r.quotients = {Interval(0), Interval::between(0, 1), Interval::between(0, 1)};
    return r;
}

EnclosedNode constant(const TapeNode& node) {
    EnclosedNode r = enclose_input(node.value, node.value);
    r.exact = Interval(static_cast<int>(node.operands[0]));
    r.rounding = r.computed - r.exact;
    return r;
}

EnclosedNode compare(const EnclosedNode& a, const EnclosedNode& b, bool strictly) {
    EnclosedNode r;
    if (!a.is_known || !b.is_known) return r;
    r.exact_decision = strictly ? a.exact < b.exact : a.exact <= b.exact;
    r.computed_decision = strictly ? a.computed < b.computed : a.computed <= b.computed;
    return r;
}

EnclosedNode combine(const EnclosedNode& a, const EnclosedNode& b, bool is_conjunction) {
    EnclosedNode r;
    r.exact_decision = is_conjunction ? a.exact_decision && b.exact_decision : a.exact_decision || b.exact_decision;
    r.computed_decision =
        is_conjunction ? a.computed_decision && b.computed_decision : a.computed_decision || b.computed_decision;
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

double upper_magnitude(const Interval& x) {
    return std::max(std::fabs(mpfr_get_d(x.lower(), MPFR_RNDD)), std::fabs(mpfr_get_d(x.upper(), MPFR_RNDU)));
}

double lower_magnitude(const Interval& x) {
    const int sign = sign_of(x);
    return sign > 0 ? mpfr_get_d(x.lower(), MPFR_RNDD) : sign < 0 ? -mpfr_get_d(x.upper(), MPFR_RNDU) : 0;
}

EnclosedNode enclose_input(double low, double high) {
    const auto to_interval = [](double x) {
        if (!std::isinf(x)) return Interval(x);
        Interval large(0x1p1000);
        for (int k = 0; k < 3; ++k) large = large * large;
        return x > 0 ? large : -large;
    };
    EnclosedNode r{
        .is_known = true, .exact = enclose_between(to_interval(low), to_interval(high)), .rounding = Interval(0)};
    r.computed = r.exact;
    return r;
}

EnclosedNode enclose(const NodeContext& context) {
    const TapeOp op = context.node.op;
    if (op == TapeOp::constant) return constant(context.node);
    const EnclosedNode &a = *context.operands[0], &b = context.operands[1] ? *context.operands[1] : a;
    if (op == TapeOp::select) return select_side(a, b, *context.operands[2]);
    if (is_operation(op) && !std::ranges::all_of(context.operands, [](const auto* x) { return !x || x->is_known; }))
        return {};

    switch (op) {
        // Arithmetic.
        case TapeOp::add: return sum(a, b, 1, context.format);
        case TapeOp::sub: return sum(a, b, -1, context.format);
        case TapeOp::mul: return product(a, b, nullptr, context);
        case TapeOp::fma: return product(a, b, context.operands[2], context);
        case TapeOp::div: return quotient(a, b, context.format);
        case TapeOp::sqrt: return root(a, context.format);

        // Sign and size.
        case TapeOp::neg: {
            EnclosedNode r{.is_known = true, .exact = -a.exact, .computed = -a.computed, .rounding = Interval(0)};
            r.quotients[0] = Interval(-1);
            return r;
        }
        case TapeOp::abs: return absolute_value(a);
        case TapeOp::copysign: return with_sign_of(a, b);
        case TapeOp::min: return smaller_of(a, b);
        case TapeOp::max: return larger_of(a, b);

        // Moves to another number or format.
        case TapeOp::next_up: return neighbour(a, 1, context.format);
        case TapeOp::next_down: return neighbour(a, -1, context.format);
        case TapeOp::convert: return convert_node(a, context);

        // Decisions.
        case TapeOp::less: return compare(a, b, true);
        case TapeOp::less_equal: return compare(a, b, false);
        case TapeOp::greater: return compare(b, a, true);
        case TapeOp::greater_equal: return compare(b, a, false);
        case TapeOp::logical_and: return combine(a, b, true);
        case TapeOp::logical_or: return combine(a, b, false);
        case TapeOp::logical_not: return opposite(a);
        case TapeOp::any: return a;
        default: return {};  // a call has no enclosure; inputs, constants and select are handled above
    }
}

}  // namespace lostbits::measure::apriori
