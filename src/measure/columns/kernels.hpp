// Loops over columns. One translation unit for each register width includes this file, and sees only plain pointers
// (intersect/simd/packed_batch.hpp explains why).
#pragma once

#include <limits>

#include "measure/bits/log2.hpp"
#include "measure/columns/raw_columns.hpp"
#include "measure/columns/residual.hpp"
#include "measure/stages/problem.hpp"
#include "number/pack.hpp"

namespace lostbits::measure::columns {

/// `bits::ScalarBits` for the lanes of a pack.
template <class Width>
struct LaneBits {
    using P = Pack<double, Width>;
    typedef std::uint64_t Words [[gnu::vector_size(Width::bytes)]];

    static Words words(const P& x) { return __builtin_bit_cast(Words, x.registers()); }
    static P of_words(Words words) { return P(__builtin_bit_cast(typename P::Register, words)); }
    static bits::NearOne<P> near_one(const P& x) {
        const Words shifted = words(x) + (bits::bits_of_one - bits::bits_of_root_half);
        return {of_words((shifted >> 52) | bits::bits_of_two_52) - P(0x1p52 + 1023),
                of_words((shifted & bits::bits_of_fraction) + bits::bits_of_root_half)};
    }
    static P leading_half(const P& x) { return of_words(words(x) & ~((std::uint64_t{1} << 27) - 1)); }
};

using stages::TwoWords;

/// Numbers of one pass of a loop, from index i on: a whole pack, or the `remaining` last numbers followed by NaN.
template <class P, bool is_whole>
struct LoopPass {
    std::size_t i, remaining;

    [[nodiscard]] P load(const double* column) const {
        if constexpr (is_whole) {
            return P::load(column + i);
        } else {
            double lanes[max_lanes];
            for (std::size_t k = 0; k < P::lanes; ++k)
                lanes[k] = k < remaining ? column[i + k] : std::numeric_limits<double>::quiet_NaN();
            return P::load(lanes);
        }
    }
    void store(const P& x, double* column) const {
        if constexpr (is_whole) {
            x.store(column + i);
        } else {
            double lanes[max_lanes];
            x.store(lanes);
            for (std::size_t k = 0; k < remaining; ++k) column[i + k] = lanes[k];
        }
    }
    /// Records the lanes that a mask selects as rays for the scalar functions. Most masks select none.
    template <class Mask>
    void leave_to_scalar(const Mask& mask, RawUnhandledRays& unhandled) const {
        if (!any_of(mask)) return;
        bool is_selected[max_lanes];
        mask.store(is_selected);
        for (std::size_t k = 0; k < P::lanes; ++k) {
            if (is_selected[k]) unhandled.indices[unhandled.count++] = static_cast<std::uint32_t>(i + k);
        }
    }
};

template <class P, class Step>
[[gnu::always_inline]] inline void for_each_pack(std::size_t size, const Step& step) {
    std::size_t i = 0;
    for (; i + P::lanes <= size; i += P::lanes) step(LoopPass<P, true>{i, P::lanes});
    if (i < size) step(LoopPass<P, false>{i, size - i});
}

/// Computes the same bits as `truth::ulp_error`, `truth::lost_bits` and the metrics of the difference.
///
/// These functions work in units of 2^e, where e is the larger exponent; here every number keeps its own size. All
/// steps except the last are sums of doubles, so the results are the same unless a step overflows or goes below
/// 2^-1022.
///
/// With |t|, |hi| within [2^-400, 2^400] and lo = 0 or |lo| ≥ 2^-600, every sum is 0 or a multiple of 2^-653 below
/// 2^402. Multiplied by 2^(p − 1)/2^max(⌊log2 hi⌋, emin) ≤ 2^452, or divided by hi + lo, it stays within [2^-1054,
/// 2^854]. It does not go below 2^-1022: |difference| is at least an ulp of lo, 2^-253 of hi. Rays outside that range
/// are left to the caller.
template <class Width>
[[gnu::flatten]] void compute_errors(RawErrors& batch) {
    using P = Pack<double, Width>;
    const double *const answers = batch.in[RawErrors::answer], *const truth_hi = batch.in[RawErrors::hi];
    const double *const truth_lo = batch.in[RawErrors::lo], *const inverse_binades =
                                                                batch.in[RawErrors::inverse_binade];

    double *const ulp_out = batch.out[RawErrors::ulp], *const lost_out = batch.out[RawErrors::lost];
    double *const correct_out = batch.out[RawErrors::correct], *const relative_out = batch.out[RawErrors::relative];
    double* const absolute_out = batch.out[RawErrors::absolute];

    const std::size_t size = batch.size;
    const P low(0x1p-400), high(0x1p+400), nan(std::numeric_limits<double>::quiet_NaN());
    const P precision(batch.precision), ulps_of_binade(batch.ulps_of_binade),
        max_inverse_binade(batch.max_inverse_binade);
    P largest(batch.largest);
    RawUnhandledRays unhandled = batch.unhandled;

    for_each_pack<P>(size, [&](const auto& pass) {
        const P t = pass.load(answers), hi = pass.load(truth_hi), lo = pass.load(truth_lo);
        const auto is_measured = t >= t;
        const auto is_in_range = is_measured && abs(t) >= low && abs(t) <= high && abs(hi) >= low && abs(hi) <= high;
        pass.leave_to_scalar(is_measured && !is_in_range, unhandled);

        // The difference t − (hi + lo).
        const TwoWords<P> raw_difference = stages::sum_of<P>(t, -hi);
        const P tail = P(0) - lo;
        const TwoWords<P> sum = stages::sum_of<P>(raw_difference.hi, tail);
        const P difference = sum.hi + (sum.lo + raw_difference.lo + P(0));

        const P ulps = difference * (min(pass.load(inverse_binades), max_inverse_binade) * ulps_of_binade);
        const P magnitude = abs(ulps);
        pass.store(select(is_in_range, ulps, nan), ulp_out);
        largest = max(select(is_in_range, magnitude, P(0)), largest);

        if (lost_out || correct_out) {
            const P bits_lost = min(bits::log2_by<LaneBits<Width>>(magnitude) + P(1), precision);
            const P lost = select(magnitude > P(0.5), bits_lost, P(0));
            if (lost_out) pass.store(select(is_in_range, lost, nan), lost_out);
            if (correct_out) pass.store(select(is_in_range, precision - lost, nan), correct_out);
        }

        if (relative_out) pass.store(select(is_in_range, abs(difference / (hi + lo)), nan), relative_out);
        if (absolute_out) pass.store(select(is_in_range, abs(difference), nan), absolute_out);
    });

    batch.unhandled = unhandled;
    double lanes[max_lanes];
    largest.store(lanes);
    for (std::size_t k = 0; k < P::lanes; ++k) batch.largest = batch.largest < lanes[k] ? lanes[k] : batch.largest;
}

/// Adds sizes, with a sum in two doubles in each lane. Sizes of at most 2^900 do not overflow before 2^123 samples, and
/// each addition leaves out at most 2^-53 of the low part.
template <class Width>
[[gnu::flatten]] void add_absolute_values(RawAbsoluteSums& batch) {
    using P = Pack<double, Width>;
    constexpr std::size_t packs = max_lanes / P::lanes;
    const double* const values = batch.values;
    const std::size_t size = batch.size;

    P hi[packs], lo[packs], count(0), zeros(0), beyond(0), largest(batch.largest);
    for (std::size_t k = 0; k < packs; ++k) {
        hi[k] = P::load(batch.hi + k * P::lanes);
        lo[k] = P::load(batch.lo + k * P::lanes);
    }

    const auto add = [&](std::size_t k, const P& value) {
        const P x = abs(value);
        count += select(x >= P(0), P(1), P(0));
        zeros += select(x <= P(0), P(1), P(0));
        beyond += select(x > P(largest_summed), P(1), P(0));
        largest = max(x, largest);  // a NaN leaves it unchanged

        const TwoWords<P> sum = stages::sum_of<P>(hi[k], select(x <= P(largest_summed), x, P(0)));
        hi[k] = sum.hi;
        lo[k] += sum.lo;
    };

    // Adds whole blocks, then the rest.
    std::size_t i = 0;
    for (; i + max_lanes <= size; i += max_lanes) {
        for (std::size_t k = 0; k < packs; ++k) add(k, P::load(values + i + k * P::lanes));
    }
    for (std::size_t k = 0; i < size; ++k, i += P::lanes)
        add(k, LoopPass<P, false>{i, size - i < P::lanes ? size - i : P::lanes}.load(values));
    for (std::size_t k = 0; k < packs; ++k) {
        hi[k].store(batch.hi + k * P::lanes);
        lo[k].store(batch.lo + k * P::lanes);
    }

    // Sums the lanes.
    double lanes[4][max_lanes];
    count.store(lanes[0]);
    zeros.store(lanes[1]);
    beyond.store(lanes[2]);
    largest.store(lanes[3]);
    for (std::size_t k = 0; k < P::lanes; ++k) {
        batch.count += static_cast<std::uint64_t>(lanes[0][k]);
        batch.zeros += static_cast<std::uint64_t>(lanes[1][k]);
        batch.beyond += static_cast<std::uint64_t>(lanes[2][k]);
        batch.largest = batch.largest < lanes[3][k] ? lanes[3][k] : batch.largest;
    }
}

/// Keeps the first hit so far on each ray; the compiler vectorises the loop. A hit at NaN never replaces another hit;
/// it stays if it is the only one.
template <class F, class Width>
[[gnu::flatten]] void keep_nearest(const RawHits<F>& batch) {
    const F* __restrict const t = batch.t;
    const std::uint8_t* __restrict const hit = batch.hit;
    F* __restrict const nearest = batch.nearest;
    std::int32_t* __restrict const nearest_primitives = batch.nearest_primitives;
    const std::int32_t primitive = batch.primitive;
    const std::size_t size = batch.size;
    for (std::size_t i = 0; i < size; ++i) {
        const F x = t[i], old_nearest = nearest[i];
        const bool is_first = nearest_primitives[i] < 0;
        const bool is_nearer = x < old_nearest || old_nearest != old_nearest;
        const bool is_kept = hit[i] != 0 && (is_first || (is_nearer && x == x));
        nearest[i] = is_kept ? x : old_nearest;
        nearest_primitives[i] = is_kept ? primitive : nearest_primitives[i];
    }
}

/// Returns a coordinate of o + t·d as the format computes it. A product of two floats is exact in double. Their sum,
/// rounded to double and then to float, is the same as if rounded once, since 53 ≥ 2·24 + 2.
template <bool binary32, class P, class Width>
[[gnu::always_inline]] inline P hit_coordinate(const P& origin, const P& t, const P& direction) {
    if constexpr (binary32) {
        return stages::nearest_binary32(origin + stages::nearest_binary32(t * direction));
    } else {
        return origin + t * direction;
    }
}

template <bool binary32, class Width, class Residual>
[[gnu::always_inline]] inline void compute_residuals(RawResiduals& batch, const Residual& residual) {
    using P = Pack<double, Width>;
    const double* in[RawResiduals::columns_in];
    for (int k = 0; k < RawResiduals::columns_in; ++k) in[k] = batch.in[k];
    double* const out = batch.out;

    const P nan(std::numeric_limits<double>::quiet_NaN());
    RawUnhandledRays unhandled = batch.unhandled;
    for_each_pack<P>(
        batch.size, [&](const auto& pass) __attribute__((always_inline)) {
            const auto load = [&](int column) __attribute__((always_inline)) { return pass.load(in[column]); };
            const P t = load(RawResiduals::answer);
            const auto is_measured = t >= t;

            // The hit point, as the format computes it.
            const P p[3] = {hit_coordinate<binary32, P, Width>(load(RawResiduals::ox), t, load(RawResiduals::dx)),
                            hit_coordinate<binary32, P, Width>(load(RawResiduals::oy), t, load(RawResiduals::dy)),
                            hit_coordinate<binary32, P, Width>(load(RawResiduals::oz), t, load(RawResiduals::dz))};

            P value;
            const auto is_proved =
                is_measured &&
                residual(
                    p, [&](int k) __attribute__((always_inline)) { return load(RawResiduals::primitive + k); }, value);
            pass.leave_to_scalar(is_measured && !is_proved, unhandled);
            pass.store(select(is_proved, value, nan), out);
        });
    batch.unhandled = unhandled;
}

template <template <class> class S, bool binary32, class Width>
[[gnu::flatten]] void residuals_in(RawResiduals& batch) {
    using P = Pack<double, Width>;
    compute_residuals<binary32, Width>(
        batch, [](const P* p, const auto& primitive, P& value)
                   __attribute__((always_inline)) { return find_residual<S>(p, primitive, value); });
}

template <class Width>
void fill_residuals(RawKernels& kernels) {
    auto* residuals = kernels.residuals;
    Primitives::each([&residuals]<template <class> class S>() {
        *residuals++ = [](RawResiduals& batch) {
            if (batch.binary32) residuals_in<S, true, Width>(batch);
            else residuals_in<S, false, Width>(batch);
        };
    });
}

}  // namespace lostbits::measure::columns
