#include "measure/stability/stability.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "measure/attribution/exact_arithmetic.hpp"
#include "measure/attribution/operation_error.hpp"
#include "measure/attribution/operations.hpp"

namespace lostbits::measure::stability {

using namespace attribution;

namespace {

/// The SplitMix64 generator: its sequence depends only on the seed, not on the machine.
class SplitMix64 {
public:
    explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next_bits() {
        state_ += 0x9e3779b97f4a7c15U;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31);
    }
    bool toss() { return (next_bits() & 1U) != 0; }

private:
    std::uint64_t state_;
};

std::uint64_t seed_of(const Tape& tape) {
    std::uint64_t seed = 0;
    for (const TapeNode& node : tape.nodes)
        if (node.op == TapeOp::input) seed = SplitMix64(seed ^ std::bit_cast<std::uint64_t>(node.value)).next_bits();
    return seed;
}

/// Operands of a node, with the values of a tape.
struct Values {
    const Tape& tape;
    const TapeNode& n;
    [[nodiscard]] double of(std::size_t k) const { return tape[n.operands[k]].value; }
    [[nodiscard]] bool less(std::size_t k, std::size_t l) const { return of(k) < of(l); }
    [[nodiscard]] bool less_equal(std::size_t k, std::size_t l) const { return of(k) <= of(l); }
    [[nodiscard]] bool holds(std::size_t k) const { return of(k) != 0; }
};

/// Value of a node, computed from the values of its operands and rounded to nearest.
double value_of(const Tape& tape, NodeId i) {
    const TapeNode& n = tape[i];
    const Values values{tape, n};
    if (is_given(n.op)) return n.value;
    if (is_decision(n.op)) return holds(n.op, values) ? 1 : 0;
    if (kind_of(n.op) == OperationKind::choice) return tape[chosen_side(n, values)].value;
    if (n.op == TapeOp::call) {
        const auto exact = result_of_call<DeepExact>(tape, i, [&](NodeId k) { return DeepExact::lift(tape[k].value); });
        return exact ? DeepExact::round_to(*exact, tape.format_of(i)) : n.value;
    }
    std::array<double, 3> x{};
    for (std::size_t k = 0; k < row_of(n.op).operand_count; ++k) x[k] = values.of(k);
    return result_of(n.op, x, tape.format_of(i));
}

/// True for an operation that rounds. `next_up` and `next_down` do not count: their step is part of the formula.
bool rounds(TapeOp op) { return kind_of(op) == OperationKind::rounded || op == TapeOp::call || op == TapeOp::convert; }

void run_at_random(Tape& tape, SplitMix64& coins) {
    for (NodeId i = 0; i < tape.size(); ++i) {
        double& value = tape[i].value;
        value = value_of(tape, i);
        if (!rounds(tape[i].op)) continue;
        const double error = rounding_of(tape, i);
        if (error == 0 || !std::isfinite(error) || !coins.toss()) continue;
        value = result_of(error > 0 ? TapeOp::next_down : TapeOp::next_up, {value}, tape.format_of(i));
    }
}

}  // namespace

RandomRuns::RandomRuns(Tape tape) {
    SplitMix64 coins(seed_of(tape));
    for (std::size_t k = 0; k < t.size(); ++k) {
        run_at_random(tape, coins);
        t[k] = tape[tape.outputs.t].value;
        hit[k] = tape.outputs.hit == no_node || tape[tape.outputs.hit].value != 0;
    }
}

double RandomRuns::correct_bits(int precision) const {
    if (!std::ranges::all_of(hit, [](bool h) { return h; })) return std::numeric_limits<double>::quiet_NaN();
    double squares = 0;
    for (const double x : t) squares += (x - mean()) * (x - mean());
    if (t[0] == t[1] && t[1] == t[2]) return precision;
    const double bits = std::log2(std::sqrt(3) * std::fabs(mean()) / (4.303 * std::sqrt(squares / 2)));
    return bits > 0 ? std::min<double>(bits, precision) : 0;
}

double compute_statistical_bound(const Tape& tape, const Attribution& attribution) {
    double squares = 0;
    for (NodeId i = 0; i < tape.size(); ++i) {
        const OperationError& error = attribution.errors[i];
        if (!error.is_live || !rounds(tape[i].op)) continue;
        const double largest_error = error.adjoint * ulp_at(tape[i].value, tape.format_of(i)) / 2;
        squares += largest_error * largest_error;
    }
    return std::sqrt(squares);
}

}  // namespace lostbits::measure::stability
