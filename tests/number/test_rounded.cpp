// Rounded<P> beyond the generic test: every pair of a tiny format against exact fractions, every root of binary16, all
// precisions at run time, and the fast paths against their plain twins.
#include <algorithm>
#include <vector>

#include "catch.hpp"
#include "number/draw.hpp"
#include "number/error.hpp"
#include "number/rounded.hpp"

namespace lostbits::test {
namespace {

/// A format small enough to list, with its exact arithmetic in integers: values in units of the smallest subnormal,
/// 2^-shift. Twice the midpoints of neighbours are integers too.
class TinyFractions {
public:
    explicit TinyFractions(const FloatFormat& format) : shift_(format.precision - 1 - format.emin) {
        const long hidden = 1L << (format.precision - 1);
        for (long k = 0; k < hidden; ++k) numbers_.push_back(k);
        for (int e = format.emin; e <= format.emax; ++e)
            for (long k = hidden; k < 2 * hidden; ++k) numbers_.push_back(k << (e - format.emin));
        numbers_.push_back(2 * hidden << (format.emax - format.emin));  // what overflow rounds to
    }

    /// Every operand: both signs, the infinities and NaN.
    [[nodiscard]] std::vector<double> operands() const {
        std::vector<double> all{HUGE_VAL, -HUGE_VAL, std::nan("")};
        for (std::size_t i = 0; i + 1 < numbers_.size(); ++i) {
            all.push_back(value(i));
            all.push_back(-value(i));
        }
        return all;
    }

    /// The exact operation, rounded to nearest even. Where no finite, non-zero result is at stake, double arithmetic
    /// already has the answer of every format (signed zeros, infinities, NaN).
    [[nodiscard]] double rounded(Op op, double x, double y, double z) const {
        const double machine = apply(op, x, y, z);
        if (!std::isfinite(machine) || machine == 0) return machine;
        const long a = units(x), b = units(y), c = units(z), one = 1L << shift_;
        long numerator = 0, denominator = 1;  // |result| in units; for a root, its square
        switch (op) {
            case Op::add: numerator = a + b; break;
            case Op::subtract: numerator = a - b; break;
            case Op::multiply: numerator = a * b, denominator = one; break;
            case Op::divide: numerator = a * one, denominator = b; break;
            case Op::root: numerator = a * one; break;
            case Op::fused: numerator = a * b + c * one, denominator = one; break;
            default: FAIL("no exact twin");
        }
        numerator = std::labs(numerator), denominator = std::labs(denominator);
        // The first place whose upper midpoint lies above the result; on a midpoint the even place wins, and
        // neighbouring significands alternate, so even places are even significands.
        const auto beyond = [&](std::size_t i) {
            const long twice_middle = numbers_[i] + numbers_[i + 1];
            const long result = op == Op::root ? 4 * numerator : 2 * numerator;
            const long middle = op == Op::root ? twice_middle * twice_middle : twice_middle * denominator;
            return result > middle || (result == middle && i % 2 == 1);
        };
        std::size_t place = 0;
        while (place + 1 < numbers_.size() && beyond(place)) ++place;
        return std::copysign(place + 1 == numbers_.size() ? HUGE_VAL : value(place), machine);
    }

private:
    [[nodiscard]] double value(std::size_t place) const {
        return std::ldexp(static_cast<double>(numbers_[place]), -shift_);
    }
    [[nodiscard]] long units(double x) const { return std::isfinite(x) ? static_cast<long>(std::ldexp(x, shift_)) : 0; }

    int shift_;
    std::vector<long> numbers_;
};

constexpr Op rounding_ops[] = {Op::add, Op::subtract, Op::multiply, Op::divide, Op::root, Op::fused};

double fast(Op op, double a, double b, double c, const FloatFormat& format) {
    switch (op) {
        case Op::add: return rounding::add(a, b, format);
        case Op::subtract: return rounding::add(a, -b, format);
        case Op::multiply: return rounding::mul(a, b, format);
        case Op::divide: return rounding::div(a, b, format);
        case Op::root: return rounding::sqrt(a, format);
        default: return rounding::fma(a, b, c, format);
    }
}

double plain(Op op, double a, double b, double c, const FloatFormat& format) {
    switch (op) {
        case Op::add: return rounding::add_reference(a, b, format);
        case Op::subtract: return rounding::add_reference(a, -b, format);
        case Op::multiply: return rounding::mul_reference(a, b, format);
        case Op::divide: return rounding::div_reference(a, b, format);
        case Op::root: return rounding::sqrt_reference(a, format);
        default: return rounding::fma_reference(a, b, c, format);
    }
}

std::string describe(Op op, double a, double b, double c, const FloatFormat& format) {
    return std::string(op_names[static_cast<int>(op)]) + " a = " + Mpfr(a, 53).text() + " b = " + Mpfr(b, 53).text() +
           " c = " + Mpfr(c, 53).text() + " p" + std::to_string(format.precision) + " [" + std::to_string(format.emin) +
           ", " + std::to_string(format.emax) + "]";
}

}  // namespace

TEST_CASE("every pair of a tiny format rounds as exact fractions do", "[number][rounded]") {
    for (const FloatFormat& format :
         {FloatFormat{2, -3, 3}, FloatFormat{3, -4, 4}, FloatFormat{4, -2, 5}, FloatFormat{5, -5, 5}}) {
        const TinyFractions tiny(format);
        const std::vector<double> all = tiny.operands();
        long wrong = 0, seen = 0;
        for (const Op op : {Op::add, Op::subtract, Op::multiply, Op::divide, Op::root})
            for (const double a : all)
                for (const double b : all) {
                    const double want = tiny.rounded(op, a, b, 0);
                    const bool good = same_number(fast(op, a, b, 0, format), want) &&
                                      same_number(plain(op, a, b, 0, format), want) &&
                                      same_number(correctly_rounded(op, a, b, 0, format), want);
                    if (!good && wrong++ == 0) UNSCOPED_INFO(describe(op, a, b, 0, format) << ": want " << want);
                    ++seen;
                }
        CHECK(wrong == 0);
        CHECK(seen == 5 * static_cast<long>(all.size() * all.size()));
    }
}

TEST_CASE("every fused product and sum of a tiny format rounds correctly", "[number][rounded]") {
    const FloatFormat f{3, -2, 2};
    const TinyFractions tiny(f);
    const std::vector<double> all = tiny.operands();
    long wrong = 0;
    for (const double a : all)
        for (const double b : all)
            for (const double c : all) {
                const double want = tiny.rounded(Op::fused, a, b, c);
                const bool good =
                    same_number(fast(Op::fused, a, b, c, f), want) && same_number(plain(Op::fused, a, b, c, f), want);
                if (!good && wrong++ == 0) UNSCOPED_INFO(describe(Op::fused, a, b, c, f) << ": want " << want);
            }
    CHECK(wrong == 0);
}

TEST_CASE("a tiny format fixed at compile time gives the same results as one set at run time", "[number][rounded]") {
    using T = Rounded<3, -4, 4>;
    const TinyFractions tiny(T::format());
    long wrong = 0;
    for (const double a : tiny.operands())
        for (const double b : tiny.operands())
            for (const Op op : {Op::add, Op::subtract, Op::multiply, Op::divide, Op::root})
                wrong += !same_number(apply(op, T(a), T(b), T(0)).value(), tiny.rounded(op, a, b, 0));
    CHECK(wrong == 0);
}

TEST_CASE("every square root in binary16 rounds correctly", "[number][rounded]") {
    long wrong = 0, seen = 0;
    for (int exponent = -24; exponent <= 15; ++exponent)
        for (int k = 1; k < 2048; ++k) {
            const double a = std::ldexp(k, exponent == -24 ? -24 : exponent - 10);
            if (exponent > -24 && (k < 1024 || exponent < -14)) continue;
            const double r = sqrt(Half(a)).value();
            // r is nearest iff (r − u/2)² < a < (r + u/2)², exactly computed: 12-bit numbers squared. No root is a tie.
            const double half_unit = std::ldexp(1.0, static_cast<int>(ulp_exponent(binary16, std::ilogb(r))) - 1);
            const double below = std::ldexp(1.0, std::ilogb(r)) == r ? half_unit / 2 : half_unit;
            wrong += !((r - below) * (r - below) < a && a < (r + half_unit) * (r + half_unit));
            ++seen;
        }
    CHECK(wrong == 0);
    CHECK(seen > 30 * 1024);
    CHECK(std::isnan(sqrt(Half(-1)).value()));
}

TEST_CASE("every precision from 2 to 53 rounds correctly at run time", "[number][rounded]") {
    Random random(53);
    long wrong = 0;
    for (int p = 2; p <= 53; ++p)
        for (const FloatFormat& format :
             {FloatFormat{p, -1022, 1023}, FloatFormat{p, -126, 127}, FloatFormat{p, -14, 15}, FloatFormat{p, -1, 1}}) {
            const CurrentFormat::Scope scope(format);
            for (const Op op : rounding_ops)
                for (int i = 0; i < 800; ++i) {
                    const auto [a, b, c] = draw_operands(random, format, op);
                    const double got = apply(op, RoundedAny(a), RoundedAny(b), RoundedAny(c)).value();
                    const bool good = same_number(got, correctly_rounded(op, a, b, c, format));
                    if (!good && wrong++ < 3)
                        UNSCOPED_INFO(describe(op, a, b, c, format) << " gives " << Mpfr(got, 53).text());
                }
        }
    CHECK(wrong == 0);
}

TEST_CASE("converting a double to a format rounds once", "[number][rounded]") {
    Random random(11);
    long wrong = 0;
    for (int i = 0; i < 300000; ++i) {
        const int p = static_cast<int>(random.between(2, 53));
        const FloatFormat f = random.one_in(2) ? FloatFormat{p, -1022, 1023} : FloatFormat{p, -14, 15};
        double x = random.one_in(30) ? draw_special(random, binary64)
                                     : draw_finite(random, random.one_in(2) ? binary64 : FloatFormat{53, -20, 16});
        if (random.one_in(4))
            x = std::nextafter(
                std::ldexp(draw_significand(random, std::min(p + 1, 53)), static_cast<int>(random.between(-30, 12))),
                0);
        wrong += !same_number(rounding::to_format(x, 0, f), nearest(Mpfr(x, 53), f));
    }
    CHECK(wrong == 0);
    CHECK(Half(65519.0).value() == 65504);  // the largest double that does not overflow, by half a unit
    CHECK(Half(65520.0).value() == HUGE_VAL);
    CHECK(Half(2049).value() == 2048);  // an int rounds too
}

TEST_CASE("the fast paths agree with their plain versions bit for bit", "[number][rounded]") {
    Random random(1971);
    long wrong = 0;
    for (const FloatFormat& format :
         {binary16, bfloat16, tensor_float32, binary32, binary64, FloatFormat{2, -1022, 1023},
          FloatFormat{26, -1022, 1023}, FloatFormat{27, -1022, 1023}, FloatFormat{51, -1022, 1023},
          FloatFormat{52, -1022, 1023}, FloatFormat{52, -126, 127}})
        for (const Op op : rounding_ops)
            for (int i = 0; i < 40000; ++i) {
                const auto [a, b, c] = draw_operands(random, format, op);
                const bool good = same_number(fast(op, a, b, c, format), plain(op, a, b, c, format));
                if (!good && wrong++ < 3) UNSCOPED_INFO(describe(op, a, b, c, format));
            }
    CHECK(wrong == 0);
}

TEST_CASE("the test of rounding detects a number that is rounded twice", "[number][rounded]") {
    // Traps that a plain "compute in double, then round" falls into: the double lands on a midpoint of the format.
    using T = Rounded<52>;
    Random random(52);
    long wrong = 0, trapped = 0;
    for (int i = 0; i < 200000; ++i)
        for (const Op op : {Op::multiply, Op::divide}) {
            const auto [a, b, c] = draw_operands(random, T::format(), op);
            const double once = correctly_rounded(op, a, b, c, T::format());
            trapped += !same_number(nearest(Mpfr(apply(op, a, b, c), 53), T::format()), once);
            wrong += !same_number(apply(op, T(a), T(b), T(c)).value(), once);
        }
    CHECK(wrong == 0);
    CHECK(trapped > 10000);
}

TEST_CASE("the current format applies within its scope only", "[number][rounded]") {
    REQUIRE_THROWS_AS(CurrentFormat::get(), Error);
    {
        const CurrentFormat::Scope outer(binary16);
        CHECK((RoundedAny(1) / RoundedAny(3)).value() == (Half(1) / Half(3)).value());
        {
            const CurrentFormat::Scope inner(bfloat16);
            CHECK(RoundedAny::format() == bfloat16);
            CHECK((RoundedAny(1) / RoundedAny(3)).value() == (BFloat16(1) / BFloat16(3)).value());
        }
        CHECK(RoundedAny::format() == binary16);
    }
    REQUIRE_THROWS_AS(CurrentFormat::get(), Error);
    const RoundedAny zero;
    REQUIRE_THROWS_AS(RoundedAny(1), Error);
    REQUIRE_THROWS_AS(zero + zero, Error);
}

}  // namespace lostbits::test
