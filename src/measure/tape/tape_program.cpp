#include "measure/tape/tape_program.hpp"

#include <algorithm>
#include <concepts>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>

#include "intersect/simd/packed.hpp"

namespace lostbits::measure::tape {

using intersect::Target;
using intersect::table::HitBatch;
using intersect::table::RayBatch;

namespace {

/// Number of a primitive in the order of `input_names`: its own, then those of its matrix.
template <class S>
S number_of(const Primitive<S>& primitive, std::size_t number) {
    const auto own = primitive.used();
    return number < own.size() ? own[number] : primitive.placed->matrix[number - own.size()];
}

constexpr bool is_pair(Word w) { return w == Word::pair || w == Word::twice_pair; }
/// Kind of column that holds a word: 0 floats, 1 doubles, 2 decisions.
constexpr std::size_t kind_of_column(Word w) {
    return w == Word::decision ? 2 : w == Word::twice || w == Word::twice_pair ? 1 : 0;
}

void run_steps(const std::vector<TapeStep>& steps, const StepColumns& columns) {
    const auto run = [&] {
#if defined(__x86_64__)
        if (intersect::simd::current_isa() == intersect::simd::Isa::w256) return run_steps_w256;
        if (intersect::simd::current_isa() == intersect::simd::Isa::w512) return run_steps_w512;
#endif
        return run_steps_w128;
    }();
    run(steps.data(), steps.size(), columns);
}

}  // namespace

Word word_of(const FloatFormat& format) {
    if (format == binary32) return Word::single;
    if (format == binary64) return Word::twice;
    if (format == two_floats) return Word::pair;
    if (format == two_doubles) return Word::twice_pair;
    throw std::logic_error("a program of a tape computes in float, double, two floats and two doubles");
}

/// Memory of one run.
class TapeProgram::Columns {
public:
    explicit Columns(const std::array<std::uint16_t, 3>& counts)
        : floats_(std::make_unique_for_overwrite<float[]>(counts[0] * together)),
          doubles_(std::make_unique_for_overwrite<double[]>(counts[1] * together)),
          decisions_(std::make_unique<bool[]>(counts[2] * together)) {}

    template <class P>
    [[nodiscard]] P* at(std::uint16_t column) const {
        if constexpr (std::same_as<P, float>) return floats_.get() + column * together;
        else if constexpr (std::same_as<P, double>) return doubles_.get() + column * together;
        else return decisions_.get() + column * together;
    }
    /// Sets x for all rays, in one column, or in two if the word is a pair.
    void fill(Word word, std::uint16_t place, double x) const {
        const auto put = [&]<class P>(std::uint16_t column, P value) { std::fill_n(at<P>(column), rays, value); };
        const auto in = [&]<class P>(P high) {
            put(place, high);
            if (is_pair(word))
                put(static_cast<std::uint16_t>(place + 1), static_cast<P>(x - static_cast<double>(high)));
        };
        if (kind_of_column(word) == 0) in(static_cast<float>(x));
        else in(x);
    }
    void run(const std::vector<TapeStep>& steps) const {
        run_steps(steps, {floats_.get(), doubles_.get(), decisions_.get(), rays});
    }

    std::size_t rays = 0;  ///< number of rays, at most `together`

private:
    std::unique_ptr<float[]> floats_;
    std::unique_ptr<double[]> doubles_;
    std::unique_ptr<bool[]> decisions_;
};

namespace {

/// Hands out columns of each kind and takes them back.
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

/// Last node that takes each node as an operand; `size()` for an output, −1 for a node that nothing needs.
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
        at(i) = places.take(word(i));  // never given back: inputs and constants stay for all rays
        if (n.op == TapeOp::input) inputs_.push_back({static_cast<std::size_t>(n.operands[0]), at(i)});
        else constants_.push_back({word(i), n.value, at(i)});
    }
    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeNode& n = tape[i];
        if (last[static_cast<std::size_t>(i)] == no_node || is_given(n.op)) continue;
        TapeStep s{.op = n.op,
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
    // Some callers ask for one ray and one primitive at a time. So columns that are the same for all rays are filled
    // only as far as there are rays.
    columns.rays = std::min(together, rays.size());
    for (const Constant& c : constants_) columns.fill(c.word, c.out, c.value);
    const bool one_primitive = target.primitives.size() == 1;
    const std::size_t limit = input_count_ - 1;
    const auto is_of_rays = [&](std::size_t number) { return number < 6 || number == limit; };
    const Word own = std::same_as<S, float> ? Word::single : Word::twice;
    for (const Input& in : inputs_) {
        if (one_primitive && !is_of_rays(in.number))
            columns.fill(own, in.out, static_cast<double>(number_of(target.primitives[0], in.number - 6)));
        if (in.number == limit && rays.tmax.empty()) columns.fill(own, in.out, std::numeric_limits<double>::infinity());
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
            else if (in.number != limit && !one_primitive)
                for (std::size_t i = 0; i < columns.rays; ++i)
                    out[i] = number_of(target.primitives[begin + i], in.number - 6);
        }
        columns.run(steps_);
        const auto put = [&](const auto* from, const auto& to) {
            std::copy_n(from, columns.rays, to.begin() + static_cast<std::ptrdiff_t>(begin));
        };
        put(columns.template at<bool>(outputs_[0]), hits.hit);
        put(columns.template at<S>(outputs_[1]), hits.t);
        put(columns.template at<S>(outputs_[2]), hits.near);
        put(columns.template at<S>(outputs_[3]), hits.far);
    }
}

template void TapeProgram::run(const RayBatch<float>&, const Target<float>&, const HitBatch<float>&) const;
template void TapeProgram::run(const RayBatch<double>&, const Target<double>&, const HitBatch<double>&) const;

}  // namespace lostbits::measure::tape
