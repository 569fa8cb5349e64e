#include "measure/tape/tape_program.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "number/wide/two_words.hpp"

namespace lostbits::measure::tape {

using intersect::Target;
using intersect::table::HitBatch;
using intersect::table::RayBatch;
using number::wide::TwoWords;

namespace {

/// Rays at a time: the columns of a form stay in the first-level cache.
constexpr std::size_t together = 128;

constexpr bool is_pair(Word w) { return w == Word::pair || w == Word::twice_pair; }
/// Which of floats, doubles and decisions it is made of.
constexpr std::size_t kind_of_column(Word w) {
    return w == Word::decision ? 2 : w == Word::twice || w == Word::twice_pair ? 1 : 0;
}

template <class N>
N from_double(double x) {
    return static_cast<N>(x);
}
template <>
TwoWords<float> from_double(double x) {
    const auto high = static_cast<float>(x);
    return {high, static_cast<float>(x - static_cast<double>(high))};
}
template <>
TwoWords<double> from_double(double x) {
    return TwoWords<double>(x);
}

/// Between any two; to what is narrower it is rounded once.
template <class To, class From>
To converted(const From& x) {
    if constexpr (std::same_as<To, From>) return x;
    else if constexpr (std::same_as<From, TwoWords<float>>) return from_double<To>(double{x.hi} + double{x.lo});
    else if constexpr (std::same_as<From, TwoWords<double>>) return from_double<To>(x.hi);
    else return from_double<To>(x);
}
/// The nearest float is the high word: double{hi} + double{lo} may lie half way, and be rounded away from it.
template <>
float converted(const TwoWords<float>& x) {
    return x.hi;
}

}  // namespace

Word word_of(const FloatFormat& format) {
    if (format == binary32) return Word::single;
    if (format == binary64) return Word::twice;
    if (format == two_floats) return Word::pair;
    if (format == two_doubles) return Word::twice_pair;
    throw std::logic_error("a program of a tape computes in float, double, two floats and two doubles");
}

/// The memory of one run.
struct TapeProgram::Columns {
    std::unique_ptr<float[]> floats;
    std::unique_ptr<double[]> doubles;
    std::unique_ptr<std::uint8_t[]> decisions;
    std::size_t rays = 0;  ///< of which `together` at most

    explicit Columns(const std::array<std::uint16_t, 3>& counts)
        : floats(std::make_unique_for_overwrite<float[]>(counts[0] * together)),
          doubles(std::make_unique_for_overwrite<double[]>(counts[1] * together)),
          decisions(std::make_unique_for_overwrite<std::uint8_t[]>(counts[2] * together)) {}

    template <class P>
    [[nodiscard]] P* at(std::uint16_t column) const {
        if constexpr (std::same_as<P, float>) return floats.get() + column * together;
        else if constexpr (std::same_as<P, double>) return doubles.get() + column * together;
        else return decisions.get() + column * together;
    }

    template <class N>
    struct Column {
        N* values;
        [[nodiscard]] N load(std::size_t i) const { return values[i]; }
        void store(std::size_t i, const N& x) const { values[i] = x; }
    };
    template <class P>
    struct Column<TwoWords<P>> {
        P *high, *low;
        [[nodiscard]] TwoWords<P> load(std::size_t i) const { return {high[i], low[i]}; }
        void store(std::size_t i, const TwoWords<P>& x) const { high[i] = x.hi, low[i] = x.lo; }
    };
    template <class N>
    [[nodiscard]] Column<N> column(std::uint16_t k) const {
        if constexpr (requires(N x) { x.hi; }) {
            using P = decltype(N{}.hi);
            return {at<P>(k), at<P>(static_cast<std::uint16_t>(k + 1))};
        } else {
            return {at<N>(k)};
        }
    }

    template <class N>
    void fill(std::uint16_t k, const N& x) const {
        const auto out = column<N>(k);
        for (std::size_t i = 0; i < rays; ++i) out.store(i, x);
    }

    /// out[i] = f(a[i], …) for the rays at hand. Each ray's operands are read before its result is written, so a result
    /// may take the place of an operand.
    template <class Out, class... In, class F, std::size_t... k>
    void apply(const Step& s, const F& f, std::index_sequence<k...>) const {
        const auto out = column<Out>(s.out);
        const std::tuple in{column<In>(s.operands[k])...};
        const std::size_t n = rays;
#pragma GCC ivdep
        for (std::size_t i = 0; i < n; ++i) out.store(i, static_cast<Out>(f(std::get<k>(in).load(i)...)));
    }
    template <class Out, class... In, class F>
    void apply(const Step& s, const F& f) const {
        apply<Out, In...>(s, f, std::index_sequence_for<In...>());
    }

    template <class N>
    void compute(const Step& s) const {
        using Mask = std::uint8_t;
        switch (s.op) {
            case TapeOp::add: return apply<N, N, N>(s, [](const N& a, const N& b) { return a + b; });
            case TapeOp::sub: return apply<N, N, N>(s, [](const N& a, const N& b) { return a - b; });
            case TapeOp::mul: return apply<N, N, N>(s, [](const N& a, const N& b) { return a * b; });
            case TapeOp::div: return apply<N, N, N>(s, [](const N& a, const N& b) { return a / b; });
            case TapeOp::sqrt: return apply<N, N>(s, [](const N& a) { return sqrt(a); });
            case TapeOp::fma:
                return apply<N, N, N, N>(s, [](const N& a, const N& b, const N& c) { return fma(a, b, c); });
            case TapeOp::neg: return apply<N, N>(s, [](const N& a) { return -a; });
            case TapeOp::abs: return apply<N, N>(s, [](const N& a) { return abs(a); });
            case TapeOp::copysign: return apply<N, N, N>(s, [](const N& a, const N& b) { return copysign(a, b); });
            case TapeOp::min: return apply<N, N, N>(s, [](const N& a, const N& b) { return a < b ? a : b; });
            case TapeOp::max: return apply<N, N, N>(s, [](const N& a, const N& b) { return a > b ? a : b; });
            case TapeOp::select:
                return apply<N, Mask, N, N>(s, [](Mask m, const N& a, const N& b) { return m != 0 ? a : b; });
            case TapeOp::next_up: return apply<N, N>(s, [](const N& a) { return next_up(a); });
            case TapeOp::next_down: return apply<N, N>(s, [](const N& a) { return next_down(a); });
            case TapeOp::less: return apply<Mask, N, N>(s, [](const N& a, const N& b) { return a < b; });
            case TapeOp::less_equal: return apply<Mask, N, N>(s, [](const N& a, const N& b) { return a <= b; });
            case TapeOp::greater: return apply<Mask, N, N>(s, [](const N& a, const N& b) { return a > b; });
            case TapeOp::greater_equal: return apply<Mask, N, N>(s, [](const N& a, const N& b) { return a >= b; });
            default: throw std::logic_error("no operation of numbers");
        }
    }

    void decide(const Step& s) const {
        using Mask = std::uint8_t;
        switch (s.op) {
            case TapeOp::both: return apply<Mask, Mask, Mask>(s, [](Mask a, Mask b) { return a & b; });
            case TapeOp::either: return apply<Mask, Mask, Mask>(s, [](Mask a, Mask b) { return a | b; });
            case TapeOp::opposite: return apply<Mask, Mask>(s, [](Mask a) { return a ^ 1; });
            default: return apply<Mask, Mask>(s, [](Mask a) { return a; });
        }
    }

    template <class Act>
    static void with_number(Word word, const Act& act) {
        switch (word) {
            case Word::single: return act.template operator()<float>();
            case Word::twice: return act.template operator()<double>();
            case Word::pair: return act.template operator()<TwoWords<float>>();
            case Word::twice_pair: return act.template operator()<TwoWords<double>>();
            case Word::decision: break;
        }
        throw std::logic_error("no number");
    }

    void step(const Step& s) const {
        if (s.from == Word::decision) return decide(s);
        with_number(s.from, [&]<class From>() {
            if (s.op != TapeOp::convert) return compute<From>(s);
            with_number(s.word,
                        [&]<class To>() { apply<To, From>(s, [](const From& x) { return converted<To>(x); }); });
        });
    }
};

namespace {

/// Columns of each kind, given away and taken back.
class Places {
public:
    std::uint16_t take(Word word) {
        auto& free = free_[static_cast<std::size_t>(word)];
        if (!free.empty()) {
            const std::uint16_t place = free.back();
            free.pop_back();
            return place;
        }
        std::uint16_t& count = counts[kind_of_column(word)];
        const std::uint16_t place = count;
        count = static_cast<std::uint16_t>(count + (is_pair(word) ? 2 : 1));
        return place;
    }
    void give_back(Word word, std::uint16_t place) { free_[static_cast<std::size_t>(word)].push_back(place); }
    std::array<std::uint16_t, 3> counts{};

private:
    std::array<std::vector<std::uint16_t>, 5> free_;
};

/// The last node that takes each as an operand; `size()` where it is an output, −1 where nothing needs it.
std::vector<NodeId> last_uses(const Tape& tape) {
    std::vector<NodeId> last(tape.nodes.size(), no_node);
    for (const NodeId out : {tape.outputs.hit, tape.outputs.t, tape.outputs.near, tape.outputs.far})
        last[static_cast<std::size_t>(out)] = tape.size();
    for (NodeId i = tape.size() - 1; i >= 0; --i) {
        if (last[static_cast<std::size_t>(i)] == no_node || is_given(tape[i].op)) continue;
        for (const NodeId operand : tape[i].operands) {
            if (operand == no_node) continue;
            NodeId& use = last[static_cast<std::size_t>(operand)];
            use = std::max(use, i);
        }
    }
    return last;
}

}  // namespace

TapeProgram::TapeProgram(const Tape& tape) {
    const std::vector<NodeId> last = last_uses(tape);
    const auto word = [&](NodeId i) { return is_decision(tape[i].op) ? Word::decision : word_of(tape.format_of(i)); };
    Places places;
    std::vector<std::uint16_t> place(tape.nodes.size());
    const auto at = [&](NodeId i) -> std::uint16_t& { return place[static_cast<std::size_t>(i)]; };
    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeNode& n = tape[i];
        if (n.op == TapeOp::input) ++input_count_;
        if (last[static_cast<std::size_t>(i)] == no_node || !is_given(n.op)) continue;
        at(i) = places.take(word(i));  // and kept: what is given is there for all rays
        if (n.op == TapeOp::input) inputs_.push_back({static_cast<std::size_t>(n.operands[0]), at(i)});
        else constants_.push_back({word(i), n.value, at(i)});
    }
    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeNode& n = tape[i];
        if (last[static_cast<std::size_t>(i)] == no_node || is_given(n.op)) continue;
        Step s{.op = n.op,
               .word = word(i),
               .from = word(n.operands[n.op == TapeOp::select ? 1 : 0]),
               .operands = {},
               .out = 0};
        for (std::size_t k = 0; k < 3; ++k)
            if (n.operands[k] != no_node) s.operands[k] = at(n.operands[k]);
        for (std::size_t k = 0; k < 3; ++k) {
            const NodeId operand = n.operands[k];
            const bool again = std::find(n.operands.begin(), n.operands.begin() + k, operand) != n.operands.begin() + k;
            if (operand != no_node && !again && !is_given(tape[operand].op) &&
                last[static_cast<std::size_t>(operand)] == i)
                places.give_back(word(operand), at(operand));
        }
        s.out = at(i) = places.take(s.word);
        steps_.push_back(s);
    }
    columns_ = places.counts;
    outputs_ = {at(tape.outputs.hit), at(tape.outputs.t), at(tape.outputs.near), at(tape.outputs.far)};
}

template <class S>
void TapeProgram::run(const RayBatch<S>& rays, const Target<S>& target, const HitBatch<S>& hits) const {
    const std::array six{rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz};
    Columns columns(columns_);
    // A ray and one of many solids come alone: what is the same for all rays is filled in no farther than they go.
    columns.rays = std::min(together, rays.size());
    for (const Constant& c : constants_)
        Columns::with_number(c.word, [&]<class N>() { columns.fill(c.out, from_double<N>(c.value)); });
    const bool one_solid = target.solids.size() == 1;
    const std::size_t limit = input_count_ - 1;
    const auto is_of_rays = [&](std::size_t number) { return number < 6 || number == limit; };
    for (const Input& in : inputs_) {
        if (one_solid && !is_of_rays(in.number)) columns.fill<S>(in.out, target.solids[0].numbers[in.number - 6]);
        if (in.number == limit && rays.tmax.empty()) columns.fill<S>(in.out, std::numeric_limits<S>::infinity());
    }
    for (std::size_t begin = 0; begin < rays.size(); begin += together) {
        columns.rays = std::min(together, rays.size() - begin);
        for (const Input& in : inputs_) {
            S* const out = columns.template at<S>(in.out);
            const auto copy = [&](std::span<const S> from) {
                std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(begin), columns.rays, out);
            };
            if (in.number < 6) copy(six[in.number]);
            else if (in.number == limit && !rays.tmax.empty()) copy(rays.tmax);
            else if (in.number != limit && !one_solid)
                for (std::size_t i = 0; i < columns.rays; ++i) out[i] = target.solids[begin + i].numbers[in.number - 6];
        }
        for (const Step& s : steps_) columns.step(s);
        const auto put = [&](const auto* from, const auto& to) {
            std::copy_n(from, columns.rays, to.begin() + static_cast<std::ptrdiff_t>(begin));
        };
        put(columns.template at<std::uint8_t>(outputs_[0]), hits.hit);
        put(columns.template at<S>(outputs_[1]), hits.t);
        put(columns.template at<S>(outputs_[2]), hits.near);
        put(columns.template at<S>(outputs_[3]), hits.far);
    }
}

template void TapeProgram::run(const RayBatch<float>&, const Target<float>&, const HitBatch<float>&) const;
template void TapeProgram::run(const RayBatch<double>&, const Target<double>&, const HitBatch<double>&) const;

}  // namespace lostbits::measure::tape
