#include "measure/tape/contraction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "intersect/table/composed_forms.hpp"
#include "intersect/table/written_formula.hpp"
#include "measure/tape/tape_form.hpp"
#include "number/error.hpp"
#include "scene/rays/composed_forms.hpp"

namespace lostbits::measure::tape {

using intersect::table::Intersector;
using intersect::table::WrittenForm;
using intersect::table::WrittenFormula;
using scene::rays::contracted_suffix;

namespace {

constexpr bool is_sum(TapeOp op) { return op == TapeOp::add || op == TapeOp::sub; }

class Contraction {
public:
    explicit Contraction(const Tape& tape) : from_(tape), same_(tape.nodes.size()), takers_(tape.nodes.size()) {
        for (NodeId i = 0; i < tape.size(); ++i) at(same_, i) = first_of(i);
        find_takers();
        for (const NodeId i : in_order_of_text())
            if (tape[i].op == TapeOp::mul) fuse(i);
    }

    Tape made() {
        place_.assign(from_.nodes.size(), no_node);
        for (NodeId i = 0; i < from_.size(); ++i) {
            const bool needed = from_[i].op == TapeOp::input || !at(takers_, i).empty() || is_answer(i);
            if (same(i) == i && needed && !dropped_.contains(i)) at(place_, i) = copied(i);
        }
        const auto [hit, t, near, far] = from_.outputs;
        made_.outputs = {placed(hit), placed(t), placed(near), placed(far)};
        return std::move(made_);
    }

private:
    /// Sum that has a product as one operand, with the signs of the product and of the other operand.
    struct Fused {
        NodeId product, addend;
        bool minus_product, minus_addend;
    };

    template <class T>
    static T& at(std::vector<T>& of, NodeId i) {
        return of[static_cast<std::size_t>(i)];
    }
    template <class T>
    static const T& at(const std::vector<T>& of, NodeId i) {
        return of[static_cast<std::size_t>(i)];
    }
    [[nodiscard]] NodeId same(NodeId i) const { return i == no_node ? no_node : same_[static_cast<std::size_t>(i)]; }
    [[nodiscard]] bool is_answer(NodeId i) const {
        const auto [hit, t, near, far] = from_.outputs;
        return std::ranges::any_of(std::array{hit, t, near, far}, [&](NodeId out) { return same(out) == i; });
    }

    /// First node that is equal to node i: the same operation on the same operands, in any order where the order makes
    /// no difference.
    NodeId first_of(NodeId i) {
        const TapeNode& n = from_[i];
        std::array<NodeId, 3> operands = n.operands;
        if (!is_given(n.op))
            for (NodeId& operand : operands) operand = same(operand);
        if (n.op == TapeOp::add || n.op == TapeOp::mul) {
            if (operands[1] < operands[0]) std::swap(operands[0], operands[1]);
        }
        const double given = is_given(n.op) ? n.value : 0;
        return first_.try_emplace({n.op, n.format, operands, std::bit_cast<std::uint64_t>(given)}, i).first->second;
    }

    /// Lists for each operation those that need it, once for each operand, from the answers backwards.
    void find_takers() {
        std::vector<bool> needed(from_.nodes.size());
        const auto [hit, t, near, far] = from_.outputs;
        for (const NodeId out : {hit, t, near, far})
            if (out != no_node) needed[static_cast<std::size_t>(same(out))] = true;
        for (NodeId i = from_.size() - 1; i >= 0; --i) {
            if (!needed[static_cast<std::size_t>(i)] || is_given(from_[i].op)) continue;
            for (const NodeId operand : from_[i].operands) {
                if (operand == no_node) continue;
                needed[static_cast<std::size_t>(same(operand))] = true;
                at(takers_, same(operand)).push_back(i);
            }
        }
    }

    /// Operations that the answers need, in the order of the source text: operands from left to right, before the
    /// operation that takes them. The tape may have another order: it is the one in which the compiler of this program
    /// evaluates the arguments of a call, which may be from right to left.
    [[nodiscard]] std::vector<NodeId> in_order_of_text() const {
        std::vector<NodeId> order;
        std::vector<bool> seen(from_.nodes.size());
        const auto visit = [&](const auto& again, NodeId i) -> void {
            if (i == no_node || seen[static_cast<std::size_t>(i)]) return;
            seen[static_cast<std::size_t>(i)] = true;
            if (!is_given(from_[i].op))
                for (const NodeId operand : from_[i].operands) again(again, same(operand));
            order.push_back(i);
        };
        const auto [hit, t, near, far] = from_.outputs;
        for (NodeId i = 0; i < from_.size(); ++i)
            if (same(i) == i && (!at(takers_, i).empty() || is_answer(i)) && from_[i].label.size() > 0) visit(visit, i);
        for (const NodeId out : {hit, t, near, far}) visit(visit, same(out));
        return order;
    }

    /// Part of `product`, or of its negative, in a sum; nothing where it is both operands, or the sum is fused already.
    [[nodiscard]] std::optional<Fused> part_of(NodeId sum, NodeId part, NodeId product, bool negative) const {
        const TapeNode& n = from_[sum];
        if (!is_sum(n.op) || n.format != from_[product].format || fused_.contains(sum)) return std::nullopt;
        const NodeId a = same(n.operands[0]), b = same(n.operands[1]);
        if (a == b) return std::nullopt;
        const bool subtracts = n.op == TapeOp::sub;
        if (a == part) return Fused{product, b, negative, subtracts};
        return Fused{product, a, negative != subtracts, false};
    }

    /// Fuses a product with each operation that takes it, if all of these are sums; the product itself is then dropped.
    void fuse(NodeId product) {
        if (is_answer(product)) return;
        std::vector<std::pair<NodeId, Fused>> sums;
        std::vector<NodeId> negatives;
        for (const NodeId taker : takers_[static_cast<std::size_t>(product)]) {
            const bool negates = from_[taker].op == TapeOp::neg;
            NodeId sum = taker;
            if (negates) {
                const auto& of_negative = takers_[static_cast<std::size_t>(taker)];
                if (of_negative.size() != 1 || is_answer(taker)) return;
                sum = of_negative.front();
                negatives.push_back(taker);
            }
            const auto part = part_of(sum, taker == sum ? product : taker, product, negates);
            if (!part) return;
            sums.emplace_back(sum, *part);
        }
        if (sums.empty()) return;
        fused_.insert(sums.begin(), sums.end());
        dropped_.insert(product);
        dropped_.insert(negatives.begin(), negatives.end());
    }

    [[nodiscard]] NodeId placed(NodeId i) const {
        return i == no_node ? no_node : place_[static_cast<std::size_t>(same(i))];
    }

    NodeId copied(NodeId i) {
        const TapeNode& n = from_[i];
        const FloatFormat& format = from_.format_of(i);
        if (n.op == TapeOp::input) return made_.add_input(format, n.value);
        if (const auto fused = fused_.find(i); fused != fused_.end()) return fused_sum(i, fused->second);
        std::array<NodeId, 3> operands = n.operands;
        if (!is_given(n.op))
            for (NodeId& operand : operands) operand = placed(operand);
        const NodeId made = made_.add(n.op, format, n.value, {operands[0], operands[1], operands[2]});
        made_[made].label = n.label;
        return made;
    }
    NodeId fused_sum(NodeId i, const Fused& f) {
        const FloatFormat& format = from_.format_of(i);
        const TapeNode& product = from_[f.product];
        const auto signed_part = [&](NodeId part, bool negative) {
            const NodeId here = placed(part);
            return negative ? made_.add(TapeOp::neg, format, -from_[part].value, {here}) : here;
        };
        const NodeId first = signed_part(product.operands[0], f.minus_product);
        const NodeId second = placed(product.operands[1]), addend = signed_part(f.addend, f.minus_addend);
        const NodeId made = made_.add(TapeOp::fma, format, from_[i].value, {first, second, addend});
        made_[made].label = from_[i].label.empty() ? product.label : from_[i].label;
        return made;
    }

    const Tape& from_;
    std::map<std::tuple<TapeOp, std::uint8_t, std::array<NodeId, 3>, std::uint64_t>, NodeId> first_;
    std::vector<NodeId> same_;
    std::vector<std::vector<NodeId>> takers_;
    std::map<NodeId, Fused> fused_;  ///< by the sum
    std::set<NodeId> dropped_;       ///< products that all their sums are fused with, and their negatives
    std::vector<NodeId> place_;
    Tape made_;
};

/// Contracted form: tapes for f32 and f64, and lists of operations for every other arithmetic.
struct Contracted {
    std::unique_ptr<TapeForm> in32, in64;
    std::unique_ptr<WrittenForm> written;

    Contracted(const Intersector& form, const std::string& name) {
        std::array<std::shared_ptr<const WrittenFormula>, 2> lists;
        const auto make = [&](const Format& format, std::unique_ptr<TapeForm>& in, auto& list) {
            if (!form.exists_in(format)) return;
            const Tape tape = contracted(tape_of(form, format));
            in = std::make_unique<TapeForm>(form, format, tape, name, std::string(form.info->title));
            list = std::make_shared<const WrittenFormula>(intersect::table::written(tape, form.shape, name));
        };
        make(*find_format("f32"), in32, lists[0]);
        make(*find_format("f64"), in64, lists[1]);
        if (lists[0] != nullptr || lists[1] != nullptr) written = std::make_unique<WrittenForm>(lists[0], lists[1]);
    }
};

using Rows = intersect::table::ComposedForms<std::tuple<const Intersector*>>;
Rows& rows() {
    static Rows all;
    return all;
}

void fill(Rows::Made& made) {
    static std::deque<Contracted> all;  // rows point into it
    const Intersector& form = *std::get<0>(made.parts);
    made.name = std::string(form.info->name) + std::string(contracted_suffix);
    made.title = std::string(form.info->title) + "; each added product is rounded together with its sum";
    made.source = form.info->source;
    made.take_contract(*form.info);
    const Contracted& own = all.emplace_back(form, made.name);
    made.row = {.info = &made.info, .shape = form.shape, .native32 = nullptr, .native64 = nullptr};
    if (own.written) own.written->fill(made.row);
    if (!form.rounded) made.row.rounded = nullptr;
    if (own.in32) made.row.native32 = own.in32->row().native32;
    if (own.in64) made.row.native64 = own.in64->row().native64;
}

}  // namespace

Tape contracted(const Tape& tape) { return Contraction(tape).made(); }

const Intersector& contracted_row(const Intersector& form) {
    if (form.is_placed)
        throw InputError(std::string(form.info->name) + std::string(contracted_suffix) +
                         ": the suffix of the contraction comes before that of the transform; write FORM" +
                         std::string(contracted_suffix) + "@TRANSFORM");
    if (is_contracted(form)) throw InputError(std::string(form.info->name) + ": it is contracted already");
    try {
        if (!has_tape(form)) static_cast<void>(tape_of(form, *find_format("f32")));  // throws the reason
    } catch (const InputError& why) {
        throw InputError(fmt::format("{}{}: its operations cannot be contracted: {}", form.info->name,
                                     contracted_suffix, why.what()));
    }
    return rows().row_of({&form}, fill);
}

bool is_contracted(const Intersector& row) { return std::get<0>(rows().parts_of(row)) != nullptr; }

}  // namespace lostbits::measure::tape
