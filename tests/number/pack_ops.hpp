// Every operation of a formula as one function over any number: the scalars run it here, the packs in one object for
// each register width, and the lanes must agree.
#pragma once

#include <cstddef>

#include "number/concept.hpp"

namespace lostbits::test {

inline constexpr const char* pack_op_names[] = {
    "a + b",          "a - b",          "a * b",      "a / b",        "-a",
    "a += b",         "a -= b",         "a *= b",     "sqrt(a)",      "fma(a, b, c)",
    "abs(a)",         "copysign(a, b)", "next_up(a)", "next_down(a)", "min(a, b)",
    "max(a, b)",      "a < b",          "a <= b",     "a > b",        "a >= b",
    "a < b && b < c", "a < b || b < c", "!(a < b)",   "T(-7)",        "decide(a < b)"};
inline constexpr int pack_op_count = sizeof pack_op_names / sizeof *pack_op_names;

template <class T>
T pack_op(int op, const T& a, const T& b, const T& c) {
    T x = a;
    switch (op) {
        case 0: return a + b;
        case 1: return a - b;
        case 2: return a * b;
        case 3: return a / b;
        case 4: return -a;
        case 5: return x += b;
        case 6: return x -= b;
        case 7: return x *= b;
        case 8: return sqrt(a);
        case 9: return fma(a, b, c);
        case 10: return abs(a);
        case 11: return copysign(a, b);
        case 12: return next_up(a);
        case 13: return next_down(a);
        case 14: return min(a, b);
        case 15: return max(a, b);
        case 16: return select(a < b, a, c);
        case 17: return select(a <= b, a, c);
        case 18: return select(a > b, a, c);
        case 19: return select(a >= b, a, c);
        case 20: return select(a < b && b < c, a, c);
        case 21: return select(a < b || b < c, a, c);
        case 22: return select(!(a < b), a, c);
        case 23: return T(-7);
        default: return decide(a < b, [&](const mask_t<T>& mask) { return select(mask, b, c); });
    }
}

/// The same in the wider arithmetic, and a decision made there that chooses between the narrow numbers.
template <class T>
T wide_pack_op(int op, const T& a, const T& b, const T& c) {
    using W = typename Wider<T>::type;
    const W x = Wider<T>::widen(a), y = Wider<T>::widen(b), z = Wider<T>::widen(c);
    return Wider<T>::narrow(pack_op<W>(op, x, y, z));
}

template <class T>
T wide_decision(const T& a, const T& b, const T& c) {
    using W = typename Wider<T>::type;
    const mask_t<T> mask = Wider<T>::widen(a) * Wider<T>::widen(b) < W(1);
    return select(mask, a, c);
}

/// Request to the objects of the register widths: `size` numbers for each operand, a multiple of 16.
template <class F>
struct PackQuestion {
    int op;
    const F *a, *b, *c;
    F* narrow;   ///< pack_op
    F* wide;     ///< wide_pack_op
    F* decided;  ///< wide_decision
    bool* less;  ///< a < b, as a mask stores it
    bool* any;   ///< any_of(a < b), the same for all lanes of a pack
    bool* wide_any;
    std::size_t size;
};

void ask_w128(const PackQuestion<float>& question);
void ask_w128(const PackQuestion<double>& question);
void ask_w256(const PackQuestion<float>& question);
void ask_w256(const PackQuestion<double>& question);
void ask_w512(const PackQuestion<float>& question);
void ask_w512(const PackQuestion<double>& question);

}  // namespace lostbits::test
