// The Archetype refuses what a formula must not do. Each refusal is paired with the legal way to write it, so that a
// type which refuses everything would fail too.
#include <cmath>

#include "catch.hpp"
#include "number/archetype.hpp"

namespace lostbits::test {
namespace {

template <class T>
concept HasDoubleLiteral = requires {
    T(0.5);
};
template <class T>
concept HasFloatLiteral = requires {
    T(0.5f);
};
template <class T>
concept HasIntLiteral = requires {
    T(2);
};
template <class T>
concept ScalesByLiteral = requires(T x) {
    0.5 * x;
}
|| requires(T x) { x * 0.5; }
|| requires(T x) { x * 2; }
|| requires(T x) { 2.0f * x; };
template <class T>
concept ConvertsFromNumbers = std::convertible_to<int, T> || std::convertible_to<double, T>;
template <class T>
concept BranchesOnMask = requires(T a, T b) {
    (a < b) ? 1 : 0;
}
|| std::constructible_from<bool, mask_t<T>>;
template <class T>
concept CallsLibm = requires(T x) {
    std::sqrt(x);
}
|| requires(T x) { std::fabs(x); }
|| requires(T x) { std::abs(x); }
|| requires(T x) { std::fma(x, x, x); }
|| requires(T x) { std::copysign(x, x); }
|| requires(T x) { std::sin(x); };
template <class T>
concept BeyondTheList = requires(T x) {
    sin(x);
}
|| requires(T x) { exp(x); }
|| requires(T x) { pow(x, x); }
|| requires(T x) { floor(x); };
template <class T>
concept ComparesForEquality = requires(T a, T b) {
    a == b;
}
|| requires(T a, T b) { a != b; };
template <class T>
concept ComparesWithLiteral = requires(T x) {
    x < 0;
}
|| requires(T x) { x < 0.0; };
template <class T>
concept IsLikeABuiltin =
    std::is_default_constructible_v<T> || std::convertible_to<T, double> || std::constructible_from<double, T>;
template <class T>
concept CountsOrRemainders = requires(T x) {
    ++x;
}
|| requires(T x) { x++; }
|| requires(T a, T b) { a % b; }
|| requires(T a, T b) { a /= b; };
template <class M>
concept MaskIsMade = std::is_default_constructible_v<M> || std::constructible_from<M, bool> || requires(M a, M b) {
    a == b;
};
template <class M>
concept MaskCombines = requires(M a, M b) {
    (a && b) || !a;
};

}  // namespace

// double is the control: each forbidden operation must exist for some type.
static_assert(HasDoubleLiteral<double> && !HasDoubleLiteral<Archetype>);
static_assert(HasFloatLiteral<double> && !HasFloatLiteral<Archetype>);
static_assert(HasIntLiteral<double> && HasIntLiteral<Archetype>);
static_assert(ScalesByLiteral<double> && !ScalesByLiteral<Archetype>);
static_assert(ConvertsFromNumbers<double> && !ConvertsFromNumbers<Archetype>);
static_assert(BranchesOnMask<double> && !BranchesOnMask<Archetype>);
static_assert(CallsLibm<double> && !CallsLibm<Archetype>);
static_assert(BeyondTheList<double> && !BeyondTheList<Archetype>);
static_assert(ComparesForEquality<double> && !ComparesForEquality<Archetype>);
static_assert(ComparesWithLiteral<double> && !ComparesWithLiteral<Archetype>);
static_assert(IsLikeABuiltin<double> && !IsLikeABuiltin<Archetype>);
static_assert(CountsOrRemainders<double> && !CountsOrRemainders<Archetype>);
static_assert(MaskIsMade<bool> && !MaskIsMade<Archetype::Mask>);
static_assert(MaskCombines<bool> && MaskCombines<Archetype::Mask>);
static_assert(Number<Archetype> && Mask<Archetype::Mask>);
static_assert(!Number<int> && !Number<bool>);

}  // namespace lostbits::test
