// The rounding of one operation compared with MPFR; cancellation; differences that pass through an operation.
#include "measure/attribution/operation_error.hpp"

#include "catch.hpp"
#include "number/draw.hpp"
#include "number/real.hpp"
#include "number/recorded.hpp"

namespace lostbits::test::test_operation_error {
namespace {

constexpr std::array<std::pair<TapeOp, Op>, 6> arithmetic{{{TapeOp::add, Op::add},
                                                           {TapeOp::sub, Op::subtract},
                                                           {TapeOp::mul, Op::multiply},
                                                           {TapeOp::div, Op::divide},
                                                           {TapeOp::sqrt, Op::root},
                                                           {TapeOp::fma, Op::fused}}};

}  // namespace

TEST_CASE("the rounding error of an operation is its result minus the exact one", "[attribution]") {
    Random random(11);
    int seen = 0;
    for (const FloatFormat& format : {binary32, binary64, bfloat16, FloatFormat{30, -1022, 1023}})
        for (const auto& [op, oracle] : arithmetic)
            for (int i = 0; i < 3000; ++i) {
                const auto x = draw_operands(random, format, oracle);
                Tape tape;
                std::array<NodeId, 3> id{};
                for (std::size_t k = 0; k < 3; ++k) id[k] = tape.add_input(format, x[k]);
                const bool binary = op != TapeOp::sqrt, ternary = op == TapeOp::fma;
                const double value = measure::attribution::result_of(op, x, format);
                const NodeId n =
                    tape.add(op, format, value, {id[0], binary ? id[1] : no_node, ternary ? id[2] : no_node});
                Mpfr exact(4400), off(200);
                const Mpfr a(x[0], 53), b(x[1], 53), c(x[2], 53);
                evaluate(oracle, exact, {a, b, c}, MPFR_RNDN);
                if (!std::isfinite(value) || mpfr_number_p(exact) == 0) continue;
                mpfr_d_sub(off, value, exact, MPFR_RNDN);
                const double want = mpfr_get_d(off, MPFR_RNDN), got = measure::attribution::rounding_of(tape, n);
                INFO(name_of(op) << " " << Mpfr(x[0], 53).text() << " " << Mpfr(x[1], 53).text() << " "
                                 << Mpfr(x[2], 53).text());
                // A quotient of 4400 bits is not exact either.
                const bool endless = op == TapeOp::div || op == TapeOp::sqrt;
                if (endless && std::fabs(want) < std::ldexp(std::fabs(value), -1000)) REQUIRE(got == 0);
                else REQUIRE(std::fabs(got - want) <= 0x1p-40 * std::fabs(want));
                ++seen;
            }
    CHECK(seen > 40000);
}

TEST_CASE("a difference passes through an operation by its exact difference quotient", "[attribution]") {
    Random random(12);
    const auto evaluated = [](TapeOp op, double a, double b, double c) {
        const BasicReal<400> x(a), y(b), z(c);
        switch (op) {
            case TapeOp::add: return x + y;
            case TapeOp::sub: return x - y;
            case TapeOp::mul: return x * y;
            case TapeOp::div: return x / y;
            case TapeOp::sqrt: return BasicReal<400>(sqrt(x));
            case TapeOp::abs: return BasicReal<400>(abs(x));
            case TapeOp::neg: return BasicReal<400>(-x);
            default: return BasicReal<400>(x * y + z);
        }
    };
    for (const TapeOp op :
         {TapeOp::add, TapeOp::sub, TapeOp::mul, TapeOp::div, TapeOp::sqrt, TapeOp::abs, TapeOp::neg, TapeOp::fma})
        for (int i = 0; i < 2000; ++i) {
            std::array<measure::attribution::OperandError, 3> x;
            for (measure::attribution::OperandError& o : x) {
                o.to = std::ldexp(random.sign() * (1 + random.unit()), static_cast<int>(random.between(-3, 3)));
                o.from = o.to * (1 + 0.4 * (2 * random.unit() - 1));  // not first order by far
                if (op == TapeOp::sqrt) o = {std::fabs(o.from), std::fabs(o.to)};
            }
            if (op == TapeOp::abs && random.one_in(2)) x[0].from = -x[0].from / 3;
            const measure::attribution::ErrorFactors by =
                measure::attribution::error_factors_of(TapeNode{.op = op}, x, no_node);
            BasicReal<400> through(0);
            for (std::size_t k = 0; k < 3; ++k) {
                if (by[k]) through += BasicReal<400>(*by[k]) * (BasicReal<400>(x[k].to) - BasicReal<400>(x[k].from));
            }
            const BasicReal<400> want =
                evaluated(op, x[0].to, x[1].to, x[2].to) - evaluated(op, x[0].from, x[1].from, x[2].from);
            INFO(name_of(op));
            REQUIRE(abs(through - want) <= BasicReal<400>(0x1p-44));
        }
}

TEST_CASE("cancelled bits agree with those worked out by hand", "[attribution]") {
    const auto cancelled = [](TapeOp op, double a, double b, double c = 0) {
        Tape tape;
        const NodeId x = tape.add_input(binary32, a), y = tape.add_input(binary32, b), z = tape.add_input(binary32, c);
        return measure::attribution::cancellation(
            tape, tape.add(op, binary32, measure::attribution::result_of(op, {a, b, c}, binary32),
                           {x, y, op == TapeOp::fma ? z : no_node}));
    };
    CHECK(cancelled(TapeOp::sub, 1.5, 1.25) == 2);  // 2^0 and 2^0 leave 2^-2
    CHECK(cancelled(TapeOp::add, 8, -7.5) == 4);    // 2^3 and 2^2 leave 2^-1
    CHECK(cancelled(TapeOp::add, 8, 7.5) == 0);
    CHECK(cancelled(TapeOp::sub, 3, 3) == 24);  // all of them
    CHECK(cancelled(TapeOp::sub, 0, 0) == 0);
    CHECK(cancelled(TapeOp::mul, 3, 3) == 0);
    CHECK(cancelled(TapeOp::fma, 3, 3, -8.5) == 4);  // 2^3 leaves 2^-1
    CHECK(cancelled(TapeOp::sub, HUGE_VAL, 1) == 0);
}

}  // namespace lostbits::test::test_operation_error
