#include "intersect/table/written_formula.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "intersect/table/arithmetics.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::table {

namespace {

/// Builds a constant of a formula as m·2^e from integers of 20 bits, which every format of 24 bits holds. A format that
/// holds the number gets it without rounding, and a tape has it as a constant, not as an input.
template <class T>
T constant(double x) {
    if (std::isinf(x)) return x > 0 ? T(1) / T(0) : -(T(1) / T(0));
    if (x == 0) return std::signbit(x) ? -T(0) : T(0);
    if (x == std::floor(x) && std::fabs(x) < 0x1p24) return T(static_cast<int>(x));
    int exponent = 0;
    double remainder = std::frexp(std::fabs(x), &exponent);
    constexpr int bits = 20;

    // Adds the pieces of 20 bits, the highest first.
    const auto next_piece = [&] {
        remainder *= 1 << bits;
        exponent -= bits;
        const int m = static_cast<int>(remainder);
        remainder -= m;
        return T(m);
    };
    T value = next_piece();
    while (remainder != 0) value = value * T(1 << bits) + next_piece();

    // Multiplies by the power of two in steps that every format holds.
    for (; exponent <= -bits; exponent += bits) value = value / T(1 << bits);
    for (; exponent >= bits; exponent -= bits) value = value * T(1 << bits);
    if (exponent < 0) value = value / T(1 << -exponent);
    if (exponent > 0) value = value * T(1 << exponent);
    return x < 0 ? -value : value;
}

/// Evaluates a formula in T. Numbers of T, numbers of the wider format and decisions are in three lists;
/// `index_in_kind_` has the index of each operation's result in its list.
template <class T>
class Evaluation {
public:
    explicit Evaluation(const WrittenFormula& formula) : formula_(formula) {
        index_in_kind_.reserve(formula.operations.size());
        numbers_.reserve(formula.operations.size());
        std::array<std::size_t, 3> counts{};
        for (const WrittenOperation& operation : formula.operations)
            index_in_kind_.push_back(counts[is_decision(operation.op) ? 0 : operation.wide ? 1 : 2]++);
    }

    /// Computes the constants once for all runs. This is for numbers that do not record their operations.
    void make_constants() {
        constexpr bool is_widest = std::same_as<T, typename Wider<T>::type>;  // then wide constants are T's, too
        for (const WrittenOperation& operation : formula_.operations)
            constants_.push_back(operation.op == TapeOp::constant && (is_widest || !operation.wide)
                                     ? constant<T>(operation.value)
                                     : T(0));
    }

    /// Computes the answer to one ray. It may be called again for the next one.
    template <class Input>
    Hit<T> run(const Input& input) {
        numbers_.clear();
        wide_.clear();
        masks_.clear();
        return run_from(0, input);
    }

    /// The recorder's index for the result of operation i.
    [[nodiscard]] NodeId node(std::size_t i) const {
        const WrittenOperation& w = formula_.operations[i];
        if (is_decision(w.op)) return masks_[index_in_kind_[i]].node();
        return w.wide ? wide_[index_in_kind_[i]].node() : numbers_[index_in_kind_[i]].node();
    }

private:
    template <class Input>
    Hit<T> run_from(std::size_t i, const Input& input) {
        for (; i < formula_.operations.size(); ++i) {
            const WrittenOperation& w = formula_.operations[i];
            if (is_decision(w.op)) {
                masks_.push_back(decision(w));
                if constexpr (std::same_as<mask_t<T>, Tri>)
                    if (w.has_sides && masks_.back().is_unknown()) return evaluate_both_outcomes(i + 1, input);
            } else if (w.wide) {
                add(wide_, i, w.op == TapeOp::convert ? Wider<T>::widen(x(numbers_, w, 0)) : number(wide_, w, input));
            } else {
                add(numbers_, i,
                    w.op == TapeOp::convert ? Wider<T>::narrow(x(wide_, w, 0)) : number(numbers_, w, input));
            }
        }

        // A form without near and far has t for both.
        const auto number_at = [&](NodeId root) {
            return numbers_[index_in_kind_[root == no_node ? formula_.t : root]];
        };
        return {masks_[index_in_kind_[formula_.hit]], number_at(formula_.t), number_at(formula_.near),
                number_at(formula_.far)};
    }

    /// Evaluates the rest of the formula twice, once for each outcome of the last decision, which is undecided, and
    /// joins the two answers.
    template <class Input>
    Hit<T> evaluate_both_outcomes(std::size_t next, const Input& input) {
        Evaluation other(*this);
        other.masks_.back() = Tri(Tri::yes);
        masks_.back() = Tri(Tri::no);
        const Hit<T> yes = other.run_from(next, input), no = run_from(next, input);
        const auto join = [](const T& a, const T& b) { return select(Tri(Tri::unknown), a, b); };
        const bool sides_agree = (yes.hit.is_yes() && no.hit.is_yes()) || (yes.hit.is_no() && no.hit.is_no());
        return {sides_agree ? yes.hit : Tri(Tri::unknown), join(yes.t, no.t), join(yes.near, no.near),
                join(yes.far, no.far)};
    }
    template <class N>
    void add(std::vector<N>& numbers, std::size_t i, N result) {
        numbers.push_back(std::move(result));
        if (!formula_.operations[i].label.empty())
            static_cast<void>(named(formula_.operations[i].label, numbers.back()));
    }
    template <class N>
    const N& x(const std::vector<N>& numbers, const WrittenOperation& operation, std::size_t k) const {
        return numbers[index_in_kind_[operation.operands[k]]];
    }
    mask_t<T> m(const WrittenOperation& operation, std::size_t k) const {
        return masks_[index_in_kind_[operation.operands[k]]];
    }
    template <class N, class Input>
    N number(const std::vector<N>& numbers, const WrittenOperation& w, const Input& input) const {
        const auto x = [&](const WrittenOperation& operation, std::size_t k) -> const N& {
            return this->x(numbers, operation, k);
        };
        switch (w.op) {
            // Given numbers. An input is read in T, whatever the format of its operation.
            case TapeOp::input:
                if constexpr (std::is_same_v<N, T>) return input(w.operands[0]);
                else return Wider<T>::widen(input(w.operands[0]));
            case TapeOp::constant:
                if constexpr (std::is_same_v<N, T>)
                    if (!constants_.empty()) return constants_[&w - formula_.operations.data()];
                return constant<N>(w.value);

            // Arithmetic. The same operand twice is a square, which enclosures bound more tightly.
            case TapeOp::add: return x(w, 0) + x(w, 1);
            case TapeOp::sub: return x(w, 0) - x(w, 1);
            case TapeOp::mul: return w.operands[0] == w.operands[1] ? square(x(w, 0)) : x(w, 0) * x(w, 1);
            case TapeOp::div: return x(w, 0) / x(w, 1);
            case TapeOp::sqrt: return sqrt(x(w, 0));
            case TapeOp::fma:
                return w.operands[0] == w.operands[1] ? fma_square(x(w, 0), x(w, 2)) : fma(x(w, 0), x(w, 1), x(w, 2));

            // Operations without rounding.
            case TapeOp::neg: return -x(w, 0);
            case TapeOp::abs: return abs(x(w, 0));
            case TapeOp::copysign: return copysign(x(w, 0), x(w, 1));
            case TapeOp::min: return min(x(w, 0), x(w, 1));
            case TapeOp::max: return max(x(w, 0), x(w, 1));
            case TapeOp::select: return select(m(w, 0), x(w, 1), x(w, 2));

            // Directed rounding.
            case TapeOp::next_up: return next_up(x(w, 0));
            default: return next_down(x(w, 0));
        }
    }
    template <class N>
    mask_t<T> comparison(const std::vector<N>& numbers, const WrittenOperation& operation) const {
        switch (operation.op) {
            case TapeOp::less: return x(numbers, operation, 0) < x(numbers, operation, 1);
            case TapeOp::less_equal: return x(numbers, operation, 0) <= x(numbers, operation, 1);
            case TapeOp::greater: return x(numbers, operation, 0) > x(numbers, operation, 1);
            default: return x(numbers, operation, 0) >= x(numbers, operation, 1);
        }
    }
    mask_t<T> decision(const WrittenOperation& operation) const {
        switch (operation.op) {
            case TapeOp::logical_and: return m(operation, 0) && m(operation, 1);
            case TapeOp::logical_or: return m(operation, 0) || m(operation, 1);
            case TapeOp::logical_not: return !m(operation, 0);
            default: break;
        }
        const bool wide = formula_.operations[operation.operands[0]].wide;
        return wide ? comparison(wide_, operation) : comparison(numbers_, operation);
    }

    const WrittenFormula& formula_;
    std::vector<std::size_t> index_in_kind_;
    std::vector<T> constants_, numbers_;
    std::vector<typename Wider<T>::type> wide_;
    std::vector<mask_t<T>> masks_;
};

/// Returns a function that reads inputs by their index in `WrittenOperation::operands`.
template <class T>
auto input_reader(const WrittenFormula& formula, const Ray<T>& ray, const Primitive<T>& primitive, const T& end) {
    return [&ray, &primitive, &end, number_count = row_of(formula.shape).number_count](std::size_t k) -> T {
        if (k < 3) return ray.origin[static_cast<int>(k)];
        if (k < 6) return ray.direction[static_cast<int>(k - 3)];
        return k - 6 < number_count ? primitive.numbers[k - 6] : end;
    };
}

template <class T>
Hit<T> evaluate_formula(const WrittenFormula& formula, const Ray<T>& ray, const Primitive<T>& primitive, const T& end) {
    using intersect::table::input_reader;
    return Evaluation<T>(formula).run(input_reader(formula, ray, primitive, end));
}

const WrittenForm& form_of(void* context) { return *static_cast<const WrittenForm*>(context); }

template <class T, class S>
void answer_rays(const WrittenFormula& formula, const RayBatch<S>& rays, const Target<S>& target,
                 const HitBatch<S>& hits) {
    const std::size_t stride = target.primitives.size() == 1 ? 0 : 1;
    const std::size_t number_count = row_of(formula.shape).number_count;
    Evaluation<T> evaluation(formula);
    evaluation.make_constants();

    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray<S> ray{{rays.ox[i], rays.oy[i], rays.oz[i]}, {rays.dx[i], rays.dy[i], rays.dz[i]}};
        const Primitive<S>& primitive = target.primitives[i * stride];
        const S tmax = rays.tmax.empty() ? std::numeric_limits<S>::infinity() : rays.tmax[i];
        const Hit<T> hit = evaluation.run([&](std::size_t k) -> T {
            if (k < 3) return T(ray.origin[static_cast<int>(k)]);
            if (k < 6) return T(ray.direction[static_cast<int>(k - 3)]);
            return T(k - 6 < number_count ? primitive.numbers[k - 6] : tmax);
        });

        hits.hit[i] = hit.hit;
        hits.t[i] = static_cast<S>(as_double(hit.t));
        hits.near[i] = static_cast<S>(as_double(hit.near));
        hits.far[i] = static_cast<S>(as_double(hit.far));
    }
}

void answer_rounded(void* context, const FloatFormat& format, const RayBatch<double>& rays,
                    const Target<double>& target, const HitBatch<double>& hits) {
    const CurrentFormat::Scope scope(format);
    answer_rays<RoundedAny>(form_of(context).formula_in(*find_format("f32")), rays, target, hits);
}

void answer_32(void* context, const RayBatch<float>& rays, const Target<float>& target, const HitBatch<float>& hits) {
    answer_rays<float>(form_of(context).formula_in(*find_format("f32")), rays, target, hits);
}

void answer_64(void* context, const RayBatch<double>& rays, const Target<double>& target,
               const HitBatch<double>& hits) {
    answer_rays<double>(form_of(context).formula_in(*find_format("f64")), rays, target, hits);
}

template <class E>
Hit<E> enclose(void* context, const Ray<E>& ray, const Target<E>& target) {
    return evaluate_formula(form_of(context).formula_in(*find_format("f32")), ray, target.primitives.front(),
                            endless_tmax<E>());
}

Hit<Recorded> record_hit(const WrittenFormula& formula, const Ray<double>& ray, const Target<double>& target,
                         double end) {
    const LiftedInputs<Recorded> lifted(ray, target, end);
    return evaluate_formula(formula, lifted.ray, lifted.target.get().primitives.front(), lifted.tmax);
}

void record(void* context, const Format& format, const Ray<double>& ray, const Target<double>& target, double end,
            Tape& tape) {
    tape.clear();
    record_on_tape([&] { return record_hit(form_of(context).formula_in(format), ray, target, end); }, format.parameters,
                   tape);
}

void record_all(void* context, const Target<double>& target, Tape& tape) {
    record(context, *find_format("f32"), {Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)}, target, HUGE_VAL, tape);
}

OperationCounts count(void* context, const Ray<float>& ray, const Target<float>& target, float end) {
    const WrittenFormula& formula = form_of(context).formula_in(*find_format("f32"));
    const auto evaluate = [&formula](const auto& ray_in, const auto& aim, const auto& tmax) {
        return evaluate_formula(formula, ray_in, aim.primitives.front(), tmax);
    };
    return count_operations(evaluate, ray, target, end);
}

std::optional<BoundedAnswer> answer_bounded(void* context, const Format& format, const Ray<double>& ray,
                                            const Target<double>& target, double end) {
    return evaluate_with_bounds([&] { return record_hit(form_of(context).formula_in(format), ray, target, end); },
                                format);
}

/// True if operand k of an operation is a decision.
bool takes_decision(TapeOp op, std::size_t k) {
    return kind_of(op) == OperationKind::logic || (op == TapeOp::select && k == 0);
}

[[noreturn]] void fail_operation(const WrittenFormula& formula, std::size_t i, const std::string& why) {
    throw InputError(formula.name + ": operation " + std::to_string(i) + ", " +
                     std::string(name_of(formula.operations[i].op)) + ", " + why);
}

/// Throws InputError unless each operand of operation i comes before it and has the kind and the format that it takes.
void require_valid_operands(const WrittenFormula& formula, std::size_t i) {
    const WrittenOperation& w = formula.operations[i];
    bool first_is_wide = false;
    for (std::size_t k = 0; !is_given(w.op) && k < row_of(w.op).operand_count; ++k) {
        const std::int32_t a = w.operands[k];
        if (a < 0 || static_cast<std::size_t>(a) >= i)
            fail_operation(formula, i, "takes operation " + std::to_string(a) + ", which does not come before it");
        if (is_decision(formula.operations[a].op) != takes_decision(w.op, k))
            fail_operation(formula, i,
                           takes_decision(w.op, k) ? "takes a number where it needs a decision"
                                                   : "takes a decision where it needs a number");
        if (takes_decision(w.op, k)) continue;

        // Only a conversion takes numbers of another format than its own; the numbers of a comparison share one.
        const bool is_wide = formula.operations[a].wide;
        if (is_comparison(w.op) && k == 0) first_is_wide = is_wide;
        const bool has_right_format =
            is_comparison(w.op) ? is_wide == first_is_wide : (is_wide == w.wide) != (w.op == TapeOp::convert);
        if (!has_right_format) fail_operation(formula, i, "takes numbers of the wrong format; convert them first");
    }
}

/// Throws InputError unless the answers are a decision and numbers of the formula's own format.
void require_valid_answers(const WrittenFormula& formula) {
    const auto is_index_of = [&formula](NodeId i, bool of_decision) {
        return i >= 0 && static_cast<std::size_t>(i) < formula.operations.size() &&
               is_decision(formula.operations[i].op) == of_decision;
    };
    if (!is_index_of(formula.hit, true)) throw InputError(formula.name + ": hit is not the index of a decision");
    if (!is_index_of(formula.t, false)) throw InputError(formula.name + ": t is not the index of a number");
    for (const NodeId i : {formula.near, formula.far})
        if (i != no_node && !is_index_of(i, false))
            throw InputError(formula.name + ": near or far is not the index of a number");
    for (const NodeId i : {formula.t, formula.near, formula.far})
        if (i != no_node && formula.operations[i].wide)
            throw InputError(formula.name + ": an answer is of the wider format; convert it first");
}

}  // namespace

void require_valid(const WrittenFormula& formula) {
    const std::size_t input_count = 6 + row_of(formula.shape).number_count + 1;
    const bool has_wide = std::ranges::any_of(formula.operations, &WrittenOperation::wide);
    for (std::size_t i = 0; i < formula.operations.size(); ++i) {
        const WrittenOperation& w = formula.operations[i];
        if ((w.op == TapeOp::convert && !has_wide) || w.op == TapeOp::any || w.op == TapeOp::call)
            fail_operation(formula, i,
                           "is not allowed: all numbers of a list are of one format, and a list has no loops");
        if (w.op == TapeOp::input && !(w.operands[0] >= 0 && static_cast<std::size_t>(w.operands[0]) < input_count))
            fail_operation(formula, i,
                           "has number " + std::to_string(w.operands[0]) + "; inputs are numbered from 0 to " +
                               std::to_string(input_count - 1));
        if (w.op == TapeOp::constant && std::isnan(w.value)) fail_operation(formula, i, "is not a number");
        require_valid_operands(formula, i);
    }
    require_valid_answers(formula);
}

WrittenFormula formula_from_tape(const Tape& tape, Shape shape, std::string name) {
    WrittenFormula formula{.name = std::move(name), .shape = shape, .operations = {}};
    const std::uint8_t own_format = tape[tape.outputs.t].format;
    for (const TapeNode& node : tape.nodes)
        formula.operations.push_back({.op = node.op,
                                      .operands = node.operands,
                                      .value = node.value,
                                      .label = std::string(node.label),
                                      .wide = !is_decision(node.op) && node.format != own_format});
    for (const NodeId decision : tape.branch_decisions) formula.operations[decision].has_sides = true;
    formula.hit = tape.outputs.hit;
    formula.t = tape.outputs.t;
    formula.near = tape.outputs.near;
    formula.far = tape.outputs.far;
    require_valid(formula);
    return formula;
}

WrittenForm::WrittenForm(std::shared_ptr<const WrittenFormula> formula32,
                         std::shared_ptr<const WrittenFormula> formula64)
    : formula32_(std::move(formula32)), formula64_(std::move(formula64)) {}

WrittenForm::WrittenForm(const Intersector& recorded_form) : recorded_form_(recorded_form) {}

const WrittenFormula& WrittenForm::formula_in(const Format& format) const {
    if (recorded_form_)
        std::call_once(once_, [this] {
            Tape tape;
            recorded_form_->record_all(Target<double>(Primitive<double>(recorded_form_->shape)), tape);
            formula32_ = std::make_shared<const WrittenFormula>(
                formula_from_tape(tape, recorded_form_->shape, std::string(recorded_form_->info->name)));
        });
    return formula32_ == nullptr || (format.engine == Format::Engine::native64 && formula64_ != nullptr) ? *formula64_
                                                                                                         : *formula32_;
}

void WrittenForm::fill_arithmetics(Intersector& form) {
    form.rounded = {answer_rounded, this};
    form.ball = {enclose<Ball>, this};
    form.interval = {enclose<Interval>, this};
}

void WrittenForm::fill(Intersector& form) {
    fill_arithmetics(form);
    form.count = {count, this};
    form.record = {record, this};
    form.record_all = {record_all, this};
    form.bounded = {answer_bounded, this};
}

std::vector<NodeId> WrittenForm::find_nodes_on_tape(const Format& format) const {
    const WrittenFormula& formula = formula_in(format);
    std::vector<NodeId> nodes;
    Tape tape;
    const auto evaluate = [&] {
        const Primitive<double> sample_primitive(formula.shape);
        const LiftedInputs<Recorded> lifted(Ray<double>{Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)},
                                            Target<double>(sample_primitive), HUGE_VAL);
        Evaluation<Recorded> evaluation(formula);
        const Hit<Recorded> hit = evaluation.run(
            table::input_reader(formula, lifted.ray, lifted.target.get().primitives.front(), lifted.tmax));
        for (std::size_t i = 0; i < formula.operations.size(); ++i) nodes.push_back(evaluation.node(i));
        return hit;
    };
    record_on_tape(evaluate, format.parameters, tape);
    return nodes;
}

Intersector WrittenForm::make_intersector(const Info& info) {
    Intersector form{.info = &info, .shape = formula_in(*find_format("f32")).shape, .native32 = {}, .native64 = {}};
    form.native32 = {answer_32, this};
    form.native64 = {answer_64, this};
    fill(form);
    return form;
}

}  // namespace lostbits::intersect::table
