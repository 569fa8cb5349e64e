#include "intersect/function/nodes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

constexpr std::size_t most_nodes = 200'000;

bool compared(TapeOp op, double a, double b) {
    switch (op) {
        case TapeOp::less: return a < b;
        case TapeOp::less_equal: return a <= b;
        case TapeOp::greater: return a > b;
        default: return a >= b;
    }
}

}  // namespace

NodeId Nodes::add(ProgramNode node) {
    if (all_.size() >= most_nodes)
        throw NotFollowed("the function has more than " + std::to_string(most_nodes) + " operations on one ray");
    if (node.place < 0) node.place = place;
    all_.push_back(std::move(node));
    return static_cast<NodeId>(all_.size() - 1);
}

NodeId Nodes::input(int number) {
    const auto [known, is_new] = known_.try_emplace({TapeOp::input, number, no_node, 0, false}, 0);
    if (is_new) known->second = add({.op = TapeOp::input, .operands = {number, no_node, no_node}});
    return known->second;
}

NodeId Nodes::constant(double value, bool wide) {
    const auto [known, is_new] =
        known_.try_emplace({TapeOp::constant, no_node, no_node, std::bit_cast<std::uint64_t>(value), wide}, 0);
    if (is_new) known->second = add({.wide = wide, .value = value});
    return known->second;
}

bool Nodes::fits(double x) const {
    return bits_ == 64 || std::isnan(x) || static_cast<double>(static_cast<float>(x)) == x;
}

std::optional<NodeId> Nodes::narrowed(NodeId x) {
    const ProgramNode& n = (*this)[x];
    if (!n.wide) return {};
    if (n.op == TapeOp::convert) return n.operands[0];
    if (n.op == TapeOp::constant && fits(n.value)) return constant(n.value, false);
    return {};
}

NodeId Nodes::widen(NodeId x) {
    if (bits_ == 64) return x;
    if ((*this)[x].op == TapeOp::constant) return constant((*this)[x].value, true);
    const auto [known, is_new] = known_.try_emplace({TapeOp::convert, x, no_node, 0, true}, 0);
    if (is_new) known->second = add({.op = TapeOp::convert, .wide = true, .operands = {x, no_node, no_node}});
    return known->second;
}

/// Rounds a double to the function's format. An operation on converted numbers is instead done in that format. That
/// gives the same number: binary64 has more than twice the digits of binary32 and two more (S. A. Figueroa, When is
/// double rounding innocuous?, 1995).
NodeId Nodes::narrow(NodeId x) {
    if (const auto exact = narrowed(x)) return *exact;
    const ProgramNode n = (*this)[x];
    if (n.op == TapeOp::constant) return constant(static_cast<double>(static_cast<float>(n.value)), false);
    const bool rounds_once = n.op == TapeOp::add || n.op == TapeOp::sub || n.op == TapeOp::mul || n.op == TapeOp::div ||
                             n.op == TapeOp::sqrt;
    if (rounds_once) {
        std::array<NodeId, 3> operands{no_node, no_node, no_node};
        bool all = true;
        for (std::size_t k = 0; k < row_of(n.op).operands; ++k) {
            const auto exact = narrowed(n.operands[k]);
            all = all && exact.has_value();
            operands[k] = exact.value_or(no_node);
        }
        if (all) return add({.op = n.op, .operands = operands, .place = n.place});
    }
    return add({.op = TapeOp::convert, .operands = {x, no_node, no_node}});
}

NodeId Nodes::number(TapeOp op, NodeId a, NodeId b, NodeId c) {
    const std::array<NodeId, 3> operands{a, b, c};
    const std::size_t count = row_of(op).operands;
    const bool wide = (*this)[a].wide;
    const bool is_exact =
        op == TapeOp::neg || op == TapeOp::abs || op == TapeOp::copysign || op == TapeOp::min || op == TapeOp::max;
    if (wide && is_exact) {
        std::array<NodeId, 3> narrow{no_node, no_node, no_node};
        bool all = true;
        for (std::size_t k = 0; k < count; ++k) {
            const auto exact = narrowed(operands[k]);
            all = all && exact.has_value();
            narrow[k] = exact.value_or(no_node);
        }
        if (all) return widen(number(op, narrow[0], narrow[1], narrow[2]));
    }
    const auto known = [&](NodeId i) { return i == no_node || (*this)[i].op == TapeOp::constant; };
    if (known(a) && known(b) && known(c)) {
        const double x = (*this)[a].value, y = b == no_node ? 0 : (*this)[b].value;
        if (op == TapeOp::neg) return constant(-x, wide);
        if (op == TapeOp::abs) return constant(std::fabs(x), wide);
        // Computes sums and products of known numbers if they are exact, such as those of a counter.
        if (op == TapeOp::add || op == TapeOp::sub || op == TapeOp::mul) {
            const double z = op == TapeOp::sub ? -y : y;
            const double r = op == TapeOp::mul ? x * y : x + z;
            const double back = r - z;
            const bool exact = op == TapeOp::mul ? std::fma(x, y, -r) == 0 : (x - back) + (z - (r - back)) == 0;
            if (exact && std::isfinite(r) && (wide || fits(r)) && (r == 0 || std::fabs(r) > 1e-30))
                return constant(r, wide);
        }
    }
    return add({.op = op, .wide = wide, .operands = operands});
}

NodeId Nodes::select(Mask when, NodeId a, NodeId b) {
    if (when == yes || a == b) return a;
    if (when == no) return b;
    if ((*this)[when].op == TapeOp::opposite) return select((*this)[when].operands[0], b, a);
    // A choice inside a choice by the same decision is already made.
    const auto made = [&](NodeId side, std::size_t k) {
        const ProgramNode& n = (*this)[side];
        return n.op == TapeOp::select && n.operands[0] == when ? n.operands[k] : side;
    };
    a = made(a, 1), b = made(b, 2);
    if (a == b) return a;
    if ((*this)[a].wide) {
        const auto x = narrowed(a), y = narrowed(b);
        if (x && y) return widen(select(when, *x, *y));
    }
    return add({.op = TapeOp::select, .wide = (*this)[a].wide, .operands = {when, a, b}});
}

NodeId Nodes::least(TapeOp op, NodeId a, NodeId b) {
    const TapeOp first = op == TapeOp::min ? TapeOp::less : TapeOp::greater;
    // x86 evaluates b < a and keeps a if they are equal.
    return select(either(compare(first, b, a), is_nan(a)), b, a);
}

/// Takes from |x| each power of two that fits, the largest first. Every sum is the number that the first digits of |x|
/// make, so that it is exact in every format, and the decisions are right without rounding, too. A number of p digits
/// from 2^(p-1) on is whole.
NodeId Nodes::whole(WholeNumber which, NodeId x) {
    const bool wide = (*this)[x].wide;
    const int digits = bits_ == 64 || wide ? 53 : 24;
    const auto known = [&](double c) { return constant(c, wide); };
    const NodeId size = number(TapeOp::abs, x);
    NodeId sum = known(0);
    Mask is_odd = no;
    for (int e = digits - 2; e >= 0; --e) {
        const NodeId more = number(TapeOp::add, sum, known(std::ldexp(1.0, e)));
        is_odd = compare(TapeOp::less_equal, more, size);
        sum = select(is_odd, more, sum);
    }
    const NodeId cut = number(TapeOp::copysign, sum, x), rest = number(TapeOp::sub, size, sum);
    const auto at_half = [&](TapeOp op) { return compare(op, rest, known(0.5)); };
    const auto moved = [&](Mask when, TapeOp op) { return select(when, number(op, cut, known(1)), cut); };
    NodeId found = cut;
    switch (which) {
        case WholeNumber::towards_zero: break;
        case WholeNumber::below: found = moved(compare(TapeOp::less, x, cut), TapeOp::sub); break;
        case WholeNumber::above: found = moved(compare(TapeOp::less, cut, x), TapeOp::add); break;
        default: {
            const Mask away = which == WholeNumber::nearest_or_away
                                  ? at_half(TapeOp::greater_equal)
                                  : either(at_half(TapeOp::greater), both(at_half(TapeOp::greater_equal), is_odd));
            found = select(away, number(TapeOp::copysign, number(TapeOp::add, sum, known(1)), x), cut);
        }
    }
    return select(compare(TapeOp::less, size, known(std::ldexp(1.0, digits - 1))), found, x);
}

Mask Nodes::compare(TapeOp op, NodeId a, NodeId b) {
    // Compares each constant that a choice may give by itself: t < 0, for example, if t is −1 for a miss.
    const auto resolve = [&](NodeId x, NodeId y, bool turned) -> std::optional<Mask> {
        bool others = false;
        const ProgramNode chosen = (*this)[x];
        if (chosen.op != TapeOp::select || (*this)[y].op != TapeOp::constant) return {};
        if (constants_of(x, others).empty()) return {};
        const auto side = [&](NodeId s) { return turned ? compare(op, y, s) : compare(op, s, y); };
        const Mask left = side(chosen.operands[1]);
        return choose(chosen.operands[0], left, side(chosen.operands[2]));
    };
    const std::tuple key{op, a, b, std::uint64_t{0}, false};
    if (const auto before = known_.find(key); before != known_.end()) return before->second;
    if (const auto found = resolve(a, b, false)) return known_[key] = *found;
    if (const auto found = resolve(b, a, true)) return known_[key] = *found;
    const ProgramNode x = (*this)[a], y = (*this)[b];
    if (x.op == TapeOp::constant && y.op == TapeOp::constant) return compared(op, x.value, y.value) ? yes : no;
    if ((x.op == TapeOp::constant && std::isnan(x.value)) || (y.op == TapeOp::constant && std::isnan(y.value)))
        return no;
    if (x.wide) {
        auto left = narrowed(a), right = narrowed(b);
        // A converted number is compared with a constant between two numbers of its format. The neighbour on the right
        // side gives the same decision.
        const auto beside = [&](double c, bool up) {
            float f = static_cast<float>(c);
            if (up && f < c) f = std::nextafterf(f, std::numeric_limits<float>::infinity());
            if (!up && f > c) f = std::nextafterf(f, -std::numeric_limits<float>::infinity());
            return constant(f, false);
        };
        if (left && !right && y.op == TapeOp::constant)
            right = beside(y.value, op == TapeOp::less || op == TapeOp::greater_equal);
        else if (right && !left && x.op == TapeOp::constant)
            left = beside(x.value, op == TapeOp::greater || op == TapeOp::less_equal);
        if (left && right) return compare(op, *left, *right);
    }
    return known_[key] = add({.op = op, .operands = {a, b, no_node}});
}

Mask Nodes::logic(TapeOp op, Mask a, Mask b) {
    const auto [known, is_new] = known_.try_emplace({op, a, b, 0, false}, 0);
    if (is_new) known->second = add({.op = op, .operands = {a, b, no_node}});
    return known->second;
}

Mask Nodes::opposite(Mask a) {
    if (a == yes) return no;
    if (a == no) return yes;
    return (*this)[a].op == TapeOp::opposite ? (*this)[a].operands[0] : logic(TapeOp::opposite, a);
}

Mask Nodes::both(Mask a, Mask b) {
    if (a == no || b == no) return no;
    if (a == yes || a == b) return b;
    if (b == yes) return a;
    if (opposite(a) == b) return no;
    return logic(TapeOp::both, a, b);
}

Mask Nodes::either(Mask a, Mask b) {
    if (a == yes || b == yes) return yes;
    if (a == no || a == b) return b;
    if (b == no) return a;
    if (opposite(a) == b) return yes;
    // a or (not a and c) is a or c.
    const auto without = [&](Mask x, Mask y) {
        const ProgramNode n = (*this)[y];
        if (n.op != TapeOp::both) return y;
        if (n.operands[0] == opposite(x)) return n.operands[1];
        if (n.operands[1] == opposite(x)) return n.operands[0];
        return y;
    };
    b = without(a, b), a = without(b, a);
    return a == b ? a : logic(TapeOp::either, a, b);
}

Mask Nodes::choose(Mask when, Mask a, Mask b) {
    if (when == yes || a == b) return a;
    if (when == no) return b;
    if (a == yes) return either(when, b);
    if (a == no) return both(opposite(when), b);
    if (b == yes) return either(opposite(when), a);
    if (b == no) return both(when, a);
    return either(both(when, a), both(opposite(when), b));
}

void Nodes::name(NodeId i, const std::string& label, int depth) {
    ProgramNode& n = all_[static_cast<std::size_t>(i)];
    if (!is_operation(n.op) || n.op == TapeOp::convert) return;
    if (!n.label.empty() && depth >= n.label_depth) return;
    n.label = label;
    n.label_depth = depth;
}

std::vector<double> Nodes::constants_of(NodeId x, bool& others) const {
    std::vector<double> found;
    std::vector<NodeId> todo{x}, seen;
    while (!todo.empty()) {
        const NodeId i = todo.back();
        todo.pop_back();
        if (std::ranges::find(seen, i) != seen.end()) continue;
        seen.push_back(i);
        const ProgramNode& n = (*this)[i];
        if (n.op == TapeOp::select) todo.push_back(n.operands[1]), todo.push_back(n.operands[2]);
        else if (n.op == TapeOp::convert) todo.push_back(n.operands[0]);
        else if (n.op == TapeOp::constant) found.push_back(n.value);
        else others = true;
        if (seen.size() > 2000) {
            others = true;
            break;
        }
    }
    return found;
}

Nodes::Written Nodes::written(Mask hit, NodeId t, NodeId near, NodeId far) const {
    std::vector<bool> live(all_.size());
    for (const NodeId i : {hit, t, near, far})
        if (i >= 0) live[static_cast<std::size_t>(i)] = true;
    for (std::size_t i = all_.size(); i-- > 0;) {
        if (!live[i] || is_given(all_[i].op)) continue;
        for (std::size_t k = 0; k < row_of(all_[i].op).operands; ++k)
            live[static_cast<std::size_t>(all_[i].operands[k])] = true;
    }
    Written made;
    std::vector<NodeId>& moved = made.operation_of;
    moved.assign(all_.size(), no_node);
    auto& out = made.formula.operations;
    const auto put = [&](table::WrittenOperation w, int at) {
        out.push_back(std::move(w));
        made.places.push_back(at);
        return static_cast<NodeId>(out.size() - 1);
    };
    for (std::size_t i = 0; i < all_.size(); ++i) {
        if (!live[i]) continue;
        const ProgramNode& n = all_[i];
        if (n.op == TapeOp::constant && std::isnan(n.value)) {  // 0/0
            const NodeId zero = put({.op = TapeOp::constant, .wide = n.wide}, n.place);
            moved[i] = put({.op = TapeOp::div, .operands = {zero, zero, no_node}, .wide = n.wide}, n.place);
            continue;
        }
        table::WrittenOperation w{.op = n.op, .value = n.value, .label = n.label, .wide = n.wide};
        if (n.op == TapeOp::input) w.operands = n.operands;
        else if (n.op != TapeOp::constant)
            for (std::size_t k = 0; k < row_of(n.op).operands; ++k)
                w.operands[k] = moved[static_cast<std::size_t>(n.operands[k])];
        moved[i] = put(std::move(w), n.place);
    }
    const auto decision = [&](Mask m) {
        if (m >= 0) return moved[static_cast<std::size_t>(m)];
        const NodeId zero = put({.op = TapeOp::constant}, -1);
        return put({.op = m == yes ? TapeOp::less_equal : TapeOp::less, .operands = {zero, zero, no_node}}, -1);
    };
    made.formula.hit = decision(hit);
    const auto answer = [&](NodeId i) { return i == no_node ? no_node : moved[static_cast<std::size_t>(i)]; };
    made.formula.t = answer(t), made.formula.near = answer(near), made.formula.far = answer(far);
    return made;
}

}  // namespace lostbits::intersect::function
