#include "intersect/function/nodes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

constexpr std::size_t max_nodes = 200'000;

bool comparison(TapeOp op, double a, double b) {
    switch (op) {
        case TapeOp::less: return a < b;
        case TapeOp::less_equal: return a <= b;
        case TapeOp::greater: return a > b;
        default: return a >= b;
    }
}

}  // namespace

NodeId Nodes::add(ProgramNode node) {
    if (nodes_.size() >= max_nodes)
        throw NotFollowed("the function has more than " + std::to_string(max_nodes) + " operations on one ray");
    if (node.place < 0) node.place = place;
    nodes_.push_back(std::move(node));
    return static_cast<NodeId>(nodes_.size() - 1);
}

NodeId Nodes::input(int index) {
    const auto [entry, is_new] = known_nodes_.try_emplace({TapeOp::input, index, no_node, 0, false}, 0);
    if (is_new) entry->second = add({.op = TapeOp::input, .operands = {index, no_node, no_node}});
    return entry->second;
}

NodeId Nodes::constant(double value, bool wide) {
    const auto [entry, is_new] =
        known_nodes_.try_emplace({TapeOp::constant, no_node, no_node, std::bit_cast<std::uint64_t>(value), wide}, 0);
    if (is_new) entry->second = add({.wide = wide, .value = value});
    return entry->second;
}

bool Nodes::fits_format(double x) const {
    return bits_ == 64 || std::isnan(x) || static_cast<double>(static_cast<float>(x)) == x;
}

std::optional<NodeId> Nodes::unwidened_node(NodeId x) {
    const ProgramNode& n = (*this)[x];
    if (!n.wide) return {};
    if (n.op == TapeOp::convert) return n.operands[0];
    if (n.op == TapeOp::constant && fits_format(n.value)) return constant(n.value, false);
    return {};
}

NodeId Nodes::widen(NodeId x) {
    if (bits_ == 64) return x;
    if ((*this)[x].op == TapeOp::constant) return constant((*this)[x].value, true);
    const auto [entry, is_new] = known_nodes_.try_emplace({TapeOp::convert, x, no_node, 0, true}, 0);
    if (is_new) entry->second = add({.op = TapeOp::convert, .wide = true, .operands = {x, no_node, no_node}});
    return entry->second;
}

/// Rounds a double to the function's format. If the double is an operation on converted numbers, the operation is done
/// in that format instead. The result is the same number: binary64 has more than twice the digits of binary32 and two
/// more (S. A. Figueroa, When is double rounding innocuous?, 1995).
NodeId Nodes::narrow(NodeId x) {
    if (const auto exact = unwidened_node(x)) return *exact;
    const ProgramNode n = (*this)[x];
    if (n.op == TapeOp::constant) return constant(static_cast<double>(static_cast<float>(n.value)), false);

    const bool rounds_once = n.op == TapeOp::add || n.op == TapeOp::sub || n.op == TapeOp::mul || n.op == TapeOp::div ||
                             n.op == TapeOp::sqrt;
    if (rounds_once)
        if (const auto operands = unwidened_operands(n.operands, row_of(n.op).operand_count))
            return add({.op = n.op, .operands = *operands, .place = n.place});
    return add({.op = TapeOp::convert, .operands = {x, no_node, no_node}});
}

/// Returns the numbers of the function's own format whose conversions are the first `count` operands; empty if one of
/// the operands is not such a conversion.
std::optional<std::array<NodeId, 3>> Nodes::unwidened_operands(const std::array<NodeId, 3>& operands,
                                                               std::size_t count) {
    std::array<NodeId, 3> unwidened{no_node, no_node, no_node};
    bool all_unconverted = true;
    for (std::size_t k = 0; k < count; ++k) {
        const auto exact = unwidened_node(operands[k]);
        all_unconverted = all_unconverted && exact.has_value();
        unwidened[k] = exact.value_or(no_node);
    }
    return all_unconverted ? std::optional(unwidened) : std::nullopt;
}

NodeId Nodes::arithmetic(TapeOp op, NodeId a, NodeId b, NodeId c) {
    const std::array<NodeId, 3> operands{a, b, c};
    const bool wide = (*this)[a].wide;
    const bool is_exact =
        op == TapeOp::neg || op == TapeOp::abs || op == TapeOp::copysign || op == TapeOp::min || op == TapeOp::max;
    if (wide && is_exact)
        if (const auto narrow_operands = unwidened_operands(operands, row_of(op).operand_count)) {
            const auto [x, y, z] = *narrow_operands;
            return widen(arithmetic(op, x, y, z));
        }

    const auto is_constant_or_none = [&](NodeId i) { return i == no_node || (*this)[i].op == TapeOp::constant; };
    if (is_constant_or_none(a) && is_constant_or_none(b) && is_constant_or_none(c)) {
        const double x = (*this)[a].value, y = b == no_node ? 0 : (*this)[b].value;
        if (const auto result = exact_result(op, x, y, wide)) return constant(*result, wide);
    }
    return add({.op = op, .wide = wide, .operands = operands});
}

/// Computes an operation on known numbers, such as those of a counter, if its result is exact; empty otherwise.
std::optional<double> Nodes::exact_result(TapeOp op, double x, double y, bool wide) const {
    if (op == TapeOp::neg) return -x;
    if (op == TapeOp::abs) return std::fabs(x);
    if (op != TapeOp::add && op != TapeOp::sub && op != TapeOp::mul) return {};

    // The rounding error of a product by fma, that of a sum by the sum of Knuth.
    const double z = op == TapeOp::sub ? -y : y;
    const double r = op == TapeOp::mul ? x * y : x + z;
    const double x_part = r - z;
    const bool is_exact = op == TapeOp::mul ? std::fma(x, y, -r) == 0 : (x - x_part) + (z - (r - x_part)) == 0;
    const bool is_representable = std::isfinite(r) && (wide || fits_format(r)) && (r == 0 || std::fabs(r) > 1e-30);
    return is_exact && is_representable ? std::optional(r) : std::nullopt;
}

NodeId Nodes::select(Mask when, NodeId a, NodeId b) {
    if (when == yes || a == b) return a;
    if (when == no) return b;
    if ((*this)[when].op == TapeOp::logical_not) return select((*this)[when].operands[0], b, a);

    // A selection inside a selection by the same decision always takes the same side.
    const auto side_value = [&](NodeId side, std::size_t k) {
        const ProgramNode& n = (*this)[side];
        return n.op == TapeOp::select && n.operands[0] == when ? n.operands[k] : side;
    };
    a = side_value(a, 1);
    b = side_value(b, 2);
    if (a == b) return a;

    if ((*this)[a].wide) {
        const auto x = unwidened_node(a), y = unwidened_node(b);
        if (x && y) return widen(select(when, *x, *y));
    }
    return add({.op = TapeOp::select, .wide = (*this)[a].wide, .operands = {when, a, b}});
}

NodeId Nodes::minimum_or_maximum(TapeOp op, NodeId a, NodeId b) {
    const TapeOp comparison_op = op == TapeOp::min ? TapeOp::less : TapeOp::greater;
    // x86 evaluates b < a and returns a if the two are equal.
    return select(logical_or(compare(comparison_op, b, a), is_nan(a)), b, a);
}

/// Subtracts from |x| each power of two that fits, the largest first. Each partial sum consists of leading digits of
/// |x|. So it is exact in every format, and the decisions are right in exact arithmetic, too. A number of p digits is
/// a whole number from 2^(p-1) on.
NodeId Nodes::round_to_whole(WholeNumber rounding, NodeId x) {
    const bool wide = (*this)[x].wide;
    const int digits = bits_ == 64 || wide ? 53 : 24;
    const auto constant_of = [&](double c) { return constant(c, wide); };

    // The whole part of |x|, and the last bit of the whole part.
    const NodeId size = arithmetic(TapeOp::abs, x);
    NodeId sum = constant_of(0);
    Mask is_odd = no;
    for (int e = digits - 2; e >= 0; --e) {
        const NodeId larger_sum = arithmetic(TapeOp::add, sum, constant_of(std::ldexp(1.0, e)));
        is_odd = compare(TapeOp::less_equal, larger_sum, size);
        sum = select(is_odd, larger_sum, sum);
    }

    // Rounds from the whole part to the next number below or above, or to the nearer one of the two.
    const NodeId truncated = arithmetic(TapeOp::copysign, sum, x), fraction = arithmetic(TapeOp::sub, size, sum);
    const auto compare_with_half = [&](TapeOp op) { return compare(op, fraction, constant_of(0.5)); };
    const auto moved_by_one = [&](Mask when, TapeOp op) {
        return select(when, arithmetic(op, truncated, constant_of(1)), truncated);
    };
    NodeId rounded = truncated;
    switch (rounding) {
        case WholeNumber::towards_zero: break;
        case WholeNumber::below: rounded = moved_by_one(compare(TapeOp::less, x, truncated), TapeOp::sub); break;
        case WholeNumber::above: rounded = moved_by_one(compare(TapeOp::less, truncated, x), TapeOp::add); break;
        default: {
            const Mask rounds_away = rounding == WholeNumber::nearest_or_away
                                         ? compare_with_half(TapeOp::greater_equal)
                                         : logical_or(compare_with_half(TapeOp::greater),
                                                      logical_and(compare_with_half(TapeOp::greater_equal), is_odd));
            rounded = select(rounds_away, arithmetic(TapeOp::copysign, arithmetic(TapeOp::add, sum, constant_of(1)), x),
                             truncated);
        }
    }

    // Larger numbers are whole, and comparisons with NaN are false: both stay as they are.
    return select(compare(TapeOp::less, size, constant_of(std::ldexp(1.0, digits - 1))), rounded, x);
}

Mask Nodes::compare(TapeOp op, NodeId a, NodeId b) {
    const std::tuple key{op, a, b, std::uint64_t{0}, false};
    if (const auto known_result = known_nodes_.find(key); known_result != known_nodes_.end())
        return known_result->second;
    if (const auto resolved = compare_side_by_side(op, a, b, Selection::left)) return known_nodes_[key] = *resolved;
    if (const auto resolved = compare_side_by_side(op, b, a, Selection::right)) return known_nodes_[key] = *resolved;

    // Comparisons of constants, and with NaN.
    const ProgramNode x = (*this)[a], y = (*this)[b];
    if (x.op == TapeOp::constant && y.op == TapeOp::constant) return comparison(op, x.value, y.value) ? yes : no;
    if ((x.op == TapeOp::constant && std::isnan(x.value)) || (y.op == TapeOp::constant && std::isnan(y.value)))
        return no;

    if (x.wide)
        if (const auto narrow_operands = narrow_comparison(op, a, b))
            return compare(op, narrow_operands->first, narrow_operands->second);
    return known_nodes_[key] = add({.op = op, .operands = {a, b, no_node}});
}

/// If `x` selects among constants and `y` is a constant, compares each of them on its own, and combines the results by
/// the decisions. For example, if t is −1 for a miss, t < 0 becomes the decision that selects −1. `selection` is the
/// side of the comparison on which `x` stands.
std::optional<Mask> Nodes::compare_side_by_side(TapeOp op, NodeId x, NodeId y, Selection selection) {
    bool has_others = false;
    const ProgramNode chosen = (*this)[x];
    if (chosen.op != TapeOp::select || (*this)[y].op != TapeOp::constant) return {};
    if (constants_of(x, has_others).empty()) return {};
    const auto compare_value = [&](NodeId v) {
        return selection == Selection::left ? compare(op, v, y) : compare(op, y, v);
    };
    const Mask result_if_true = compare_value(chosen.operands[1]);
    return select_mask(chosen.operands[0], result_if_true, compare_value(chosen.operands[2]));
}

/// Returns operands of the function's own format whose comparison gives the same decision; empty if no such operands
/// exist. A constant between two neighbouring numbers of that format is replaced by the neighbour on the side that `op`
/// needs.
std::optional<std::pair<NodeId, NodeId>> Nodes::narrow_comparison(TapeOp op, NodeId a, NodeId b) {
    const ProgramNode x = (*this)[a], y = (*this)[b];
    auto narrow_a = unwidened_node(a), narrow_b = unwidened_node(b);
    const auto neighbour = [&](double c, bool up) {
        float f = static_cast<float>(c);
        if (up && f < c) f = std::nextafterf(f, std::numeric_limits<float>::infinity());
        if (!up && f > c) f = std::nextafterf(f, -std::numeric_limits<float>::infinity());
        return constant(f, false);
    };
    if (narrow_a && !narrow_b && y.op == TapeOp::constant)
        narrow_b = neighbour(y.value, op == TapeOp::less || op == TapeOp::greater_equal);
    else if (narrow_b && !narrow_a && x.op == TapeOp::constant)
        narrow_a = neighbour(x.value, op == TapeOp::greater || op == TapeOp::less_equal);
    if (!narrow_a || !narrow_b) return {};
    return std::pair(*narrow_a, *narrow_b);
}

Mask Nodes::logic(TapeOp op, Mask a, Mask b) {
    const auto [entry, is_new] = known_nodes_.try_emplace({op, a, b, 0, false}, 0);
    if (is_new) entry->second = add({.op = op, .operands = {a, b, no_node}});
    return entry->second;
}

Mask Nodes::logical_not(Mask a) {
    if (a == yes) return no;
    if (a == no) return yes;
    return (*this)[a].op == TapeOp::logical_not ? (*this)[a].operands[0] : logic(TapeOp::logical_not, a);
}

Mask Nodes::logical_and(Mask a, Mask b) {
    if (a == no || b == no) return no;
    if (a == yes || a == b) return b;
    if (b == yes) return a;
    if (logical_not(a) == b) return no;
    return logic(TapeOp::logical_and, a, b);
}

Mask Nodes::logical_or(Mask a, Mask b) {
    if (a == yes || b == yes) return yes;
    if (a == no || a == b) return b;
    if (b == no) return a;
    if (logical_not(a) == b) return yes;
    // a or (not a and c) is a or c.
    const auto without_known = [&](Mask x, Mask y) {
        const ProgramNode n = (*this)[y];
        if (n.op != TapeOp::logical_and) return y;
        if (n.operands[0] == logical_not(x)) return n.operands[1];
        if (n.operands[1] == logical_not(x)) return n.operands[0];
        return y;
    };
    b = without_known(a, b);
    a = without_known(b, a);
    return a == b ? a : logic(TapeOp::logical_or, a, b);
}

Mask Nodes::select_mask(Mask when, Mask a, Mask b) {
    if (when == yes || a == b) return a;
    if (when == no) return b;
    if (a == yes) return logical_or(when, b);
    if (a == no) return logical_and(logical_not(when), b);
    if (b == yes) return logical_or(logical_not(when), a);
    if (b == no) return logical_and(when, a);
    return logical_or(logical_and(when, a), logical_and(logical_not(when), b));
}

void Nodes::name_node(NodeId i, const std::string& label, int depth) {
    ProgramNode& n = nodes_[i];
    if (!is_operation(n.op) || n.op == TapeOp::convert) return;
    if (!n.label.empty() && depth >= n.label_depth) return;
    n.label = label;
    n.label_depth = depth;
}

std::vector<double> Nodes::constants_of(NodeId x, bool& has_others) const {
    constexpr std::size_t max_visited = 2000;
    std::vector<double> constants;
    std::vector<NodeId> todo{x}, visited;
    while (!todo.empty()) {
        const NodeId i = todo.back();
        todo.pop_back();
        if (std::ranges::find(visited, i) != visited.end()) continue;
        visited.push_back(i);

        const ProgramNode& n = (*this)[i];
        if (n.op == TapeOp::select) todo.insert(todo.end(), {n.operands[1], n.operands[2]});
        else if (n.op == TapeOp::convert) todo.push_back(n.operands[0]);
        else if (n.op == TapeOp::constant) constants.push_back(n.value);
        else has_others = true;
        if (visited.size() > max_visited) {
            has_others = true;
            break;
        }
    }
    return constants;
}

Nodes::FormulaWithPlaces Nodes::to_formula(Mask hit, NodeId t, NodeId near, NodeId far) const {
    const std::vector<bool> is_needed = find_needed({hit, t, near, far});
    FormulaWithPlaces result;
    std::vector<NodeId>& operation_of = result.operation_of;
    operation_of.assign(nodes_.size(), no_node);
    auto& out = result.formula.operations;
    const auto append = [&](table::WrittenOperation w, int place_index) {
        out.push_back(std::move(w));
        result.places.push_back(place_index);
        return static_cast<NodeId>(out.size() - 1);
    };

    // Copies the operations, with the new indices of their operands. NaN is written as 0/0.
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        if (!is_needed[i]) continue;
        const ProgramNode& n = nodes_[i];
        if (n.op == TapeOp::constant && std::isnan(n.value)) {
            const NodeId zero = append({.op = TapeOp::constant, .wide = n.wide}, n.place);
            operation_of[i] = append({.op = TapeOp::div, .operands = {zero, zero, no_node}, .wide = n.wide}, n.place);
            continue;
        }
        table::WrittenOperation w{.op = n.op, .value = n.value, .label = n.label, .wide = n.wide};
        if (n.op == TapeOp::input) w.operands = n.operands;
        else if (n.op != TapeOp::constant)
            for (std::size_t k = 0; k < row_of(n.op).operand_count; ++k) w.operands[k] = operation_of[n.operands[k]];
        operation_of[i] = append(std::move(w), n.place);
    }

    // A known decision is a comparison of 0 with 0.
    const auto decision = [&](Mask m) {
        if (m >= 0) return operation_of[m];
        const NodeId zero = append({.op = TapeOp::constant}, -1);
        return append({.op = m == yes ? TapeOp::less_equal : TapeOp::less, .operands = {zero, zero, no_node}}, -1);
    };
    const auto answer = [&](NodeId i) { return i == no_node ? no_node : operation_of[i]; };
    result.formula.hit = decision(hit);
    result.formula.t = answer(t);
    result.formula.near = answer(near);
    result.formula.far = answer(far);
    return result;
}

/// Finds the operations on which the outputs depend.
std::vector<bool> Nodes::find_needed(std::initializer_list<NodeId> outputs) const {
    std::vector<bool> is_needed(nodes_.size());
    for (const NodeId i : outputs)
        if (i >= 0) is_needed[i] = true;
    for (std::size_t i = nodes_.size(); i-- > 0;) {
        if (!is_needed[i] || is_given(nodes_[i].op)) continue;
        for (std::size_t k = 0; k < row_of(nodes_[i].op).operand_count; ++k) is_needed[nodes_[i].operands[k]] = true;
    }
    return is_needed;
}

}  // namespace lostbits::intersect::function
