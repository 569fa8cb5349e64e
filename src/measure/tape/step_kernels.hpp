// Runs the operations of a tape over columns. One translation unit for each register width includes this file; its
// interface has only plain pointers (intersect/simd/packed_batch.hpp explains why).
#pragma once

#include <utility>

#include "measure/tape/steps.hpp"
#include "number/pack.hpp"
#include "number/wide/two_words.hpp"

namespace lostbits::measure::tape {

template <class Width>
class StepRunner {
public:
    explicit StepRunner(const StepColumns& columns) : columns_(columns) {}

    void run(const TapeStep& step) const {
        if (step.operand_arithmetic == NodeArithmetic::decision) return run_logic(step);
        if (step.op == TapeOp::convert) return convert(step);
        switch (step.operand_arithmetic) {
            case NodeArithmetic::one_float: return compute<FloatPack>(step);
            case NodeArithmetic::one_double: return compute<DoublePack>(step);
            case NodeArithmetic::float_pair: return compute<PairOf<FloatPack>>(step);
            case NodeArithmetic::double_pair: return compute<PairOf<DoublePack>>(step);
            case NodeArithmetic::decision: return;
        }
    }

private:
    using FloatPack = Pack<float, Width>;
    using DoublePack = Pack<double, Width>;
    template <class P>
    using PairOf = number::wide::TwoWords<P>;

    template <class F>
    [[nodiscard]] F* column(std::uint16_t index) const {
        if constexpr (sizeof(F) == sizeof(float)) return columns_.floats + index * rays_per_batch;
        else return columns_.doubles + index * rays_per_batch;
    }

    template <class N>
    struct Numbers;
    template <class F>
    struct Numbers<Pack<F, Width>> {
        using Lanes = PackMask<F, Width>;
        static constexpr std::size_t lanes = Pack<F, Width>::lanes;
        F* values;
        Numbers(const StepRunner& runner, std::uint16_t index) : values(runner.template column<F>(index)) {}
        [[nodiscard]] Pack<F, Width> load(std::size_t i) const { return Pack<F, Width>::load(values + i); }
        void store(std::size_t i, const Pack<F, Width>& x) const { x.store(values + i); }
    };
    template <class P>
    struct Numbers<number::wide::TwoWords<P>> {
        using Lanes = typename Numbers<P>::Lanes;
        static constexpr std::size_t lanes = Numbers<P>::lanes;
        Numbers<P> high, low;
        Numbers(const StepRunner& runner, std::uint16_t index)
            : high(runner, index), low(runner, static_cast<std::uint16_t>(index + 1)) {}
        [[nodiscard]] PairOf<P> load(std::size_t i) const { return {high.load(i), low.load(i)}; }
        void store(std::size_t i, const PairOf<P>& x) const { high.store(i, x.hi), low.store(i, x.lo); }
    };

    /// out[i] = f(a[i], …). The operands of a ray are read before its result is written, so the result may overwrite
    /// one of them.
    template <class N, std::size_t operands, class F>
    void run_operation(const TapeStep& step, const F& f) const {
        run_operation<N>(step, f, std::make_index_sequence<operands>());
    }
    template <class N, class F, std::size_t... k>
    void run_operation(const TapeStep& step, const F& f, std::index_sequence<k...>) const {
        const Numbers<N> out(*this, step.out), in[]{Numbers<N>(*this, step.operands[k])...};
        for (std::size_t i = 0; i < columns_.rays; i += Numbers<N>::lanes) out.store(i, f(in[k].load(i)...));
    }
    template <class N, class F>
    void run_comparison(const TapeStep& step, const F& f) const {
        const Numbers<N> a(*this, step.operands[0]), b(*this, step.operands[1]);
        bool* const out = decisions(step.out);
        for (std::size_t i = 0; i < columns_.rays; i += Numbers<N>::lanes) f(a.load(i), b.load(i)).store(out + i);
    }
    template <class N>
    void run_select(const TapeStep& step) const {
        const Numbers<N> a(*this, step.operands[1]), b(*this, step.operands[2]), out(*this, step.out);
        const bool* const mask = decisions(step.operands[0]);
        using Lanes = typename Numbers<N>::Lanes;
        for (std::size_t i = 0; i < columns_.rays; i += Numbers<N>::lanes) {
            out.store(i, select(Lanes::load(mask + i), a.load(i), b.load(i)));
        }
    }

    template <class N>
    void compute(const TapeStep& step) const {
        switch (step.op) {
            // Operations that round
            case TapeOp::add: return run_operation<N, 2>(step, [](const N& a, const N& b) { return a + b; });
            case TapeOp::sub: return run_operation<N, 2>(step, [](const N& a, const N& b) { return a - b; });
            case TapeOp::mul: return run_operation<N, 2>(step, [](const N& a, const N& b) { return a * b; });
            case TapeOp::div: return run_operation<N, 2>(step, [](const N& a, const N& b) { return a / b; });
            case TapeOp::sqrt: return run_operation<N, 1>(step, [](const N& a) { return sqrt(a); });
            case TapeOp::fma:
                return run_operation<N, 3>(step, [](const N& a, const N& b, const N& c) { return fma(a, b, c); });

            // Operations that do not round
            case TapeOp::neg: return run_operation<N, 1>(step, [](const N& a) { return -a; });
            case TapeOp::abs: return run_operation<N, 1>(step, [](const N& a) { return abs(a); });
            case TapeOp::copysign:
                return run_operation<N, 2>(step, [](const N& a, const N& b) { return copysign(a, b); });
            case TapeOp::min:
                return run_operation<N, 2>(step, [](const N& a, const N& b) { return select(a < b, a, b); });
            case TapeOp::max:
                return run_operation<N, 2>(step, [](const N& a, const N& b) { return select(a > b, a, b); });
            case TapeOp::select: return run_select<N>(step);
            case TapeOp::next_up: return run_operation<N, 1>(step, [](const N& a) { return next_up(a); });
            case TapeOp::next_down: return run_operation<N, 1>(step, [](const N& a) { return next_down(a); });

            // Comparisons
            case TapeOp::less: return run_comparison<N>(step, [](const N& a, const N& b) { return a < b; });
            case TapeOp::less_equal: return run_comparison<N>(step, [](const N& a, const N& b) { return a <= b; });
            case TapeOp::greater: return run_comparison<N>(step, [](const N& a, const N& b) { return a > b; });
            case TapeOp::greater_equal: return run_comparison<N>(step, [](const N& a, const N& b) { return a >= b; });

            default: return;  // no other operation computes numbers
        }
    }

    [[nodiscard]] bool* decisions(std::uint16_t index) const { return columns_.decisions + index * rays_per_batch; }
    void run_logic(const TapeStep& step) const {
        const bool* const a = decisions(step.operands[0]);
        const bool* const b = decisions(step.operands[1]);
        bool* const out = decisions(step.out);
        const auto for_each_ray = [&](const auto& f) {
            for (std::size_t i = 0; i < columns_.rays; ++i) out[i] = f(i);
        };
        switch (step.op) {
            case TapeOp::logical_and: return for_each_ray([&](std::size_t i) { return (a[i] & b[i]) != 0; });
            case TapeOp::logical_or: return for_each_ray([&](std::size_t i) { return (a[i] | b[i]) != 0; });
            case TapeOp::logical_not: return for_each_ray([&](std::size_t i) { return !a[i]; });
            default: return for_each_ray([&](std::size_t i) { return a[i]; });
        }
    }

    /// Converts any number to any other; the result is rounded once if it is narrower. The nearest float of a pair of
    /// floats is the high word, not double{hi} + double{lo} rounded to float: that sum may lie half way between two
    /// floats and be rounded away from the high word.
    void convert(const TapeStep& step) const {
        switch (step.operand_arithmetic) {
            case NodeArithmetic::one_float:
                return convert_from(step,
                                    [source = column<float>(step.operands[0])](std::size_t i) { return source[i]; });
            case NodeArithmetic::one_double:
                return convert_from(step,
                                    [source = column<double>(step.operands[0])](std::size_t i) { return source[i]; });
            case NodeArithmetic::float_pair: {
                const float *high = column<float>(step.operands[0]), *low = high + rays_per_batch;
                if (step.arithmetic == NodeArithmetic::one_float)
                    return convert_from(step, [high](std::size_t i) { return high[i]; });
                return convert_from(step, [high, low](std::size_t i) { return double{high[i]} + double{low[i]}; });
            }
            default:
                return convert_from(step,
                                    [source = column<double>(step.operands[0])](std::size_t i) { return source[i]; });
        }
    }
    template <class Source>
    void convert_from(const TapeStep& step, const Source& source) const {
        const bool is_pair =
            step.arithmetic == NodeArithmetic::float_pair || step.arithmetic == NodeArithmetic::double_pair;
        const auto write_column = [&]<class F>(F* high) {
            for (std::size_t i = 0; i < columns_.rays; ++i) {
                const auto x = source(i);
                high[i] = static_cast<F>(x);
                if (!is_pair) continue;
                F& low = (high + rays_per_batch)[i];
                if constexpr (sizeof(x) <= sizeof(F)) low = 0;
                else low = static_cast<F>(x - high[i]);
            }
        };
        if (step.arithmetic == NodeArithmetic::one_float || step.arithmetic == NodeArithmetic::float_pair)
            write_column(column<float>(step.out));
        else write_column(column<double>(step.out));
    }

    StepColumns columns_;
};

template <class Width>
void run_steps(const TapeStep* steps, std::size_t count, const StepColumns& columns) {
    const StepRunner<Width> runner(columns);
    for (std::size_t k = 0; k < count; ++k) runner.run(steps[k]);
}

}  // namespace lostbits::measure::tape
