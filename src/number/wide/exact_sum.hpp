// The exact sign of a sum of words, for decisions that double-double leaves open.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "number/wide/two_words.hpp"

namespace lostbits::number::wide {

/// A sum of at most `size` words.
template <class P, std::size_t size>
class ExactSum {
public:
    /// Adds a word, unless it is zero in every lane. For floats, whose products are doubles, most words are zero.
    void add(const P& word) {
        if (any_of(!(abs(word) <= P(0)))) words_[count_++] = word;
    }
    /// Adds both words. The words of a product are exact unless the product underflows.
    void add(const TwoWords<P>& words) {
        add(words.hi);
        add(words.lo);
    }
    void add_product(const P& x, const P& y) { add(product_of(x, y)); }
    [[nodiscard]] std::span<const P> words() const { return {words_.data(), count_}; }

    /// The sum, accurate to 2^-59 of itself. It is zero if and only if the exact sum is.
    ///
    /// Each pass adds neighbours without error, from the first word to the last (VecSum of Ogita, Rump and Oishi,
    /// "Accurate sum and dot product", 2005). After the pass the last word is the rounded sum and the others are the
    /// rounding errors; the sum of all words is unchanged. Each pass makes the others smaller by a factor of about
    /// size·u. The passes end if the others add up to at most 2^-60 of the last word, or to zero. They reach zero
    /// because all words are multiples of the smallest last place among them. `max_passes` are enough for 1600 bits
    /// between the largest word and the smallest.
    P value() {
        constexpr int max_passes = 40;
        if (count_ == 0) return P(0);
        P& last = words_[count_ - 1];
        for (int pass = 0; pass < max_passes; ++pass) {
            P others(0);
            for (std::size_t i = 1; i < count_; ++i) {
                const TwoWords<P> s = sum_of(words_[i], words_[i - 1]);
                words_[i] = s.hi;
                words_[i - 1] = s.lo;
                others = others + abs(s.lo);
            }
            if (!any_of(!(others <= abs(last) * power_of_two<P>(-60)))) break;
        }
        return last;
    }

private:
    template <std::size_t... i>
    static std::array<P, size> zeros(std::index_sequence<i...>) {
        return {((void)i, P(0))...};
    }

    std::array<P, size> words_ = zeros(std::make_index_sequence<size>());
    std::size_t count_ = 0;
};

}  // namespace lostbits::number::wide
