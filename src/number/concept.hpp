// The operations that a formula may use. The rest of the program instantiates formulas over types that model
// `Number`. To measure something new, write a new type that models it.
#pragma once

#if defined(__FAST_MATH__)
#error "lostbits measures IEEE 754 arithmetic: -ffast-math (and -Ofast) void every number it prints"
#endif

#include <cmath>
#include <concepts>
#include <cstdint>
#include <string_view>

namespace lostbits {

/// Base of masks: the three-valued decisions of enclosures, decisions on a tape, and the lanes of a pack. An `if`,
/// `?:`, `while`, or `&&` with a bool needs a single decision, but a mask may be undecided or hold one decision per
/// lane. Such code does not compile, and the error says why in one sentence. (The mask of the archetype does not derive
/// from this base, because there the conversion itself must not exist.)
struct NotABool {
    template <std::same_as<bool> Bool>
    explicit operator Bool() const {
        static_assert(!std::same_as<Bool, bool>,
                      "this comparison may have no single answer (an interval, a pack of rays), so it cannot be asked "
                      "by if or ?: - write select(mask, a, b), compute both ways and join masks by && || !");
        return false;
    }
};

/// The type of `a < b`: `bool` for scalars, `Tri` for enclosures, a lane mask for SIMD packs.
template <class T>
using mask_t = decltype(std::declval<const T&>() < std::declval<const T&>());

// --- float and double: the machine's own operations, correctly rounded by IEEE 754 --------------------

// These are templates because a program may also see the C library's functions of these names. Formulas then call the C
// library's, which compute the same, and the call is not ambiguous.
template <std::floating_point F>
F sqrt(F x) {
    return std::sqrt(x);
}
template <std::floating_point F>
F fma(F x, F y, F z) {
    return std::fma(x, y, z);
}
template <std::floating_point F>
F abs(F x) {
    return std::fabs(x);
}
template <std::floating_point F>
F copysign(F x, F y) {
    return std::copysign(x, y);
}
inline float next_up(float x) { return std::nextafter(x, HUGE_VALF); }
inline double next_up(double x) { return std::nextafter(x, HUGE_VAL); }
inline float next_down(float x) { return std::nextafter(x, -HUGE_VALF); }
inline double next_down(double x) { return std::nextafter(x, -HUGE_VAL); }

// --- operations that follow from the comparison --------------------------------------------------------

/// True for numbers that stand for exact arithmetic: they have no neighbours, and rounding outward is the identity.
template <class T>
inline constexpr bool is_exact = false;

/// True for numbers that record something about each operation: its index on a tape, or a bound on its rounding error.
/// A sum that is computed without loss is recorded as a whole: as a `Call`.
template <class T>
inline constexpr bool traces_operations = false;

/// The part of a form's result that a call returns: the decision as 1 or −1, t (−1 for a miss), or the line parameter
/// of the nearer or the farther intersection.
enum class CallAnswer : std::uint8_t { decision, t, near, far };

/// A call of the form with this name, computed without rounding. The result is rounded to the format: it has a relative
/// error of at most 16u, and the right decision. The arguments are the numbers of a ray, those of a primitive in the
/// order of its keys, and, for shapes whose forms take tmax, the end of the ray.
struct Call {
    std::string_view form;
    CallAnswer answer;
};

template <class T>
requires is_exact<T> T next_up(const T& x) { return x; }

template <class T>
requires is_exact<T> T next_down(const T& x) { return x; }

/// `mask ? a : b`, for numbers whose comparisons are decided.
template <class T>
requires std::same_as < mask_t<T>,
bool > T select(bool mask, const T& a, const T& b) { return mask ? a : b; }

inline bool any_of(bool mask) { return mask; }

/// `a < b ? a : b`: the SSE rule, so a NaN in either operand yields b. The program measures the effect of
/// this choice too.
template <class T>
T min(const T& a, const T& b) {
    return select(a < b, a, b);
}

/// `a > b ? a : b`: the SSE rule, so a NaN in either operand yields b.
template <class T>
T max(const T& a, const T& b) {
    return select(a > b, a, b);
}

/// x². A product of two numbers that happen to be equal stays a product. `square` tells enclosures that the result is a
/// square, and therefore at least zero.
template <class T>
T square(const T& x) {
    return x * x;
}

/// x² + c, rounded once.
template <class T>
T fma_square(const T& x, const T& c) {
    return fma(x, x, c);
}

/// `f(mask)`: runs the part of a formula that depends on a decision. Enclosures overload it: if the mask is undecided,
/// they follow both sides to the end and join the results, which is tighter than joining at once.
template <class M, class F>
auto decide(const M& mask, const F& f) {
    return f(mask);
}

/// Labels an intermediate result of a formula with its name in the form's source. Numbers that keep a tape overload
/// this function; for all others it is the identity and costs nothing.
template <class T>
constexpr const T& named(std::string_view, const T& value) {
    return value;
}

/// While a `Part` lives, all operations of numbers that keep a tape get its name. It serves long runs of operations
/// that have no useful names of their own. It has no effect on other numbers.
template <class T>
struct Part {
    explicit Part(std::string_view /*name*/) {}
};

/// Arithmetic of the formulas that compute in double inside: wider than T, or T itself if nothing is wider.
template <class T>
struct Wider {
    using type = T;
    static type widen(const T& x) { return x; }
    static T narrow(const type& x) { return x; }
};

template <>
struct Wider<float> {
    using type = double;
    static double widen(float x) { return x; }
    static float narrow(double x) { return static_cast<float>(x); }
};

template <class M>
concept Mask = std::copyable<M> && requires(const M a, const M b) {
    { a&& b } -> std::same_as<M>;
    { a || b } -> std::same_as<M>;
    { !a } -> std::same_as<M>;
    { any_of(a) } -> std::same_as<bool>;
};

/// The operations of a formula. All are correctly rounded in IEEE arithmetic, so float and double results have the same
/// bits on every machine. `T(int)` is exact for the small integers that formulas use. `next_up` and `next_down` return
/// the neighbours in T, for forms that round outward by hand.
template <class T>
concept Number = std::copyable<T> && std::constructible_from<T, int> && Mask<mask_t<T>> &&
    requires(T x, const T a, const T b, const T c) {
    { a + b } -> std::same_as<T>;
    { a - b } -> std::same_as<T>;
    { a* b } -> std::same_as<T>;
    { a / b } -> std::same_as<T>;
    { -a } -> std::same_as<T>;
    { x += a } -> std::same_as<T&>;  // glm::vec adds and subtracts through these
    { x -= a } -> std::same_as<T&>;
    { x *= a } -> std::same_as<T&>;
    { a < b } -> std::same_as<mask_t<T>>;
    { a <= b } -> std::same_as<mask_t<T>>;
    { a > b } -> std::same_as<mask_t<T>>;
    { a >= b } -> std::same_as<mask_t<T>>;
    { sqrt(a) } -> std::same_as<T>;
    { fma(a, b, c) } -> std::same_as<T>;
    { square(a) } -> std::same_as<T>;
    { fma_square(a, c) } -> std::same_as<T>;
    { abs(a) } -> std::same_as<T>;
    { copysign(a, b) } -> std::same_as<T>;
    { next_up(a) } -> std::same_as<T>;
    { next_down(a) } -> std::same_as<T>;
    { min(a, b) } -> std::same_as<T>;
    { max(a, b) } -> std::same_as<T>;
    { select(a < b, a, b) } -> std::same_as<T>;
};

static_assert(Number<float> && Number<double>);

/// u, the largest relative error of one rounding to nearest: half the distance from 1 to the next larger number (2^-24
/// for float, 2^-53 for double, 2^-p for a format of p bits). Zero for numbers that stand for exact arithmetic.
template <Number T>
T unit_roundoff() {
    return (next_up(T(1)) - T(1)) / T(2);
}

}  // namespace lostbits
