// The instructions of LLVM IR on numbers, memory and the flow of control.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#include "intersect/function/walk.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {

// Instructions

bool Walk::step(Frame& frame, State& state, std::string_view line) {
    if (++steps_ > most_steps) fail("the function takes too many steps on one ray");
    if (const int p = index_of(line, frame); p >= 0) nodes_.place = p;
    Cursor at(line);
    if (at.peek() == '#') {
        at.expect("#");
        declare(state, line, at, true);
        return true;
    }
    std::string result;
    if (at.take("%")) {
        result = at.name();
        at.expect("=");
    }
    static_cast<void>(at.take("tail") || at.take("musttail") || at.take("notail"));
    const std::string_view op = at.word();
    if (op == "phi") return true;  // set by `enter`
    if (op == "call" && line.find("@llvm.dbg.") != std::string_view::npos) {
        declare(state, line, at, false);
        return true;
    }
    if (op == "br" || op == "switch" || op == "ret" || op == "unreachable" || op == "invoke" || op == "resume" ||
        op == "indirectbr") {
        if (op != "invoke") return end_block(frame, state, op, at);
        const std::vector<std::string> to = [&] {
            const std::size_t normal = line.find("to label %");
            if (normal == std::string_view::npos) at.fail("a call goes nowhere");
            Cursor label(line.substr(normal + 10));
            return std::vector{label.name()};
        }();
        std::optional<Value> answer = called(frame, state, at);
        if (!answer) return false;
        if (!result.empty()) state.registers[result] = std::move(*answer);
        branch(frame, state, yes, to[0]);
        return false;
    }
    if (op == "call") {
        std::optional<Value> answer = called(frame, state, at);
        if (!answer) return false;
        if (!result.empty()) state.registers[result] = std::move(*answer);
        return true;
    }
    Value made = compute(frame, state, op, at);
    if (frame.function->subprogram < 0 && depth_ > 1 && made.size() == 1 && !result.starts_with('.') &&
        result.find_first_not_of("0123456789") != std::string::npos)
        if (const Scalar& s = made.begin()->second.scalar; s.kind == Scalar::Kind::number)
            nodes_.name(s.node, result, depth_);
    if (!result.empty()) state.registers[result] = std::move(made);
    return true;
}

bool Walk::end_block(Frame& frame, State& state, std::string_view op, Cursor& at) {
    if (op == "unreachable" || op == "resume") return false;
    if (op == "ret") {
        const Type* const type = module_.type(at);
        take_return(frame, state, type->kind == Type::Kind::nothing ? Value() : value(state, *type, at));
        return false;
    }
    const auto label = [&at] {
        at.expect("label");
        at.expect("%");
        return at.name();
    };
    if (op == "br") {
        if (at.peek() == 'l') {
            branch(frame, state, yes, label());
            return false;
        }
        const Type* const type = module_.type(at);
        const Mask when = mask_of(value(state, *type, at));
        at.expect(",");
        const std::string left = label();
        at.expect(",");
        branch(frame, state, when, left);
        branch(frame, state, nodes_.opposite(when), label());
        return false;
    }
    if (op == "indirectbr") fail("a jump to a computed place is not followed");
    const Type* const type = module_.type(at);
    const std::vector<Case> cases = cases_of(value(state, *type, at), *type);
    at.expect(",");
    const std::string otherwise = label();
    std::map<std::string, Mask> targets;
    std::vector<bool> taken(cases.size());
    at.expect("[");
    while (!at.take("]")) {
        const Type* const case_type = module_.type(at);
        const std::int64_t x = cases_of(constant(state, *case_type, at), *case_type)[0].value;
        at.expect(",");
        Mask& when = targets.try_emplace(label(), no).first->second;
        for (std::size_t k = 0; k < cases.size(); ++k) {
            if (cases[k].value != x) continue;
            when = nodes_.either(when, cases[k].when);
            taken[k] = true;
        }
    }
    Mask& rest = targets.try_emplace(otherwise, no).first->second;
    for (std::size_t k = 0; k < cases.size(); ++k)
        if (!taken[k]) rest = nodes_.either(rest, cases[k].when);
    for (const auto& [target, when] : targets) branch(frame, state, when, target);
    return false;
}

Value Walk::compute(Frame& frame, State& state, std::string_view op, Cursor& at) {
    if (op == "alloca") {
        at.take("inalloca");
        const Type* const type = module_.type(at);
        static_cast<void>(type);
        return whole({{yes, new_object(state), 0}}, 8);
    }
    if (op == "load") {
        at.take("atomic"), skip_flags(at);
        const Type* const type = module_.type(at);
        at.expect(",");
        const Type* const pointer = module_.type(at);
        return load(state, value(state, *pointer, at), type->size);
    }
    if (op == "store") {
        at.take("atomic"), skip_flags(at);
        const Type* const type = module_.type(at);
        const Value stored = value(state, *type, at);
        at.expect(",");
        const Type* const pointer = module_.type(at);
        const Value address = value(state, *pointer, at);
        for (const Case& c : cases_of(address, *pointer)) {
            const auto variable = variables_.find(c.object);
            if (variable != variables_.end() && c.value >= 0)
                name_value(variable->second.first, stored, static_cast<std::size_t>(c.value), variable->second.second);
        }
        store(state, address, type->size, stored);
        return {};
    }
    if (op == "getelementptr") return element_address(state, at);
    if (op == "fadd" || op == "fsub" || op == "fmul" || op == "fdiv" || op == "fneg" || op == "frem")
        return arithmetic(state, op, at);
    if (op == "fcmp") return compare_numbers(state, at);
    if (op == "icmp") return compare_wholes(state, at);
    if (std::ranges::find(whole_operations, op) != whole_operations.end()) return whole_arithmetic(state, op, at);
    if (op == "select") {
        skip_flags(at);
        const Type* const condition = module_.type(at);
        const Value when = value(state, *condition, at);
        at.expect(",");
        const Type* const type = module_.type(at);
        const Value a = value(state, *type, at);
        at.expect(",");
        module_.type(at);
        const Value b = value(state, *type, at);
        if (!condition->is_vector) return join(mask_of(when), a, b);
        std::size_t k = 0;
        return each_lane(*type, [&](const Type& lane, std::size_t from) {
            const Mask m = mask_of(part_of(when, k++, 1));
            return join(m, part_of(a, from, lane.size), part_of(b, from, lane.size));
        });
    }
    if (op == "freeze") {
        const Type* const type = module_.type(at);
        return value(state, *type, at);
    }
    for (const char* const conversion : {"bitcast", "addrspacecast", "inttoptr", "ptrtoint", "trunc", "zext", "sext",
                                         "fpext", "fptrunc", "sitofp", "uitofp", "fptosi", "fptoui"})
        if (op == conversion) return converted(state, op, at);
    if (op == "extractvalue" || op == "insertvalue" || op == "extractelement" || op == "insertelement" ||
        op == "shufflevector")
        return shuffled(state, op, at);
    static_cast<void>(frame);
    fail("the instruction " + std::string(op) + " of LLVM IR is not followed");
}

Value Walk::arithmetic(State& state, std::string_view op, Cursor& at) {
    skip_flags(at);
    const Type* const type = module_.type(at);
    const Value a = value(state, *type, at);
    if (op == "fneg")
        return each_lane(*type, [&](const Type& lane, std::size_t from) {
            return number(nodes_.number(TapeOp::neg, number_of(part_of(a, from, lane.size), lane)));
        });
    at.expect(",");
    const Value b = value(state, *type, at);
    if (op == "frem") fail("the remainder of a division (fmod) is not followed");
    const TapeOp tape_op = op == "fadd"   ? TapeOp::add
                           : op == "fsub" ? TapeOp::sub
                           : op == "fmul" ? TapeOp::mul
                                          : TapeOp::div;
    return each_lane(*type, [&](const Type& lane, std::size_t from) {
        const NodeId x = number_of(part_of(a, from, lane.size), lane), y = number_of(part_of(b, from, lane.size), lane);
        // -0 - x is how older compilers write -x.
        if (tape_op == TapeOp::sub && nodes_[x].op == TapeOp::constant && nodes_[x].value == 0 &&
            std::signbit(nodes_[x].value))
            return number(nodes_.number(TapeOp::neg, y));
        return number(nodes_.number(tape_op, x, y));
    });
}

Value Walk::compare_numbers(State& state, Cursor& at) {
    skip_flags(at);
    const std::string_view predicate = at.word();
    const Type* const type = module_.type(at);
    const Value a = value(state, *type, at);
    at.expect(",");
    const Value b = value(state, *type, at);
    if (predicate.size() < 3 && predicate != "oeq") at.fail("a comparison is unknown");
    const auto decide = [&](NodeId x, NodeId y) -> Mask {
        if (predicate == "true") return yes;
        if (predicate == "false") return no;
        const auto ask = [&](TapeOp op) { return nodes_.compare(op, x, y); };
        const auto equal = [&] { return nodes_.both(ask(TapeOp::less_equal), ask(TapeOp::greater_equal)); };
        const auto apart = [&] { return nodes_.either(ask(TapeOp::less), ask(TapeOp::greater)); };
        const auto ordered = [&] {
            return nodes_.both(nodes_.compare(TapeOp::less_equal, x, x), nodes_.compare(TapeOp::less_equal, y, y));
        };
        if (predicate == "oeq") return equal();
        if (predicate == "une") return nodes_.opposite(equal());
        if (predicate == "one") return apart();
        if (predicate == "ueq") return nodes_.opposite(apart());
        if (predicate == "ord") return ordered();
        if (predicate == "uno") return nodes_.opposite(ordered());
        if (predicate == "olt") return ask(TapeOp::less);
        if (predicate == "ole") return ask(TapeOp::less_equal);
        if (predicate == "ogt") return ask(TapeOp::greater);
        if (predicate == "oge") return ask(TapeOp::greater_equal);
        if (predicate == "ult") return nodes_.opposite(ask(TapeOp::greater_equal));
        if (predicate == "ule") return nodes_.opposite(ask(TapeOp::greater));
        if (predicate == "ugt") return nodes_.opposite(ask(TapeOp::less_equal));
        if (predicate == "uge") return nodes_.opposite(ask(TapeOp::less));
        at.fail("a comparison is unknown");
    };
    if (!type->is_vector) return from_mask(decide(number_of(a, *type), number_of(b, *type)));
    Value all;
    for (std::size_t k = 0; k < type->count; ++k) {
        std::size_t from = 0;
        const Type& lane = *type->part(k, from);
        put(all, k, 1,
            from_mask(
                decide(number_of(part_of(a, from, lane.size), lane), number_of(part_of(b, from, lane.size), lane))));
    }
    return all;
}

Value Walk::compare_wholes(State& state, Cursor& at) {
    skip_flags(at);
    const std::string_view predicate = at.word();
    const Type* const type = module_.type(at);
    const Value a = value(state, *type, at);
    at.expect(",");
    const Value b = value(state, *type, at);
    const auto decide = [&](const Value& p, const Value& q, const Type& lane) {
        Mask all = no;
        const int bits = lane.kind == Type::Kind::pointer ? 64 : lane.bits;
        for (const Case& x : cases_of(p, lane))
            for (const Case& y : cases_of(q, lane)) {
                bool result = false;
                if (x.object == y.object) result = holds(predicate, x.value, y.value, bits);
                else if (predicate == "eq" || predicate == "ne") result = predicate == "ne";
                else fail("addresses of different objects are compared");
                if (result) all = nodes_.either(all, nodes_.both(x.when, y.when));
            }
        return from_mask(all);
    };
    if (!type->is_vector) return decide(a, b, *type);
    Value all;
    for (std::size_t k = 0; k < type->count; ++k) {
        std::size_t from = 0;
        const Type& lane = *type->part(k, from);
        put(all, k, 1, decide(part_of(a, from, lane.size), part_of(b, from, lane.size), lane));
    }
    return all;
}

}  // namespace lostbits::intersect::function
