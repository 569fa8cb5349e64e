// From a number to the wider ones: float, double, double-double.
#pragma once

#include "number/wide/two_words.hpp"

namespace lostbits::number::wide {

/// The widest number of one word: double for float and for formats that a double holds, T itself where nothing is
/// wider.
template <class T>
using OneWord = typename Wider<T>::type;

/// Whether `OneWord` is wider than T.
template <class T>
inline constexpr bool has_wider_word = !std::same_as<OneWord<T>, T>;

/// Packs. Their rare, long functions are flattened, or every pack in them goes through memory; of others that would
/// take the compiler minutes.
template <class T>
concept InRegisters = requires {
    T::lanes;
};

/// x in W: `OneWord<T>`, or two of them. Exact.
template <class W, class T>
W taken_to(const T& x) {
    if constexpr (std::same_as<W, OneWord<T>>) return Wider<T>::widen(x);
    else return W(Wider<T>::widen(x));
}

/// x in T: rounded once from `OneWord<T>`, and once more from two of them.
template <class T, class W>
T taken_back(const W& x) {
    if constexpr (std::same_as<W, OneWord<T>>) return Wider<T>::narrow(x);
    else return Wider<T>::narrow(x.hi);
}

}  // namespace lostbits::number::wide
