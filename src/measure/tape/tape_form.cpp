#include "measure/tape/tape_form.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "intersect/bounding_box/behind.hpp"
#include "number/error.hpp"

namespace lostbits::measure::tape {

using intersect::table::Intersector;

namespace {

/// Copies a tape node by node, with some operations in a wider format. `copy_node` chooses the format of each node.
class Widening {
public:
    Widening(const Tape& source, const std::vector<NodeId>& operations, const FloatFormat& wide_format)
        : source_(source),
          wide_format_(wide_format),
          is_wide_(source.nodes.size()),
          new_nodes_(source.nodes.size(), no_node) {
        for (const NodeId i : operations) is_wide_[i] = true;
    }

    Tape widen() {
        for (NodeId i = 0; i < source_.size(); ++i) new_nodes_[i] = copy_node(i);
        const auto answer = [&](NodeId i) { return convert_to(i, source_.format_of(i)); };
        const auto [hit, t, near, far] = source_.outputs;
        result_.outputs = {new_node(hit), answer(t), answer(near), answer(far)};
        return std::move(result_);
    }

private:
    [[nodiscard]] NodeId new_node(NodeId i) const { return i == no_node ? no_node : new_nodes_[i]; }

    /// Returns the new node with the result of node i in `format`, converted if necessary.
    NodeId convert_to(NodeId i, const FloatFormat& format) {
        const NodeId node = new_node(i);
        const TapeNode n = result_[node];
        if (result_.format_of(node) == format) return node;
        const auto [found, is_new] = conversions_.try_emplace({node, format.precision}, no_node);
        if (!is_new) return found->second;
        const bool is_whole = n.op == TapeOp::constant && n.value == n.operands[0];
        return found->second = is_whole ? result_.add(TapeOp::constant, format, n.value, {n.operands[0]})
                                        : result_.add(TapeOp::convert, format, n.value, {node});
    }

    /// The widest format of the operands that are numbers.
    [[nodiscard]] FloatFormat widest_operand_format(const TapeNode& node) const {
        FloatFormat widest_format{};
        for (const NodeId operand : node.operands) {
            if (operand == no_node || is_decision(source_[operand].op)) continue;
            const FloatFormat& f = result_.format_of(new_node(operand));
            if (f.precision > widest_format.precision) widest_format = f;
        }
        return widest_format;
    }

    NodeId copy_node(NodeId i) {
        const TapeNode& n = source_[i];
        const FloatFormat& source_format = source_.format_of(i);
        if (is_given(n.op)) return append_node(n, source_format, n.operands);
        if (n.op == TapeOp::convert) return convert_to(n.operands[0], source_format);
        const bool is_logic = kind_of(n.op) == OperationKind::logic;
        const FloatFormat format = kind_of(n.op) == OperationKind::rounded ? is_wide_[i] ? wide_format_ : source_format
                                   : is_logic                              ? source_format
                                                                           : widest_operand_format(n);
        std::array<NodeId, 3> operands{no_node, no_node, no_node};
        for (std::size_t k = 0; k < 3; ++k) {
            const NodeId operand = n.operands[k];
            if (operand == no_node) continue;
            operands[k] = is_decision(source_[operand].op) ? new_node(operand) : convert_to(operand, format);
        }
        return append_node(n, is_decision(n.op) ? source_format : format, operands);
    }

    NodeId append_node(const TapeNode& n, const FloatFormat& format, const std::array<NodeId, 3>& operands) {
        const NodeId node = n.op == TapeOp::input
                                ? result_.add_input(format, n.value)
                                : result_.add(n.op, format, n.value, {operands[0], operands[1], operands[2]});
        result_[node].label = n.label;
        return node;
    }

    const Tape& source_;
    FloatFormat wide_format_;
    std::vector<bool> is_wide_;
    std::vector<NodeId> new_nodes_;
    std::map<std::pair<NodeId, int>, NodeId> conversions_;
    Tape result_;
};

template <class S>
void run_program(void* program, const intersect::table::RayBatch<S>& rays, const intersect::Target<S>& target,
                 const intersect::table::HitBatch<S>& hits) {
    static_cast<const TapeProgram*>(program)->run<S>(rays, target, hits);
}

}  // namespace

namespace {

/// Reason why no tape can have all operations of a form; empty if a tape can.
std::string refusal_of_tape(const Intersector& form) {
    if (!is_primitive(form.shape))
        return "it marches, so its operations differ from ray to ray; name a form of a primitive";
    if (form.is_set()) return "it stands for several forms; name one of them";
    if (intersect::bounding_box::innermost_form(form).deciding_arithmetic)
        return "it filters: it uses more precision where a ray needs it, so its operations differ from ray to ray; "
               "name a form that does the same operations for every ray";
    if (intersect::bounding_box::has_box(form))
        return "name the form without its box, such as " +
               std::string(intersect::bounding_box::innermost_form(form).info->name);
    if (!form.record)
        return "its operations are not known, since it is compiled elsewhere; write it as a form over any number to "
               "see them (docs/your-own-form.md)";
    return {};
}

}  // namespace

bool has_tape(const Intersector& form) { return refusal_of_tape(form).empty(); }

Tape record_tape(const Intersector& form, const Format& format, bool from_inverse) {
    if (const std::string reason = refusal_of_tape(form); !reason.empty())
        throw InputError(std::string(form.info->name) + ": " + reason);
    const Ray<double> sample_ray{Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)};
    Primitive<double> primitive(form.shape);
    for (std::size_t k = 0; k < primitive.shape_numbers().size(); ++k)
        primitive.numbers[k] = static_cast<double>(k + 1);
    if (form.has_transform_method) primitive.transform = {{2, 0, 0, 1, 0, 2, 0, 1, 0, 0, 2, 1}, from_inverse};
    Tape tape;
    tape.runs_every_loop = true;
    form.record(format, sample_ray, intersect::Target<double>(primitive), HUGE_VAL, tape);
    return tape;
}

std::vector<double> inputs_of(const Ray<double>& ray, const Primitive<double>& primitive, double tmax) {
    const auto &o = ray.origin, &d = ray.direction;
    std::vector<double> inputs{o.x, o.y, o.z, d.x, d.y, d.z};
    const auto used = primitive.shape_numbers();
    inputs.insert(inputs.end(), used.begin(), used.end());
    if (primitive.transform)
        inputs.insert(inputs.end(), primitive.transform->matrix.begin(), primitive.transform->matrix.end());
    inputs.push_back(tmax);
    return inputs;
}

Ray<double> ray_of(const std::vector<double>& inputs) {
    return {{inputs[0], inputs[1], inputs[2]}, {inputs[3], inputs[4], inputs[5]}};
}

Primitive<double> primitive_of(const std::vector<double>& inputs, const Primitive<double>& model) {
    Primitive<double> primitive = model;
    auto next = inputs.begin() + 6;
    for (double& x : primitive.shape_numbers()) x = *next++;
    if (primitive.transform)
        for (double& x : primitive.transform->matrix) x = *next++;
    return primitive;
}

std::vector<NodeId> find_widenable_operations(const Tape& tape) {
    std::vector<bool> is_needed(tape.nodes.size());
    for (const NodeId out : {tape.outputs.hit, tape.outputs.t, tape.outputs.near, tape.outputs.far})
        is_needed[out] = true;
    for (NodeId i = tape.size() - 1; i >= 0; --i) {
        if (!is_needed[i] || is_given(tape[i].op)) continue;
        for (const NodeId operand : tape[i].operands)
            if (operand != no_node) is_needed[operand] = true;
    }
    std::vector<NodeId> operations;
    for (NodeId i = 0; i < tape.size(); ++i) {
        if (is_needed[i] && kind_of(tape[i].op) == OperationKind::rounded &&
            tape.format_of(i) == tape.format_of(tape.outputs.t))
            operations.push_back(i);
    }
    return operations;
}

Tape widen_operations(const Tape& tape, const std::vector<NodeId>& operations, const FloatFormat& to) {
    return Widening(tape, operations, to).widen();
}

FloatFormat wider_format(const FloatFormat& format, bool two_words) {
    if (format == binary64) return two_doubles;
    return two_words ? two_floats : binary64;
}

TapeForm::TapeForm(const Intersector& model, const Format& format, const Tape& tape, std::string name,
                   std::string title)
    : program_(tape),
      name_(std::move(name)),
      title_(std::move(title)),
      info_(*model.info),
      form_{.info = &info_,
            .shape = model.shape,
            .native32 = nullptr,
            .native64 = nullptr,
            .has_transform_method = model.has_transform_method} {
    info_.name = name_;
    info_.title = title_;
    if (format.engine == Format::Engine::native32) form_.native32 = {run_program<float>, &program_};
    else form_.native64 = {run_program<double>, &program_};
}

}  // namespace lostbits::measure::tape
