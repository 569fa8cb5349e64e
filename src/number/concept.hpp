// What a formula may use, and nothing else. Everything downstream instantiates formulas over a type
// that models `Number`; adding a question to the laboratory means adding such a type.
#pragma once

#if defined(__FAST_MATH__)
#error "lostbits measures IEEE 754 arithmetic: -ffast-math (and -Ofast) void every number it prints"
#endif

#include <cmath>
#include <concepts>
#include <cstdint>
#include <string_view>

namespace lostbits {

/// The base of masks: of the three-valued decisions of enclosures, of decisions on a tape, of those of a pack's lanes.
/// An `if`, `?:`, `while`, or `&&` with a bool asks for one answer where there may be none yet, or several: it is told
/// so in one sentence. (The mask of the archetype is no such base: there the question itself must not exist.)
struct NotABool {
    template <std::same_as<bool> Asked>
    explicit operator Asked() const {
        static_assert(!std::same_as<Asked, bool>,
                      "this comparison may have no single answer (an interval, a pack of rays), so it cannot be asked "
                      "by if or ?: - write select(mask, a, b), compute both ways and join masks by && || !");
        return false;
    }
};

/// The type of `a < b`: `bool` for scalars, `Tri` for enclosures, a lane mask for SIMD packs.
template <class T>
using mask_t = decltype(std::declval<const T&>() < std::declval<const T&>());

// --- float and double: the machine's own operations, correctly rounded by IEEE 754 --------------------

// Templates, so that a formula in a program that also sees the C library's functions of these names calls those, which
// are the same, and not two that fit equally well.
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

// --- what every number gets from its comparison --------------------------------------------------------

/// True for numbers that stand for exact arithmetic: they have no neighbours, rounding outward is identity.
template <class T>
inline constexpr bool stands_for_exact = false;

/// True for numbers that say something of each operation: its place on a tape, a bound on its rounding. Of sums that
/// leave nothing out they are told as a whole: of a `Call`.
template <class T>
inline constexpr bool tells_of_operations = false;

/// What of an answer a call gives: the decision as 1 or −1, t (−1 of a miss), or the line parameter of one of the two
/// intersections.
enum class CallAnswer : std::uint8_t { decision, t, near, far };

/// The form of this name without rounding, its answer rounded to the format: good to 16u of itself, and a decision
/// right. Its arguments are the numbers of a ray, those of a solid in the order of its keys, and, of the shapes that
/// are told, where the ray ends.
struct Call {
    std::string_view form;
    CallAnswer answer;
};

template <class T>
requires stands_for_exact<T> T next_up(const T& x) { return x; }

template <class T>
requires stands_for_exact<T> T next_down(const T& x) { return x; }

/// `mask ? a : b`, for numbers whose comparisons are decided.
template <class T>
requires std::same_as < mask_t<T>,
bool > T select(bool mask, const T& a, const T& b) { return mask ? a : b; }

inline bool any_of(bool mask) { return mask; }

/// `a < b ? a : b`: the SSE rule, so a NaN in either operand yields b. Part of what is measured.
template <class T>
T min(const T& a, const T& b) {
    return select(a < b, a, b);
}

/// `a > b ? a : b`: the SSE rule, so a NaN in either operand yields b.
template <class T>
T max(const T& a, const T& b) {
    return select(a > b, a, b);
}

/// x². A product of two numbers that happen to be equal is a product; this says that it is a square, which enclosures
/// know to be no less than zero.
template <class T>
T square(const T& x) {
    return x * x;
}

/// x² + c, rounded once.
template <class T>
T fma_square(const T& x, const T& c) {
    return fma(x, x, c);
}

/// `f(mask)`: what a formula does with a decision. Enclosures overload it: where the decision is open they follow both
/// sides to the end and join the results, which is tighter than joining at once.
template <class M, class F>
auto decide(const M& mask, const F& f) {
    return f(mask);
}

/// Names an intermediate of a formula in the source's own letters. Numbers that keep a tape overload it; for all
/// others it is the identity and costs nothing.
template <class T>
constexpr const T& named(std::string_view, const T& value) {
    return value;
}

/// For the life of a `Part`, operations of numbers that keep a tape get its name instead of those in the text: a
/// stretch of many operations whose single names say nothing. Nothing for all others.
template <class T>
struct Part {
    explicit Part(std::string_view /*name*/) {}
};

/// The arithmetic that "compute it in double inside" means for T; T itself where nothing is wider.
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

/// The operations of a formula. All are correctly rounded in IEEE arithmetic, which is what makes float and
/// double results the same bits on every machine. `T(int)` is exact for the small integers that formulas use.
/// `next_up`/`next_down` are the neighbours in T (needed by forms that round outward by hand).
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

/// u, the largest relative error of one rounding to nearest: half the distance from 1 to the number above it (2^-24 for
/// float, 2^-53 for double, 2^-p of a format of p bits). Zero for numbers that stand for exact arithmetic.
template <Number T>
T unit_roundoff() {
    return (next_up(T(1)) - T(1)) / T(2);
}

}  // namespace lostbits
