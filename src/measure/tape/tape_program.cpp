#include "measure/tape/tape_program.hpp"

#include <algorithm>
#include <concepts>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>

#include "intersect/simd/of_width.hpp"

namespace lostbits::measure::tape {

using intersect::Target;
using intersect::table::HitBatch;
using intersect::table::RayBatch;

namespace {

/// A number of a primitive, by its index in the order of `input_names`: the numbers of the shape, then those of its
/// matrix.
template <class S>
S primitive_number(const Primitive<S>& primitive, std::size_t index) {
    const auto numbers = primitive.shape_numbers();
    return index < numbers.size() ? numbers[index] : primitive.transform->matrix[index - numbers.size()];
}

constexpr bool is_pair(NodeArithmetic arithmetic) {
    return arithmetic == NodeArithmetic::float_pair || arithmetic == NodeArithmetic::double_pair;
}
/// Kind of column that holds a number of this arithmetic: 0 for floats, 1 for doubles, 2 for decisions.
constexpr std::size_t kind_of_column(NodeArithmetic arithmetic) {
    return arithmetic == NodeArithmetic::decision                                                  ? 2
           : arithmetic == NodeArithmetic::one_double || arithmetic == NodeArithmetic::double_pair ? 1
                                                                                                   : 0;
}

void run_steps(const std::vector<TapeStep>& steps, const StepColumns& columns) {
    using Run = void(const TapeStep*, std::size_t, const StepColumns&);
    static constexpr intersect::simd::FunctionOfWidth<Run> of_width = LOSTBITS_OF_EACH_WIDTH(run_steps);
    of_width.at(intersect::simd::register_isa(intersect::simd::current_isa()))(steps.data(), steps.size(), columns);
}

}  // namespace

NodeArithmetic arithmetic_of(const FloatFormat& format) {
    if (format == binary32) return NodeArithmetic::one_float;
    if (format == binary64) return NodeArithmetic::one_double;
    if (format == two_floats) return NodeArithmetic::float_pair;
    if (format == two_doubles) return NodeArithmetic::double_pair;
    throw std::logic_error("a program of a tape computes in float, double, two floats and two doubles");
}

/// The columns of one run.
class TapeProgram::Columns {
public:
    explicit Columns(const std::array<std::uint16_t, 3>& counts)
        : floats_(std::make_unique_for_overwrite<float[]>(counts[0] * rays_per_batch)),
          doubles_(std::make_unique_for_overwrite<double[]>(counts[1] * rays_per_batch)),
          decisions_(std::make_unique<bool[]>(counts[2] * rays_per_batch)) {}

    template <class P>
    [[nodiscard]] P* at(std::uint16_t column) const {
        if constexpr (std::same_as<P, float>) return floats_.get() + column * rays_per_batch;
        else if constexpr (std::same_as<P, double>) return doubles_.get() + column * rays_per_batch;
        else return decisions_.get() + column * rays_per_batch;
    }
    /// Sets x for all rays, in one column, or in two if the arithmetic is a pair.
    void fill(NodeArithmetic arithmetic, std::uint16_t column, double x) const {
        const auto fill_column = [&]<class P>(std::uint16_t index, P value) { std::fill_n(at<P>(index), rays, value); };
        const auto fill_words = [&]<class P>(P high) {
            fill_column(column, high);
            if (is_pair(arithmetic))
                fill_column(static_cast<std::uint16_t>(column + 1), static_cast<P>(x - static_cast<double>(high)));
        };
        if (kind_of_column(arithmetic) == 0) fill_words(static_cast<float>(x));
        else fill_words(x);
    }
    void run(const std::vector<TapeStep>& steps) const {
        run_steps(steps, {floats_.get(), doubles_.get(), decisions_.get(), rays});
    }

    std::size_t rays = 0;  ///< number of rays, at most `rays_per_batch`

private:
    std::unique_ptr<float[]> floats_;
    std::unique_ptr<double[]> doubles_;
    std::unique_ptr<bool[]> decisions_;
};

namespace {

/// Allocates columns of each kind, and reuses released ones.
class ColumnPool {
public:
    std::uint16_t acquire(NodeArithmetic arithmetic) {
        auto& free = free_[static_cast<std::size_t>(arithmetic)];
        if (!free.empty()) {
            const std::uint16_t column = free.back();
            free.pop_back();
            return column;
        }
        std::uint16_t& count = counts[kind_of_column(arithmetic)];
        const std::uint16_t column = count;
        count = static_cast<std::uint16_t>(count + (is_pair(arithmetic) ? 2 : 1));
        return column;
    }
    void release(NodeArithmetic arithmetic, std::uint16_t column) {
        free_[static_cast<std::size_t>(arithmetic)].push_back(column);
    }
    std::array<std::uint16_t, 3> counts{};

private:
    std::array<std::vector<std::uint16_t>, 5> free_;
};

/// Returns, for each node, the last node that has it as an operand: `size()` for an output, −1 for a node that no
/// output needs.
std::vector<NodeId> find_last_uses(const Tape& tape) {
    std::vector<NodeId> last(tape.nodes.size(), no_node);
    for (const NodeId out : {tape.outputs.hit, tape.outputs.t, tape.outputs.near, tape.outputs.far})
        last[out] = tape.size();
    for (NodeId i = tape.size() - 1; i >= 0; --i) {
        if (last[i] == no_node || is_given(tape[i].op)) continue;
        for (const NodeId operand : tape[i].operands) {
            if (operand == no_node) continue;
            NodeId& use = last[operand];
            use = std::max(use, i);
        }
    }
    return last;
}

}  // namespace

TapeProgram::TapeProgram(const Tape& tape) {
    const std::vector<NodeId> last_use = find_last_uses(tape);
    const auto node_arithmetic = [&](NodeId i) {
        return is_decision(tape[i].op) ? NodeArithmetic::decision : arithmetic_of(tape.format_of(i));
    };
    ColumnPool pool;
    std::vector<std::uint16_t> column_of(tape.nodes.size());

    // Inputs and constants are kept for all rays, so their columns are never released.
    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeNode& node = tape[i];
        if (node.op == TapeOp::input) ++input_count_;
        if (last_use[i] == no_node || !is_given(node.op)) continue;
        column_of[i] = pool.acquire(node_arithmetic(i));
        if (node.op == TapeOp::input) inputs_.push_back({static_cast<std::size_t>(node.operands[0]), column_of[i]});
        else constants_.push_back({node_arithmetic(i), node.value, column_of[i]});
    }

    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeNode& node = tape[i];
        if (last_use[i] == no_node || is_given(node.op)) continue;
        TapeStep step{.op = node.op,
                      .arithmetic = node_arithmetic(i),
                      .operand_arithmetic = node_arithmetic(node.operands[node.op == TapeOp::select ? 1 : 0]),
                      .operands = {},
                      .out = 0};
        for (std::size_t k = 0; k < 3; ++k)
            if (node.operands[k] != no_node) step.operands[k] = column_of[node.operands[k]];

        // The result may take the column of an operand that no later step reads.
        for (std::size_t k = 0; k < 3; ++k) {
            const NodeId operand = node.operands[k];
            const bool is_repeated =
                std::find(node.operands.begin(), node.operands.begin() + k, operand) != node.operands.begin() + k;
            if (operand != no_node && !is_repeated && !is_given(tape[operand].op) && last_use[operand] == i)
                pool.release(node_arithmetic(operand), column_of[operand]);
        }
        step.out = column_of[i] = pool.acquire(step.arithmetic);
        steps_.push_back(step);
    }

    column_counts_ = pool.counts;
    outputs_ = {column_of[tape.outputs.hit], column_of[tape.outputs.t], column_of[tape.outputs.near],
                column_of[tape.outputs.far]};
}

template <class S>
void TapeProgram::run(const RayBatch<S>& rays, const Target<S>& target, const HitBatch<S>& hits) const {
    const std::array ray_columns{rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz};
    Columns columns(column_counts_);

    // Columns whose numbers are the same for all rays are filled only as far as there are rays, because some callers
    // run one ray at a time.
    columns.rays = std::min(rays_per_batch, rays.size());
    for (const Constant& c : constants_) columns.fill(c.arithmetic, c.out, c.value);
    const bool has_one_primitive = target.primitives.size() == 1;
    const std::size_t tmax_index = input_count_ - 1;
    const auto is_ray_input = [&](std::size_t index) { return index < 6 || index == tmax_index; };
    const NodeArithmetic ray_arithmetic =
        std::same_as<S, float> ? NodeArithmetic::one_float : NodeArithmetic::one_double;
    for (const Input& input : inputs_) {
        if (has_one_primitive && !is_ray_input(input.index))
            columns.fill(ray_arithmetic, input.out,
                         static_cast<double>(primitive_number(target.primitives[0], input.index - 6)));
        if (input.index == tmax_index && rays.tmax.empty())
            columns.fill(ray_arithmetic, input.out, std::numeric_limits<double>::infinity());
    }

    // Runs all steps on one batch of rays after the other.
    for (std::size_t begin = 0; begin < rays.size(); begin += rays_per_batch) {
        columns.rays = std::min(rays_per_batch, rays.size() - begin);
        for (const Input& input : inputs_) {
            S* const out = columns.template at<S>(input.out);
            const auto copy_column = [&](std::span<const S> source) {
                std::copy_n(source.begin() + static_cast<std::ptrdiff_t>(begin), columns.rays, out);
            };
            if (input.index < 6) copy_column(ray_columns[input.index]);
            else if (input.index == tmax_index && !rays.tmax.empty()) copy_column(rays.tmax);
            else if (input.index != tmax_index && !has_one_primitive)
                for (std::size_t i = 0; i < columns.rays; ++i)
                    out[i] = primitive_number(target.primitives[begin + i], input.index - 6);
        }

        columns.run(steps_);

        const auto copy_out = [&](const auto* source, const auto& destination) {
            std::copy_n(source, columns.rays, destination.begin() + static_cast<std::ptrdiff_t>(begin));
        };
        copy_out(columns.template at<bool>(outputs_[0]), hits.hit);
        copy_out(columns.template at<S>(outputs_[1]), hits.t);
        copy_out(columns.template at<S>(outputs_[2]), hits.near);
        copy_out(columns.template at<S>(outputs_[3]), hits.far);
    }
}

template void TapeProgram::run(const RayBatch<float>&, const Target<float>&, const HitBatch<float>&) const;
template void TapeProgram::run(const RayBatch<double>&, const Target<double>&, const HitBatch<double>&) const;

}  // namespace lostbits::measure::tape
