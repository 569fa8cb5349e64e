#include "measure/tape/tape_form.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "intersect/bounding_box/behind.hpp"
#include "number/error.hpp"

namespace lostbits::measure::tape {

using intersect::table::Intersector;

namespace {

/// Copies a tape node by node, with some operations in a wider format. `copied` chooses the format of each node.
class Widening {
public:
    Widening(const Tape& from, const std::vector<NodeId>& operations, const FloatFormat& to)
        : from_(from), to_(to), wide_(from.nodes.size()), place_(from.nodes.size(), no_node) {
        for (const NodeId i : operations) wide_[static_cast<std::size_t>(i)] = true;
    }

    Tape made() {
        for (NodeId i = 0; i < from_.size(); ++i) place_[static_cast<std::size_t>(i)] = copied(i);
        const auto answer = [&](NodeId i) { return taken_in(i, from_.format_of(i)); };
        const auto [hit, t, near, far] = from_.outputs;
        made_.outputs = {at(hit), answer(t), answer(near), answer(far)};
        return std::move(made_);
    }

private:
    [[nodiscard]] NodeId at(NodeId i) const { return i == no_node ? no_node : place_[static_cast<std::size_t>(i)]; }

    /// Result of node i, converted to a format where it has another one.
    NodeId taken_in(NodeId i, const FloatFormat& format) {
        const NodeId here = at(i);
        const TapeNode n = made_[here];
        if (made_.format_of(here) == format) return here;
        const auto [known, is_new] = converted_.try_emplace({here, format.precision}, no_node);
        if (!is_new) return known->second;
        const bool is_whole = n.op == TapeOp::constant && n.value == n.operands[0];
        return known->second = is_whole ? made_.add(TapeOp::constant, format, n.value, {n.operands[0]})
                                        : made_.add(TapeOp::convert, format, n.value, {here});
    }

    /// The widest format of the operands that are numbers.
    [[nodiscard]] FloatFormat widest(const TapeNode& n) const {
        FloatFormat found{};
        for (const NodeId operand : n.operands) {
            if (operand == no_node || is_decision(from_[operand].op)) continue;
            const FloatFormat& f = made_.format_of(at(operand));
            if (f.precision > found.precision) found = f;
        }
        return found;
    }

    NodeId copied(NodeId i) {
        const TapeNode& n = from_[i];
        const FloatFormat& own = from_.format_of(i);
        if (is_given(n.op)) return put(n, own, n.operands);
        if (n.op == TapeOp::convert) return taken_in(n.operands[0], own);
        const bool logic = kind_of(n.op) == OperationKind::logic;
        const FloatFormat format = kind_of(n.op) == OperationKind::rounded
                                       ? wide_[static_cast<std::size_t>(i)] ? to_ : own
                                   : logic ? own
                                           : widest(n);
        std::array<NodeId, 3> operands{no_node, no_node, no_node};
        for (std::size_t k = 0; k < 3; ++k) {
            const NodeId operand = n.operands[k];
            if (operand == no_node) continue;
            operands[k] = is_decision(from_[operand].op) ? at(operand) : taken_in(operand, format);
        }
        return put(n, is_decision(n.op) ? own : format, operands);
    }

    NodeId put(const TapeNode& n, const FloatFormat& format, const std::array<NodeId, 3>& operands) {
        const NodeId made = n.op == TapeOp::input
                                ? made_.add_input(format, n.value)
                                : made_.add(n.op, format, n.value, {operands[0], operands[1], operands[2]});
        made_[made].label = n.label;
        return made;
    }

    const Tape& from_;
    FloatFormat to_;
    std::vector<bool> wide_;
    std::vector<NodeId> place_;
    std::map<std::pair<NodeId, int>, NodeId> converted_;
    Tape made_;
};

template <class S>
void run_program(void* own, const intersect::table::RayBatch<S>& rays, const intersect::Target<S>& target,
                 const intersect::table::HitBatch<S>& hits) {
    static_cast<const TapeProgram*>(own)->run<S>(rays, target, hits);
}

}  // namespace

namespace {

/// Reason why no tape can have all operations of a form; empty where one can.
std::string refusal_of_tape(const Intersector& form) {
    if (!is_primitive(form.shape))
        return "it marches, so its operations differ from ray to ray; name a form of a primitive";
    if (form.is_set()) return "it stands for several forms; name one of them";
    if (intersect::bounding_box::innermost(form).filter_arithmetic)
        return "it filters: it uses more precision where a ray needs it, so its operations differ from ray to ray; "
               "name a form that does the same operations for every ray";
    if (intersect::bounding_box::has_box(form))
        return "name the form without its box, such as " +
               std::string(intersect::bounding_box::innermost(form).info->name);
    if (!form.record)
        return "its operations are not known, since it is compiled elsewhere; write it as a form over any number to "
               "see them (docs/your-own-form.md)";
    return {};
}

}  // namespace

bool has_tape(const Intersector& form) { return refusal_of_tape(form).empty(); }

Tape tape_of(const Intersector& form, const Format& format, bool from_inverse) {
    if (const std::string why = refusal_of_tape(form); !why.empty())
        throw InputError(std::string(form.info->name) + ": " + why);
    const Ray<double> any{Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)};
    Primitive<double> primitive(form.shape);
    for (std::size_t k = 0; k < primitive.used().size(); ++k) primitive.numbers[k] = static_cast<double>(k + 1);
    if (form.is_placed) primitive.placed = {{2, 0, 0, 1, 0, 2, 0, 1, 0, 0, 2, 1}, from_inverse};
    Tape tape;
    tape.every_loop = true;
    form.record(format, any, intersect::Target<double>(primitive), HUGE_VAL, tape);
    return tape;
}

std::vector<double> inputs_of(const Ray<double>& ray, const Primitive<double>& primitive, double tmax) {
    const auto &o = ray.origin, &d = ray.direction;
    std::vector<double> all{o.x, o.y, o.z, d.x, d.y, d.z};
    const auto used = primitive.used();
    all.insert(all.end(), used.begin(), used.end());
    if (primitive.placed) all.insert(all.end(), primitive.placed->matrix.begin(), primitive.placed->matrix.end());
    all.push_back(tmax);
    return all;
}

Ray<double> ray_of(const std::vector<double>& inputs) {
    return {{inputs[0], inputs[1], inputs[2]}, {inputs[3], inputs[4], inputs[5]}};
}

Primitive<double> primitive_of(const std::vector<double>& inputs, const Primitive<double>& like) {
    Primitive<double> primitive = like;
    auto next = inputs.begin() + 6;
    for (double& x : primitive.used()) x = *next++;
    if (primitive.placed)
        for (double& x : primitive.placed->matrix) x = *next++;
    return primitive;
}

std::vector<NodeId> rounded_operations(const Tape& tape) {
    std::vector<bool> needed(tape.nodes.size());
    for (const NodeId out : {tape.outputs.hit, tape.outputs.t, tape.outputs.near, tape.outputs.far})
        needed[static_cast<std::size_t>(out)] = true;
    for (NodeId i = tape.size() - 1; i >= 0; --i) {
        if (!needed[static_cast<std::size_t>(i)] || is_given(tape[i].op)) continue;
        for (const NodeId operand : tape[i].operands)
            if (operand != no_node) needed[static_cast<std::size_t>(operand)] = true;
    }
    std::vector<NodeId> found;
    for (NodeId i = 0; i < tape.size(); ++i) {
        if (needed[static_cast<std::size_t>(i)] && kind_of(tape[i].op) == OperationKind::rounded &&
            tape.format_of(i) == tape.format_of(tape.outputs.t))
            found.push_back(i);
    }
    return found;
}

Tape widened(const Tape& tape, const std::vector<NodeId>& operations, const FloatFormat& to) {
    return Widening(tape, operations, to).made();
}

FloatFormat wider_than(const FloatFormat& format, bool two_words) {
    if (format == binary64) return two_doubles;
    return two_words ? two_floats : binary64;
}

TapeForm::TapeForm(const Intersector& like, const Format& format, const Tape& tape, std::string name, std::string title)
    : program_(tape),
      name_(std::move(name)),
      title_(std::move(title)),
      info_(*like.info),
      row_{.info = &info_, .shape = like.shape, .native32 = nullptr, .native64 = nullptr, .is_placed = like.is_placed} {
    info_.name = name_;
    info_.title = title_;
    if (format.engine == Format::Engine::native32) row_.native32 = {run_program<float>, &program_};
    else row_.native64 = {run_program<double>, &program_};
}

}  // namespace lostbits::measure::tape
