// Conversions from a number to the wider ones: float, double, double-double.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string_view>

#include "number/format.hpp"
#include "number/wide/two_words.hpp"

namespace lostbits::number::wide {

/// The widest number of one word: double for float and for formats that a double holds; T itself if no wider type
/// exists.
template <class T>
using OneWord = typename Wider<T>::type;

/// True if `OneWord` is wider than T.
template <class T>
inline constexpr bool has_wider_word = !std::same_as<OneWord<T>, T>;

/// True if the format of T is narrower than `OneWord`. If T's format is chosen at run time, the current format counts.
template <class T>
bool widens() {
    if constexpr (traces_operations<T> && has_wider_word<T>) return !(T::format() == binary64);
    else return has_wider_word<T>;
}

/// True for packs. Their rare, long functions are flattened, because otherwise every pack in them goes through memory.
/// For other numbers flattening would take the compiler minutes.
template <class T>
concept InRegisters = requires {
    T::lanes;
};

/// Converts x exactly to W, which is `OneWord<T>` or two words of that type.
template <class W, class T>
W widen(const T& x) {
    if constexpr (std::same_as<W, OneWord<T>>) return Wider<T>::widen(x);
    else return W(Wider<T>::widen(x));
}

/// Converts x to T: rounded once if x is a `OneWord<T>`; if x has two words, its first word is rounded.
template <class T, class W>
T narrow(const W& x) {
    if constexpr (std::same_as<W, OneWord<T>>) return Wider<T>::narrow(x);
    else return Wider<T>::narrow(x.hi);
}

/// Returns the plain value of a number that records operations. A filter decides with plain values, so that its own
/// comparisons are not recorded.
template <class T>
auto plain_value(const T& x) {
    if constexpr (traces_operations<T>) return x.value();
    else return x;
}
template <class T>
auto plain_value(const Vec<T>& x) {
    return Vec<decltype(plain_value(x.x))>(plain_value(x.x), plain_value(x.y), plain_value(x.z));
}

/// Converts a decision about numbers without a record to one of T: proved, and a constant on a tape.
template <class T, class Mask>
mask_t<T> constant_mask(const Mask& mask) {
    if constexpr (traces_operations<T>) return T(mask ? 1 : 0) > T(0);
    else return mask;
}

/// Name of each result of an exact step, for numbers that record operations.
inline constexpr std::string_view name_of(CallAnswer answer) {
    constexpr std::array<std::string_view, 4> names{"exact_decision", "exact_t", "exact_near", "exact_far"};
    return names[static_cast<std::size_t>(answer)];
}

/// Records a step that was computed without T's own operations; `value` is its result.
template <class T, std::size_t n>
T record_call(const Call& callee, const std::array<T, n>& arguments,
              const decltype(plain_value(std::declval<T>()))& value) {
    return named(name_of(callee.answer), call_result(callee, std::span<const T>(arguments), value));
}

/// Smallest normal number of T. The error of a product below it is up to u times this number, however small the product
/// is.
template <class T>
T smallest_normal() {
    if constexpr (std::floating_point<T>) return std::numeric_limits<T>::min();
    else if constexpr (InRegisters<T> && has_wider_word<T>) return T(std::numeric_limits<float>::min());
    else if constexpr (InRegisters<T>) return T(std::numeric_limits<double>::min());
    else return next_up(T(0)) * (T(1) / (T(2) * unit_roundoff<T>()));
}

/// Square root of the smallest normal number; in float and double a power of two.
template <class T>
T root_of_smallest_normal() {
    if constexpr (std::same_as<T, float> || (InRegisters<T> && has_wider_word<T>)) return T(0x1p-63F);
    else if constexpr (std::same_as<T, double> || InRegisters<T>) return T(0x1p-511);
    else return sqrt(smallest_normal<T>());
}

/// True if numbers of T are computed in doubles whose products may overflow or underflow, so that `apply_to_lanes` is
/// needed. Products of four floats do neither in double.
template <class T>
inline constexpr bool products_may_overflow =
    !std::same_as<T, float> && (std::same_as<OneWord<T>, double> || (InRegisters<T> && !has_wider_word<T>));

/// True if the smallest normal number of the wider word is below that of T. Some formats with fewer bits than double
/// have the same smallest normal number.
template <class T>
mask_t<T> has_smaller_normals() {
    if constexpr (std::same_as<OneWord<T>, double> && has_wider_word<T>)
        return widen<double>(smallest_normal<T>()) > std::numeric_limits<double>::min();
    else return widens<T>() ? T(0) < T(1) : T(1) < T(0);
}

/// Calls `f(in, out)` for each lane with `request` > 0. `in` holds the lane's numbers as doubles. `out` holds the lane
/// of the argument `out` before the call, and the lane of the result after it.
template <class T, std::size_t input_count, std::size_t output_count, class F>
std::array<T, output_count> apply_to_lanes(const T& request, const std::array<T, input_count>& in,
                                           std::array<T, output_count> out, const F& f) {
    if constexpr (InRegisters<T>) {
        double requests[T::lanes], input_lanes[input_count][T::lanes], output_lanes[output_count][T::lanes];
        request.store(requests);
        for (std::size_t k = 0; k < input_count; ++k) in[k].store(input_lanes[k]);
        for (std::size_t k = 0; k < output_count; ++k) out[k].store(output_lanes[k]);

        for (std::size_t lane = 0; lane < T::lanes; ++lane) {
            if (!(requests[lane] > 0)) continue;
            std::array<double, input_count> lane_inputs;
            std::array<double, output_count> lane_results;
            for (std::size_t k = 0; k < input_count; ++k) lane_inputs[k] = input_lanes[k][lane];
            for (std::size_t k = 0; k < output_count; ++k) lane_results[k] = output_lanes[k][lane];

            f(lane_inputs, lane_results);
            for (std::size_t k = 0; k < output_count; ++k) output_lanes[k][lane] = lane_results[k];
        }

        for (std::size_t k = 0; k < output_count; ++k) out[k] = T::load(output_lanes[k]);
    } else if (request > T(0)) {
        std::array<double, input_count> lane_inputs;
        std::array<double, output_count> lane_results;
        for (std::size_t k = 0; k < input_count; ++k) lane_inputs[k] = widen<double>(in[k]);
        for (std::size_t k = 0; k < output_count; ++k) lane_results[k] = widen<double>(out[k]);
        f(lane_inputs, lane_results);
        for (std::size_t k = 0; k < output_count; ++k) out[k] = narrow<T>(lane_results[k]);
    }
    return out;
}

}  // namespace lostbits::number::wide
