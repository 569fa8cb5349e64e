// Check of an answer: quick if bounds decide, and exact otherwise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "exact/primitives.hpp"

namespace lostbits::exact {

/// Answer to a problem: a miss, or a t within `bound` of high + low, all three times 2^exponent. `as_float` and
/// `as_double` are t in binary32 and binary64, or NaN if it was not rounded.
struct Answer {
    bool hit = false;
    double high = 0, low = 0, bound = 0;
    std::int64_t exponent = 0;
    double as_float = 0, as_double = 0;
};

enum class Fault : std::uint8_t { none, decision, length, tightness, rounded_to_float, rounded_to_double };
const char* words_of(Fault fault);

/// Findings about some answers. The quick check accepts a t whose error is at most 2^-80 of t, or at most the bound of
/// the answer if that is wider.
struct Findings {
    std::size_t ray_count = 0, hits = 0;
    std::size_t exact_count = 0;  ///< answers that were decided without an error
    std::size_t wrong_count = 0;
    std::size_t first_wrong = 0;  ///< index of the first wrong answer
    Fault fault = Fault::none;    ///< what is wrong with it
};

/// `each_exactly`: one answer in so many is checked without an error, even if the quick check decides. `tightness`:
/// largest allowed error of each t, as a share of t.
Findings check(const ShapeTest& shape, std::span<const Problem> problems, std::span<const Answer> answers,
               double tightness, std::size_t each_exactly);

/// Problem and answer in hexadecimal numbers.
std::string paste(const ShapeTest& shape, const Problem& problem, const Answer& answer);

}  // namespace lostbits::exact
