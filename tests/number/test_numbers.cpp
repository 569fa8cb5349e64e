// One test for every number type: a new type is one line in kinds.hpp and, if no similar type exists, one `Kind` in
// kind.hpp.
#include <cmath>
#include <string_view>

#include "catch.hpp"
#include "number/kind.hpp"
#include "number/kind_bounded.hpp"
#include "number/wide/wide_pack.hpp"

namespace lostbits::test {
namespace {

void check_bool(bool holds, const char* expression, int line) {
    if (!holds) UNSCOPED_INFO("test_numbers.cpp:" << line << ": " << expression);
    CHECK(holds);
}

// CHECK for templates. Catch's own would be compiled again for each number type, for 9 s of processor time.
#define CHECK_BOOL(...) check_bool(__VA_ARGS__, #__VA_ARGS__, __LINE__)

/// A number in a format, and the neighbours of it and of its negative.
struct Neighbours {
    double x, up, down, up_of_negative, down_of_up;
};

/// The law that these neighbours break, or nothing.
std::string_view broken_law(const Neighbours& n, const FloatFormat& format) {
    if (std::isnan(n.x)) return std::isnan(n.up) && std::isnan(n.down) ? "" : "a NaN has no neighbour that is a number";
    if (!same_number(n.down, -n.up_of_negative)) return "down of x is minus up of -x";
    if (n.x == HUGE_VAL) return n.up == n.x ? "" : "infinity has no neighbour above";
    if (!(n.up > n.x)) return "the neighbour above is greater";
    if (!same_number(nearest(Mpfr(n.up, 53), format), n.up)) return "the neighbour is a number of the format";
    if (std::isinf(n.up) || std::isinf(n.x)) return "";
    if (n.down_of_up != n.x) return "down of up of x is x";
    // IEEE 754 nextUp of the largest negative number is −0.
    if (n.up == 0 && !std::signbit(n.up)) return "a zero above has the sign of x";
    // There is no number between them: the middle rounds to one of the two.
    Mpfr middle(n.x, 60);
    mpfr_add_d(middle, middle, n.up, MPFR_RNDN);
    mpfr_div_ui(middle, middle, 2, MPFR_RNDN);
    const double rounded = nearest(middle, format);
    return rounded == n.x || rounded == n.up ? "" : "no number lies between the two";
}

template <class T>
bool one_if(const T& x) {  // +1 rather than −1: the sign bit, seen through copysign
    return Kind<T>::is(copysign(T(1), x), 1);
}

/// For tests on a few values: any one setting.
template <class T>
struct OneSetting {
    Random random{1};
    typename Kind<T>::Setting setting{random};
};

}  // namespace

TEMPLATE_LIST_TEST_CASE("every number type obeys the laws of arithmetic on values that every format holds", "[number]",
                        RunnableNumbers) {
    using T = TestType;
    const OneSetting<T> setting;
    const auto is = [](const T& x, int v) { return Kind<T>::is(x, v); };
    const T zero(0), one(1), two(2), three(3), four(4), six(6);

    CHECK_BOOL(is(two + two, 4));
    CHECK_BOOL(is(three - one, 2));
    CHECK_BOOL(is(one - three, -2));
    CHECK_BOOL(is(two * three, 6));
    CHECK_BOOL(is(six / two, 3));
    CHECK_BOOL(is(-three, -3));
    CHECK_BOOL(is(sqrt(four), 2));
    CHECK_BOOL(is(sqrt(zero), 0));
    CHECK_BOOL(is(square(two), 4));
    CHECK_BOOL(is(fma_square(two, -three), 1));
    CHECK_BOOL(is(fma(two, three, -four), 2));
    CHECK_BOOL(is(abs(-three), 3));
    CHECK_BOOL(is(abs(three), 3));
    CHECK_BOOL(is(copysign(three, -two), -3));
    CHECK_BOOL(is(copysign(-three, two), 3));
    CHECK_BOOL(is(four - four, 0));
    CHECK_BOOL(is(named("x", six), 6));

    T sum = one;
    sum += three;
    CHECK_BOOL(is(sum, 4));
    sum -= one;
    CHECK_BOOL(is(sum, 3));
    sum *= two;
    CHECK_BOOL(is(sum, 6));

    CHECK_BOOL(is(min(one, two), 1));
    CHECK_BOOL(is(min(two, one), 1));
    CHECK_BOOL(is(max(one, two), 2));
    CHECK_BOOL(is(max(two, one), 2));
    CHECK_BOOL(is(select(one < two, three, four), 3));
    CHECK_BOOL(is(select(two < one, three, four), 4));
    CHECK_BOOL(is(Wider<T>::narrow(Wider<T>::widen(three)), 3));
}

TEMPLATE_LIST_TEST_CASE("comparisons and masks of every number type agree", "[number]", RunnableNumbers) {
    using T = TestType;
    const OneSetting<T> setting;
    const T one(1), two(2), also_two(2);

    CHECK_BOOL(surely(one < two));
    CHECK_BOOL(surely_not(two < one));
    CHECK_BOOL(surely_not(two < also_two));
    CHECK_BOOL(surely(one <= two));
    CHECK_BOOL(surely(two <= also_two));
    CHECK_BOOL(surely_not(two <= one));
    CHECK_BOOL(surely(two > one));
    CHECK_BOOL(surely_not(one > two));
    CHECK_BOOL(surely_not(two > also_two));
    CHECK_BOOL(surely(two >= one));
    CHECK_BOOL(surely(two >= also_two));
    CHECK_BOOL(surely_not(one >= two));

    const mask_t<T> yes = one < two, no = two < one;
    CHECK_BOOL(surely(yes && yes));
    CHECK_BOOL(surely_not(yes && no));
    CHECK_BOOL(surely_not(no && yes));
    CHECK_BOOL(surely_not(no && no));
    CHECK_BOOL(surely(yes || yes));
    CHECK_BOOL(surely(yes || no));
    CHECK_BOOL(surely(no || yes));
    CHECK_BOOL(surely_not(no || no));
    CHECK_BOOL(surely(!no));
    CHECK_BOOL(surely_not(!yes));
    CHECK_BOOL(any_of(yes));
    CHECK_BOOL(!any_of(no));
}

TEMPLATE_LIST_TEST_CASE("an undefined value stays undefined and decides no comparison", "[number]", RunnableNumbers) {
    using T = TestType;
    const OneSetting<T> setting;
    const T one(1), zero(0), bad = sqrt(T(-1));
    const auto undefined = [](const T& x) { return Kind<T>::is_undefined(x); };

    CHECK_BOOL(undefined(bad));
    CHECK_BOOL(undefined(zero / zero));
    CHECK_BOOL(undefined(one / zero - one / zero));
    for (const T& x : {bad + one, one - bad, bad * zero, one / bad, sqrt(bad), fma(bad, one, one), -bad, abs(bad),
                       copysign(bad, one)})
        CHECK_BOOL(undefined(x));
    for (const T& x : {bad, zero / zero, bad * zero}) {
        CHECK_BOOL(!surely(x < one));
        CHECK_BOOL(!surely(x <= one));
        CHECK_BOOL(!surely(x > one));
        CHECK_BOOL(!surely(x >= one));
        CHECK_BOOL(!surely(one < x));
        CHECK_BOOL(!surely(one >= x));
        CHECK_BOOL(!surely(x <= x));
    }
    // The sign of an undefined number is unknown, so no decision that depends on it may be certain.
    if constexpr (std::same_as<mask_t<T>, Tri>) {
        CHECK_BOOL(!surely(copysign(one, bad) > zero));
        CHECK_BOOL(!surely(copysign(one, bad) < zero));
        CHECK_BOOL(!surely(one / zero > zero));
    }

    // min and max are a < b ? a : b and a > b ? a : b, so the second operand wins beside NaN.
    CHECK_BOOL(Kind<T>::is(min(bad, one), 1));
    CHECK_BOOL(Kind<T>::is(max(bad, one), 1));
    CHECK_BOOL(undefined(min(one, bad)));
    CHECK_BOOL(undefined(max(one, bad)));
    if constexpr (Kind<T>::keeps_zero_signs) {
        CHECK_BOOL(one_if(min(-zero, zero)));
        CHECK_BOOL(!one_if(min(zero, -zero)));
        CHECK_BOOL(one_if(max(-zero, zero)));
        CHECK_BOOL(!one_if(max(zero, -zero)));
        CHECK_BOOL(!one_if(-zero));
        CHECK_BOOL(!one_if(sqrt(-zero)));
        CHECK_BOOL(one_if(zero + -zero));
    }
}

TEMPLATE_LIST_TEST_CASE("every number type finds the neighbours of a value", "[number]", RunnableNumbers) {
    using T = TestType;
    if constexpr (is_exact<T>) {
        CHECK(Kind<T>::is(next_up(T(3)), 3));
        CHECK(Kind<T>::is(next_down(T(3)), 3));
    } else {
        Random random(7);
        int broken = 0;
        for (int i = 0; i < 20000 && broken < 3; ++i) {
            const typename Kind<T>::Setting setting(random);
            const FloatFormat f = Kind<T>::format();
            const double x = random.one_in(20) ? draw_special(random, f) : draw_finite(random, f);
            const auto up_of = [](double y) { return Kind<T>::value(next_up(T(y))); };
            const double up = up_of(x), down = Kind<T>::value(next_down(T(x)));
            const std::string_view law = broken_law({x, up, down, up_of(-x), Kind<T>::value(next_down(T(up)))}, f);
            if (law.empty()) continue;
            ++broken;
            UNSCOPED_INFO(Kind<T>::text(T(x)) << " has neighbours " << Mpfr(down, 53).text() << " and "
                                              << Mpfr(up, 53).text() << "; broken: " << law);
        }
        CHECK(broken == 0);
    }
}

TEMPLATE_LIST_TEST_CASE("every operation keeps the promise of its number type", "[number][promise]", RunnableNumbers) {
    using T = TestType;
    Random random(20190305);
    for (const Op op : every_op) {
        int broken = 0;
        for (int i = 0; i < Kind<T>::rounds && broken < 3; ++i) {
            const typename Kind<T>::Setting setting(random);
            const auto x = Kind<T>::draw(random, op);
            const T result = apply(op, x[0].value, x[1].value, x[2].value);
            if (Kind<T>::keeps_promise(op, result, x)) continue;
            ++broken;
            UNSCOPED_INFO(op_names[static_cast<int>(op)]
                          << "\n a = " << Kind<T>::text(x[0].value) << " at " << x[0].point.text()
                          << "\n b = " << Kind<T>::text(x[1].value) << " at " << x[1].point.text()
                          << "\n c = " << Kind<T>::text(x[2].value) << " at " << x[2].point.text() << "\n gives "
                          << Kind<T>::text(result));
        }
        CHECK(broken == 0);
    }
}

TEMPLATE_LIST_TEST_CASE("comparisons agree with the exact values", "[number][promise]", RunnableNumbers) {
    using T = TestType;
    Random random(42);
    int wrong = 0, decided = 0;
    for (int i = 0; i < Kind<T>::rounds; ++i) {
        const typename Kind<T>::Setting setting(random);
        const auto x = Kind<T>::draw(random, Op::subtract);
        const T& a = x[0].value;
        const T& b = x[1].value;
        const auto check = [&](const mask_t<T>& mask, bool truth) {
            wrong += (surely(mask) && !truth) || (surely_not(mask) && truth);
            decided += surely(mask) || surely_not(mask);
        };
        check(a < b, mpfr_less_p(x[0].point, x[1].point) != 0);
        check(a <= b, mpfr_lessequal_p(x[0].point, x[1].point) != 0);
        check(a > b, mpfr_greater_p(x[0].point, x[1].point) != 0);
        check(a >= b, mpfr_greaterequal_p(x[0].point, x[1].point) != 0);
    }
    CHECK(wrong == 0);
    CHECK(decided > 2 * Kind<T>::rounds);  // an enclosure that never decides would be right but useless
}

}  // namespace lostbits::test
