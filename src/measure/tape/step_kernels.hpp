// The operations of a tape over columns. One translation unit for each register width includes this, and sees plain
// pointers only (intersect/simd/packed_batch.hpp says why).
#pragma once

#include <utility>

#include "measure/tape/steps.hpp"
#include "number/pack.hpp"
#include "number/wide/two_words.hpp"

namespace lostbits::measure::tape {

template <class Width>
class StepRunner {
public:
    explicit StepRunner(const StepColumns& columns) : at_(columns) {}

    void run(const TapeStep& s) const {
        if (s.from == Word::decision) return decide(s);
        if (s.op == TapeOp::convert) return convert(s);
        switch (s.from) {
            case Word::single: return compute<Single>(s);
            case Word::twice: return compute<Twice>(s);
            case Word::pair: return compute<Two<Single>>(s);
            case Word::twice_pair: return compute<Two<Twice>>(s);
            case Word::decision: return;
        }
    }

private:
    using Single = Pack<float, Width>;
    using Twice = Pack<double, Width>;
    template <class P>
    using Two = number::wide::TwoWords<P>;

    template <class F>
    [[nodiscard]] F* column(std::uint16_t place) const {
        if constexpr (sizeof(F) == sizeof(float)) return at_.floats + place * together;
        else return at_.doubles + place * together;
    }

    template <class N>
    struct Numbers;
    template <class F>
    struct Numbers<Pack<F, Width>> {
        using One = F;
        using Lanes = PackMask<F, Width>;
        static constexpr std::size_t lanes = Pack<F, Width>::lanes;
        F* values;
        Numbers(const StepRunner& r, std::uint16_t place) : values(r.template column<F>(place)) {}
        [[nodiscard]] Pack<F, Width> load(std::size_t i) const { return Pack<F, Width>::load(values + i); }
        void store(std::size_t i, const Pack<F, Width>& x) const { x.store(values + i); }
    };
    template <class P>
    struct Numbers<number::wide::TwoWords<P>> {
        using Lanes = typename Numbers<P>::Lanes;
        static constexpr std::size_t lanes = Numbers<P>::lanes;
        Numbers<P> high, low;
        Numbers(const StepRunner& r, std::uint16_t place)
            : high(r, place), low(r, static_cast<std::uint16_t>(place + 1)) {}
        [[nodiscard]] Two<P> load(std::size_t i) const { return {high.load(i), low.load(i)}; }
        void store(std::size_t i, const Two<P>& x) const { high.store(i, x.hi), low.store(i, x.lo); }
    };

    /// out[i] = f(a[i], …). The operands are read before the result is written, so the result may overwrite one of
    /// them.
    template <class N, std::size_t operands, class F>
    void computed(const TapeStep& s, const F& f) const {
        computed<N>(s, f, std::make_index_sequence<operands>());
    }
    template <class N, class F, std::size_t... k>
    void computed(const TapeStep& s, const F& f, std::index_sequence<k...>) const {
        const Numbers<N> out(*this, s.out), in[]{Numbers<N>(*this, s.operands[k])...};
        for (std::size_t i = 0; i < at_.rays; i += Numbers<N>::lanes) out.store(i, f(in[k].load(i)...));
    }
    template <class N, class F>
    void decision(const TapeStep& s, const F& f) const {
        const Numbers<N> a(*this, s.operands[0]), b(*this, s.operands[1]);
        bool* const out = decisions(s.out);
        for (std::size_t i = 0; i < at_.rays; i += Numbers<N>::lanes) f(a.load(i), b.load(i)).store(out + i);
    }
    template <class N>
    void choose(const TapeStep& s) const {
        const Numbers<N> a(*this, s.operands[1]), b(*this, s.operands[2]), out(*this, s.out);
        const bool* const first = decisions(s.operands[0]);
        using Lanes = typename Numbers<N>::Lanes;
        for (std::size_t i = 0; i < at_.rays; i += Numbers<N>::lanes) {
            out.store(i, select(Lanes::load(first + i), a.load(i), b.load(i)));
        }
    }

    template <class N>
    void compute(const TapeStep& s) const {
        switch (s.op) {
            case TapeOp::add: return computed<N, 2>(s, [](const N& a, const N& b) { return a + b; });
            case TapeOp::sub: return computed<N, 2>(s, [](const N& a, const N& b) { return a - b; });
            case TapeOp::mul: return computed<N, 2>(s, [](const N& a, const N& b) { return a * b; });
            case TapeOp::div: return computed<N, 2>(s, [](const N& a, const N& b) { return a / b; });
            case TapeOp::sqrt: return computed<N, 1>(s, [](const N& a) { return sqrt(a); });
            case TapeOp::fma: return computed<N, 3>(s, [](const N& a, const N& b, const N& c) { return fma(a, b, c); });
            case TapeOp::neg: return computed<N, 1>(s, [](const N& a) { return -a; });
            case TapeOp::abs: return computed<N, 1>(s, [](const N& a) { return abs(a); });
            case TapeOp::copysign: return computed<N, 2>(s, [](const N& a, const N& b) { return copysign(a, b); });
            case TapeOp::min: return computed<N, 2>(s, [](const N& a, const N& b) { return select(a < b, a, b); });
            case TapeOp::max: return computed<N, 2>(s, [](const N& a, const N& b) { return select(a > b, a, b); });
            case TapeOp::select: return choose<N>(s);
            case TapeOp::next_up: return computed<N, 1>(s, [](const N& a) { return next_up(a); });
            case TapeOp::next_down: return computed<N, 1>(s, [](const N& a) { return next_down(a); });
            case TapeOp::less: return decision<N>(s, [](const N& a, const N& b) { return a < b; });
            case TapeOp::less_equal: return decision<N>(s, [](const N& a, const N& b) { return a <= b; });
            case TapeOp::greater: return decision<N>(s, [](const N& a, const N& b) { return a > b; });
            case TapeOp::greater_equal: return decision<N>(s, [](const N& a, const N& b) { return a >= b; });
            default: return;  // no other operation computes numbers
        }
    }

    [[nodiscard]] bool* decisions(std::uint16_t place) const { return at_.decisions + place * together; }
    void decide(const TapeStep& s) const {
        const bool* const a = decisions(s.operands[0]);
        const bool* const b = decisions(s.operands[1]);
        bool* const out = decisions(s.out);
        const auto each = [&](const auto& f) {
            for (std::size_t i = 0; i < at_.rays; ++i) out[i] = f(i);
        };
        switch (s.op) {
            case TapeOp::both: return each([&](std::size_t i) { return (a[i] & b[i]) != 0; });
            case TapeOp::either: return each([&](std::size_t i) { return (a[i] | b[i]) != 0; });
            case TapeOp::opposite: return each([&](std::size_t i) { return !a[i]; });
            default: return each([&](std::size_t i) { return a[i]; });
        }
    }

    /// Converts any number to any other; a narrower one is rounded once. The nearest float of two floats is the high
    /// word: double{hi} + double{lo} may lie half way, and be rounded away from it.
    void convert(const TapeStep& s) const {
        switch (s.from) {
            case Word::single: return put(s, [in = column<float>(s.operands[0])](std::size_t i) { return in[i]; });
            case Word::twice: return put(s, [in = column<double>(s.operands[0])](std::size_t i) { return in[i]; });
            case Word::pair: {
                const float *high = column<float>(s.operands[0]), *low = high + together;
                if (s.word == Word::single) return put(s, [high](std::size_t i) { return high[i]; });
                return put(s, [high, low](std::size_t i) { return double{high[i]} + double{low[i]}; });
            }
            default: return put(s, [in = column<double>(s.operands[0])](std::size_t i) { return in[i]; });
        }
    }
    template <class From>
    void put(const TapeStep& s, const From& from) const {
        const bool is_pair = s.word == Word::pair || s.word == Word::twice_pair;
        const auto put_in = [&]<class F>(F* high) {
            for (std::size_t i = 0; i < at_.rays; ++i) {
                const auto x = from(i);
                high[i] = static_cast<F>(x);
                if (!is_pair) continue;
                F& low = (high + together)[i];
                if constexpr (sizeof(x) <= sizeof(F)) low = 0;
                else low = static_cast<F>(x - high[i]);
            }
        };
        if (s.word == Word::single || s.word == Word::pair) put_in(column<float>(s.out));
        else put_in(column<double>(s.out));
    }

    StepColumns at_;
};

template <class Width>
void run_steps(const TapeStep* steps, std::size_t count, const StepColumns& columns) {
    const StepRunner<Width> runner(columns);
    for (std::size_t k = 0; k < count; ++k) runner.run(steps[k]);
}

}  // namespace lostbits::measure::tape
