// Three-valued logic for enclosures: a comparison of overlapping enclosures has no answer yet.
#pragma once

#include "number/concept.hpp"

namespace lostbits {

/// Kleene's strong logic. `unknown` means that the enclosures overlap; it is never a default.
class Tri : public NotABool {
public:
    enum Value : signed char { no = -1, unknown = 0, yes = 1 };

    constexpr Tri(Value value) : value_(value) {}
    constexpr explicit Tri(bool is_true) : value_(is_true ? yes : no) {}

    [[nodiscard]] constexpr bool is_yes() const { return value_ == yes; }
    [[nodiscard]] constexpr bool is_no() const { return value_ == no; }
    [[nodiscard]] constexpr bool is_unknown() const { return value_ == unknown; }

    friend constexpr Tri operator&&(Tri a, Tri b) { return a.value_ < b.value_ ? a : b; }
    friend constexpr Tri operator||(Tri a, Tri b) { return a.value_ > b.value_ ? a : b; }
    friend constexpr Tri operator!(Tri a) { return Tri(static_cast<Value>(-a.value_)); }
    friend constexpr bool operator==(Tri a, Tri b) { return a.value_ == b.value_; }
    friend constexpr bool any_of(Tri a) { return !a.is_no(); }

private:
    Value value_;
};

/// A three-valued decision in each lane of a pack: the lanes that are certainly true, and those that are certainly
/// false. M is the mask of the pack.
template <class M>
class TriMask : public NotABool {
public:
    TriMask() = default;
    TriMask(const M& yes, const M& no) : yes_(yes), no_(no) {}

    [[nodiscard]] const M& yes() const { return yes_; }
    [[nodiscard]] const M& no() const { return no_; }
    /// Converts the answer of a single lane.
    operator Tri() const requires std::same_as<M, bool> { return yes_ ? Tri::yes : no_ ? Tri::no : Tri::unknown; }
    [[nodiscard]] bool is_yes() const requires std::same_as<M, bool> { return yes_; }
    [[nodiscard]] bool is_no() const requires std::same_as<M, bool> { return no_; }
    [[nodiscard]] bool is_unknown() const requires std::same_as<M, bool> { return !yes_ && !no_; }

    friend TriMask operator&&(const TriMask& a, const TriMask& b) { return {a.yes_ && b.yes_, a.no_ || b.no_}; }
    friend TriMask operator||(const TriMask& a, const TriMask& b) { return {a.yes_ || b.yes_, a.no_ && b.no_}; }
    friend TriMask operator!(const TriMask& a) { return {a.no_, a.yes_}; }
    friend bool any_of(const TriMask& a) { return any_of(!a.no_); }
    friend TriMask select(const M& mask, const TriMask& a, const TriMask& b) {
        return {(mask && a.yes_) || (!mask && b.yes_), (mask && a.no_) || (!mask && b.no_)};
    }

private:
    M yes_, no_;
};

/// Two decisions about the same two numbers: the first is less than the second, and it is at most the second.
template <class Mask>
struct Order {
    Mask less, at_most;
};

/// Evaluates f for a decision, or for both of its sides if it is undecided. `select` joins the results.
template <class F>
auto decide(Tri mask, const F& f) {
    return mask.is_unknown() ? select(mask, f(Tri(Tri::yes)), f(Tri(Tri::no))) : f(mask);
}

/// Says whether an operation of the exact formula can have been undefined (0/0, the root of a negative number). An
/// undefined value behaves as IEEE's NaN: every result computed from it is undefined, and every comparison with it is
/// false.
enum class Undefined : unsigned char { never, maybe, always };

/// The result of an operation is as undefined as its least defined operand.
constexpr Undefined combine_undefined(Undefined a, Undefined b) { return a > b ? a : b; }

/// The decision of a comparison whose operands may be undefined, from the verdict of interval arithmetic.
constexpr Tri guard_undefined(Tri verdict, Undefined u) {
    if (u == Undefined::always) return Tri::no;
    if (u == Undefined::maybe && verdict.is_yes()) return Tri::unknown;
    return verdict;
}

}  // namespace lostbits
