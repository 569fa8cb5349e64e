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
    explicit Contraction(const Tape& tape) : source_(tape), first_equal_(tape.nodes.size()), users_(tape.nodes.size()) {
        for (NodeId i = 0; i < tape.size(); ++i) first_equal_[i] = find_first_equal(i);
        find_users();
        for (const NodeId i : source_order())
            if (tape[i].op == TapeOp::mul) fuse(i);
    }

    Tape contract() {
        new_nodes_.assign(source_.nodes.size(), no_node);
        for (NodeId i = 0; i < source_.size(); ++i) {
            const bool is_needed = source_[i].op == TapeOp::input || !users_[i].empty() || is_answer(i);
            if (first_equal(i) == i && is_needed && !removed_nodes_.contains(i)) new_nodes_[i] = copy_node(i);
        }
        const auto [hit, t, near, far] = source_.outputs;
        result_.outputs = {new_node(hit), new_node(t), new_node(near), new_node(far)};
        return std::move(result_);
    }

    /// The node of the source tape from which `contracted_node` of the contracted tape was made.
    [[nodiscard]] NodeId source_of(NodeId contracted_node) const {
        const auto found = std::ranges::find(new_nodes_, contracted_node);
        return found == new_nodes_.end() ? no_node : static_cast<NodeId>(found - new_nodes_.begin());
    }

private:
    /// A sum that has a product as one operand, with the signs of the product and of the other operand.
    struct FusedSum {
        NodeId product, addend;
        bool negates_product, negates_addend;
    };

    [[nodiscard]] NodeId first_equal(NodeId i) const { return i == no_node ? no_node : first_equal_[i]; }
    [[nodiscard]] bool is_answer(NodeId i) const {
        const auto [hit, t, near, far] = source_.outputs;
        return std::ranges::any_of(std::array{hit, t, near, far}, [&](NodeId out) { return first_equal(out) == i; });
    }

    /// Returns the first node that is equal to node i: the same operation on the same operands, in either order if the
    /// operation is commutative.
    NodeId find_first_equal(NodeId i) {
        const TapeNode& n = source_[i];
        std::array<NodeId, 3> operands = n.operands;
        if (!is_given(n.op))
            for (NodeId& operand : operands) operand = first_equal(operand);
        if (n.op == TapeOp::add || n.op == TapeOp::mul) {
            if (operands[1] < operands[0]) std::swap(operands[0], operands[1]);
        }
        const double given_value = is_given(n.op) ? n.value : 0;
        return first_equal_node_.try_emplace({n.op, n.format, operands, std::bit_cast<std::uint64_t>(given_value)}, i)
            .first->second;
    }

    /// Lists the users of each operation (the operations that have it as an operand, once for each such operand), from
    /// the answers backwards.
    void find_users() {
        std::vector<bool> needed(source_.nodes.size());
        const auto [hit, t, near, far] = source_.outputs;
        for (const NodeId out : {hit, t, near, far})
            if (out != no_node) needed[first_equal(out)] = true;
        for (NodeId i = source_.size() - 1; i >= 0; --i) {
            if (!needed[i] || is_given(source_[i].op)) continue;
            for (const NodeId operand : source_[i].operands) {
                if (operand == no_node) continue;
                needed[first_equal(operand)] = true;
                users_[first_equal(operand)].push_back(i);
            }
        }
    }

    /// Operations that the answers need, in the order of the source text: operands from left to right, before the
    /// operation that uses them. The order on the tape may differ: the compiler that built this program may evaluate
    /// the arguments of a call from right to left.
    [[nodiscard]] std::vector<NodeId> source_order() const {
        std::vector<NodeId> order;
        std::vector<bool> seen(source_.nodes.size());
        const auto visit = [&](const auto& self, NodeId i) -> void {
            if (i == no_node || seen[i]) return;
            seen[i] = true;
            if (!is_given(source_[i].op))
                for (const NodeId operand : source_[i].operands) self(self, first_equal(operand));
            order.push_back(i);
        };
        const auto [hit, t, near, far] = source_.outputs;
        for (NodeId i = 0; i < source_.size(); ++i)
            if (first_equal(i) == i && (!users_[i].empty() || is_answer(i)) && source_[i].label.size() > 0)
                visit(visit, i);
        for (const NodeId out : {hit, t, near, far}) visit(visit, first_equal(out));
        return order;
    }

    /// Fuses `sum` with `product`; `part`, which is the product or its negative, is an operand of the sum. Returns
    /// nothing if `sum` is not a sum in the product's format, if both operands are the same, or if it is fused already.
    [[nodiscard]] std::optional<FusedSum> find_fused_sum(NodeId sum, NodeId part, NodeId product, bool negative) const {
        const TapeNode& n = source_[sum];
        if (!is_sum(n.op) || n.format != source_[product].format || fused_sums_.contains(sum)) return std::nullopt;
        const NodeId a = first_equal(n.operands[0]), b = first_equal(n.operands[1]);
        if (a == b) return std::nullopt;
        const bool subtracts = n.op == TapeOp::sub;
        if (a == part) return FusedSum{product, b, negative, subtracts};
        return FusedSum{product, a, negative != subtracts, false};
    }

    /// Fuses a product with each operation that uses it, if all of these are sums. The product itself is then removed.
    void fuse(NodeId product) {
        if (is_answer(product)) return;
        std::vector<std::pair<NodeId, FusedSum>> sums;
        std::vector<NodeId> negatives;

        // Finds the sums, behind a negation where there is one.
        for (const NodeId user : users_[product]) {
            const bool negates = source_[user].op == TapeOp::neg;
            NodeId sum = user;
            if (negates) {
                const auto& users_of_negative = users_[user];
                if (users_of_negative.size() != 1 || is_answer(user)) return;
                sum = users_of_negative.front();
                negatives.push_back(user);
            }
            const auto part = find_fused_sum(sum, user == sum ? product : user, product, negates);
            if (!part) return;
            sums.emplace_back(sum, *part);
        }
        if (sums.empty()) return;

        fused_sums_.insert(sums.begin(), sums.end());
        removed_nodes_.insert(product);
        removed_nodes_.insert(negatives.begin(), negatives.end());
    }

    [[nodiscard]] NodeId new_node(NodeId i) const { return i == no_node ? no_node : new_nodes_[first_equal(i)]; }

    NodeId copy_node(NodeId i) {
        const TapeNode& n = source_[i];
        const FloatFormat& format = source_.format_of(i);
        if (n.op == TapeOp::input) return result_.add_input(format, n.value);
        if (const auto fused = fused_sums_.find(i); fused != fused_sums_.end()) return add_fused_sum(i, fused->second);
        std::array<NodeId, 3> operands = n.operands;
        if (!is_given(n.op))
            for (NodeId& operand : operands) operand = new_node(operand);
        const NodeId copy = result_.add(n.op, format, n.value, {operands[0], operands[1], operands[2]});
        result_[copy].label = n.label;
        return copy;
    }
    NodeId add_fused_sum(NodeId i, const FusedSum& fused) {
        const FloatFormat& format = source_.format_of(i);
        const TapeNode& product = source_[fused.product];
        const auto signed_part = [&](NodeId part, bool negative) {
            const NodeId node = new_node(part);
            return negative ? result_.add(TapeOp::neg, format, -source_[part].value, {node}) : node;
        };
        const NodeId first = signed_part(product.operands[0], fused.negates_product);
        const NodeId second = new_node(product.operands[1]), addend = signed_part(fused.addend, fused.negates_addend);
        const NodeId sum = result_.add(TapeOp::fma, format, source_[i].value, {first, second, addend});
        result_[sum].label = source_[i].label.empty() ? product.label : source_[i].label;
        return sum;
    }

    const Tape& source_;
    std::map<std::tuple<TapeOp, std::uint8_t, std::array<NodeId, 3>, std::uint64_t>, NodeId> first_equal_node_;
    std::vector<NodeId> first_equal_;
    std::vector<std::vector<NodeId>> users_;
    std::map<NodeId, FusedSum> fused_sums_;  ///< indexed by the node of the sum
    /// Products that are fused with all their sums, and the negatives of these products.
    std::set<NodeId> removed_nodes_;
    std::vector<NodeId> new_nodes_;
    Tape result_;
};

/// A contracted form: tapes for f32 and f64, and lists of operations for all other formats.
struct ContractedForm {
    std::unique_ptr<TapeForm> tape32, tape64;
    std::unique_ptr<WrittenForm> written;

    ContractedForm(const Intersector& form, const std::string& name) {
        std::array<std::shared_ptr<const WrittenFormula>, 2> lists;
        const auto make = [&](const Format& format, std::unique_ptr<TapeForm>& tape_form, auto& list) {
            if (!form.exists_in(format)) return;
            const Tape tape = contract_tape(record_tape(form, format));
            tape_form = std::make_unique<TapeForm>(form, format, tape, name, std::string(form.info->title));
            list = std::make_shared<const WrittenFormula>(intersect::table::formula_from_tape(tape, form.shape, name));
        };
        make(*find_format("f32"), tape32, lists[0]);
        make(*find_format("f64"), tape64, lists[1]);
        if (lists[0] != nullptr || lists[1] != nullptr) written = std::make_unique<WrittenForm>(lists[0], lists[1]);
    }
};

using ContractedForms = intersect::table::ComposedForms<std::tuple<const Intersector*>>;
ContractedForms& contracted_forms() {
    static ContractedForms composed_forms;
    return composed_forms;
}

void fill_contracted_form(ContractedForms::ComposedForm& composed) {
    static std::deque<ContractedForm> contractions;  // forms point to its elements
    const Intersector& form = *std::get<0>(composed.parts);
    composed.name = std::string(form.info->name) + std::string(contracted_suffix);
    composed.title = std::string(form.info->title) + "; each added product is rounded together with its sum";
    composed.source = form.info->source;
    composed.copy_contract(*form.info);
    const ContractedForm& contraction = contractions.emplace_back(form, composed.name);
    composed.intersector = {.info = &composed.info, .shape = form.shape, .native32 = nullptr, .native64 = nullptr};
    if (contraction.written) contraction.written->fill(composed.intersector);
    if (!form.rounded) composed.intersector.rounded = nullptr;
    if (contraction.tape32) composed.intersector.native32 = contraction.tape32->form().native32;
    if (contraction.tape64) composed.intersector.native64 = contraction.tape64->form().native64;
}

}  // namespace

Tape contract_tape(const Tape& tape) { return Contraction(tape).contract(); }

const Intersector& contract_form(const Intersector& form) {
    if (form.has_transform_method)
        throw InputError(std::string(form.info->name) + std::string(contracted_suffix) +
                         ": the suffix of the contraction comes before that of the transform; write FORM" +
                         std::string(contracted_suffix) + "@TRANSFORM");
    if (is_contracted(form)) throw InputError(std::string(form.info->name) + ": it is contracted already");
    try {
        if (!has_tape(form)) static_cast<void>(record_tape(form, *find_format("f32")));  // throws the reason
    } catch (const InputError& reason) {
        throw InputError(fmt::format("{}{}: its operations cannot be contracted: {}", form.info->name,
                                     contracted_suffix, reason.what()));
    }
    return contracted_forms().find_or_add({&form}, fill_contracted_form);
}

bool is_contracted(const Intersector& form) { return std::get<0>(contracted_forms().find_parts(form)) != nullptr; }

FormOperation find_operation_before_contraction(const Intersector& contracted, const Format& format, NodeId node) {
    const Intersector& form = *std::get<0>(contracted_forms().find_parts(contracted));
    const Format f32 = *find_format("f32"), f64 = *find_format("f64");
    const bool is_from_f64 = !form.exists_in(f32) || (format.engine == Format::Engine::native64 && form.exists_in(f64));
    const Format& tape_format = is_from_f64 ? f64 : f32;
    const Tape tape = record_tape(form, tape_format);
    Contraction contraction(tape);
    const auto list = std::make_shared<const WrittenFormula>(
        intersect::table::formula_from_tape(contraction.contract(), form.shape, std::string(contracted.info->name)));
    const std::vector<NodeId> nodes = WrittenForm(list, nullptr).find_nodes_on_tape(format);
    const auto found = std::ranges::find(nodes, node);
    const bool is_found = node != no_node && found != nodes.end();
    return {&form, tape_format, is_found ? contraction.source_of(static_cast<NodeId>(found - nodes.begin())) : no_node};
}

}  // namespace lostbits::measure::tape
