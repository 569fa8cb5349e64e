// Instructions of LLVM IR: arithmetic, comparisons, loads and stores, and the ends of blocks.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#include "intersect/function/walk.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {

// Instructions

bool Walk::run_instruction(Frame& frame, State& state, std::string_view line) {
    if (++steps_ > max_steps) fail("the function takes too many steps on one ray");
    if (const int p = place_of_line(line, frame); p >= 0) nodes_.place = p;
    Cursor cursor(line);
    if (cursor.peek() == '#') {
        cursor.expect("#");
        handle_debug_record(state, line, cursor, true);
        return true;
    }
    std::string result;
    if (cursor.take("%")) {
        result = cursor.take_name();
        cursor.expect("=");
    }
    static_cast<void>(cursor.take("tail") || cursor.take("musttail") || cursor.take("notail"));
    const std::string_view op = cursor.take_word();
    if (op == "phi") return true;  // set by `enter`
    if (op == "call" && line.find("@llvm.dbg.") != std::string_view::npos) {
        handle_debug_record(state, line, cursor, false);
        return true;
    }
    if (op == "br" || op == "switch" || op == "ret" || op == "unreachable" || op == "invoke" || op == "resume" ||
        op == "indirectbr") {
        if (op != "invoke") return end_block(frame, state, op, cursor);
        const std::vector<std::string> next_label = [&] {
            const std::size_t normal = line.find("to label %");
            if (normal == std::string_view::npos) cursor.fail("a call has no block to return to");
            Cursor label(line.substr(normal + 10));
            return std::vector{label.take_name()};
        }();
        std::optional<Value> answer = run_call_instruction(frame, state, cursor);
        if (!answer) return false;
        if (!result.empty()) state.registers[result] = std::move(*answer);
        branch(frame, state, yes, next_label[0]);
        return false;
    }
    if (op == "call") {
        std::optional<Value> answer = run_call_instruction(frame, state, cursor);
        if (!answer) return false;
        if (!result.empty()) state.registers[result] = std::move(*answer);
        return true;
    }
    Value result_value = compute(frame, state, op, cursor);
    if (frame.function->subprogram < 0 && depth_ > 1 && result_value.size() == 1 && !result.starts_with('.') &&
        result.find_first_not_of("0123456789") != std::string::npos)
        if (const Scalar& s = result_value.begin()->second.scalar; s.kind == Scalar::Kind::number)
            nodes_.name_node(s.node, result, depth_);
    if (!result.empty()) state.registers[result] = std::move(result_value);
    return true;
}

bool Walk::end_block(Frame& frame, State& state, std::string_view op, Cursor& cursor) {
    if (op == "unreachable" || op == "resume") return false;
    if (op == "ret") {
        const Type* const type = module_.read_type(cursor);
        add_return_state(frame, state, type->kind == Type::Kind::nothing ? Value() : value(state, *type, cursor));
        return false;
    }
    const auto label = [&cursor] {
        cursor.expect("label");
        cursor.expect("%");
        return cursor.take_name();
    };
    if (op == "br") {
        if (cursor.peek() == 'l') {
            branch(frame, state, yes, label());
            return false;
        }
        const Type* const type = module_.read_type(cursor);
        const Mask when = mask_of(value(state, *type, cursor));
        cursor.expect(",");
        const std::string true_label = label();
        cursor.expect(",");
        branch(frame, state, when, true_label);
        branch(frame, state, nodes_.logical_not(when), label());
        return false;
    }
    if (op == "indirectbr") fail("a jump to a computed place is not followed");
    const Type* const type = module_.read_type(cursor);
    const std::vector<Case> cases = cases_of(value(state, *type, cursor), *type);
    cursor.expect(",");
    const std::string default_label = label();
    std::map<std::string, Mask> targets;
    std::vector<bool> has_target(cases.size());
    cursor.expect("[");
    while (!cursor.take("]")) {
        const Type* const case_type = module_.read_type(cursor);
        const std::int64_t x = cases_of(constant(state, *case_type, cursor), *case_type)[0].value;
        cursor.expect(",");
        Mask& when = targets.try_emplace(label(), no).first->second;
        for (std::size_t k = 0; k < cases.size(); ++k) {
            if (cases[k].value != x) continue;
            when = nodes_.logical_or(when, cases[k].when);
            has_target[k] = true;
        }
    }
    Mask& default_decision = targets.try_emplace(default_label, no).first->second;
    for (std::size_t k = 0; k < cases.size(); ++k)
        if (!has_target[k]) default_decision = nodes_.logical_or(default_decision, cases[k].when);
    for (const auto& [target, when] : targets) branch(frame, state, when, target);
    return false;
}

Value Walk::compute(Frame& frame, State& state, std::string_view op, Cursor& cursor) {
    if (op == "alloca") {
        cursor.take("inalloca");
        const Type* const type = module_.read_type(cursor);
        static_cast<void>(type);
        return integer_from_cases({{yes, new_object(state), 0}}, 8);
    }
    if (op == "load") {
        cursor.take("atomic"), skip_flags(cursor);
        const Type* const type = module_.read_type(cursor);
        cursor.expect(",");
        const Type* const pointer = module_.read_type(cursor);
        return load(state, value(state, *pointer, cursor), type->size);
    }
    if (op == "store") {
        cursor.take("atomic"), skip_flags(cursor);
        const Type* const type = module_.read_type(cursor);
        const Value stored = value(state, *type, cursor);
        cursor.expect(",");
        const Type* const pointer = module_.read_type(cursor);
        const Value address = value(state, *pointer, cursor);
        for (const Case& c : cases_of(address, *pointer)) {
            const auto variable = variables_.find(c.memory_object);
            if (variable != variables_.end() && c.value >= 0)
                name_value(variable->second.first, stored, static_cast<std::size_t>(c.value), variable->second.second);
        }
        store(state, address, type->size, stored);
        return {};
    }
    if (op == "getelementptr") return element_address(state, cursor);
    if (op == "fadd" || op == "fsub" || op == "fmul" || op == "fdiv" || op == "fneg" || op == "frem")
        return arithmetic(state, op, cursor);
    if (op == "fcmp") return compare_numbers(state, cursor);
    if (op == "icmp") return compare_integers(state, cursor);
    if (std::ranges::find(integer_operations, op) != integer_operations.end())
        return integer_arithmetic(state, op, cursor);
    if (op == "select") {
        skip_flags(cursor);
        const Type* const condition = module_.read_type(cursor);
        const Value when = value(state, *condition, cursor);
        cursor.expect(",");
        const Type* const type = module_.read_type(cursor);
        const Value a = value(state, *type, cursor);
        cursor.expect(",");
        module_.read_type(cursor);
        const Value b = value(state, *type, cursor);
        if (!condition->is_vector) return join(mask_of(when), a, b);
        std::size_t k = 0;
        return map_lanes(*type, [&](const Type& lane, std::size_t offset) {
            const Mask m = mask_of(extract_bytes(when, k++, 1));
            return join(m, extract_bytes(a, offset, lane.size), extract_bytes(b, offset, lane.size));
        });
    }
    if (op == "freeze") {
        const Type* const type = module_.read_type(cursor);
        return value(state, *type, cursor);
    }
    for (const char* const conversion : {"bitcast", "addrspacecast", "inttoptr", "ptrtoint", "trunc", "zext", "sext",
                                         "fpext", "fptrunc", "sitofp", "uitofp", "fptosi", "fptoui"})
        if (op == conversion) return convert(state, op, cursor);
    if (op == "extractvalue" || op == "insertvalue" || op == "extractelement" || op == "insertelement" ||
        op == "shufflevector")
        return rearrange(state, op, cursor);
    static_cast<void>(frame);
    fail("the instruction " + std::string(op) + " of LLVM IR is not followed");
}

Value Walk::arithmetic(State& state, std::string_view op, Cursor& cursor) {
    skip_flags(cursor);
    const Type* const type = module_.read_type(cursor);
    const Value a = value(state, *type, cursor);
    if (op == "fneg")
        return map_lanes(*type, [&](const Type& lane, std::size_t offset) {
            return number(nodes_.arithmetic(TapeOp::neg, number_of(extract_bytes(a, offset, lane.size), lane)));
        });
    cursor.expect(",");
    const Value b = value(state, *type, cursor);
    if (op == "frem") fail("the remainder of a division (fmod) is not followed");
    const TapeOp tape_op = op == "fadd"   ? TapeOp::add
                           : op == "fsub" ? TapeOp::sub
                           : op == "fmul" ? TapeOp::mul
                                          : TapeOp::div;
    return map_lanes(*type, [&](const Type& lane, std::size_t offset) {
        const NodeId x = number_of(extract_bytes(a, offset, lane.size), lane),
                     y = number_of(extract_bytes(b, offset, lane.size), lane);
        // Older compilers write -x as -0 - x.
        if (tape_op == TapeOp::sub && nodes_[x].op == TapeOp::constant && nodes_[x].value == 0 &&
            std::signbit(nodes_[x].value))
            return number(nodes_.arithmetic(TapeOp::neg, y));
        return number(nodes_.arithmetic(tape_op, x, y));
    });
}

Value Walk::compare_numbers(State& state, Cursor& cursor) {
    skip_flags(cursor);
    const std::string_view predicate = cursor.take_word();
    const Type* const type = module_.read_type(cursor);
    const Value a = value(state, *type, cursor);
    cursor.expect(",");
    const Value b = value(state, *type, cursor);
    if (predicate.size() < 3 && predicate != "oeq") cursor.fail("a comparison is unknown");
    const auto decide = [&](NodeId x, NodeId y) -> Mask {
        if (predicate == "true") return yes;
        if (predicate == "false") return no;
        const auto compare = [&](TapeOp op) { return nodes_.compare(op, x, y); };
        const auto equal = [&] {
            return nodes_.logical_and(compare(TapeOp::less_equal), compare(TapeOp::greater_equal));
        };
        const auto different = [&] { return nodes_.logical_or(compare(TapeOp::less), compare(TapeOp::greater)); };
        const auto ordered = [&] {
            return nodes_.logical_and(nodes_.compare(TapeOp::less_equal, x, x),
                                      nodes_.compare(TapeOp::less_equal, y, y));
        };
        if (predicate == "oeq") return equal();
        if (predicate == "une") return nodes_.logical_not(equal());
        if (predicate == "one") return different();
        if (predicate == "ueq") return nodes_.logical_not(different());
        if (predicate == "ord") return ordered();
        if (predicate == "uno") return nodes_.logical_not(ordered());
        if (predicate == "olt") return compare(TapeOp::less);
        if (predicate == "ole") return compare(TapeOp::less_equal);
        if (predicate == "ogt") return compare(TapeOp::greater);
        if (predicate == "oge") return compare(TapeOp::greater_equal);
        if (predicate == "ult") return nodes_.logical_not(compare(TapeOp::greater_equal));
        if (predicate == "ule") return nodes_.logical_not(compare(TapeOp::greater));
        if (predicate == "ugt") return nodes_.logical_not(compare(TapeOp::less_equal));
        if (predicate == "uge") return nodes_.logical_not(compare(TapeOp::less));
        cursor.fail("a comparison is unknown");
    };
    if (!type->is_vector) return integer_from_mask(decide(number_of(a, *type), number_of(b, *type)));
    Value masks;
    for (std::size_t k = 0; k < type->count; ++k) {
        std::size_t offset = 0;
        const Type& lane = *type->part(k, offset);
        write_bytes(masks, k, 1,
                    integer_from_mask(decide(number_of(extract_bytes(a, offset, lane.size), lane),
                                             number_of(extract_bytes(b, offset, lane.size), lane))));
    }
    return masks;
}

Value Walk::compare_integers(State& state, Cursor& cursor) {
    skip_flags(cursor);
    const std::string_view predicate = cursor.take_word();
    const Type* const type = module_.read_type(cursor);
    const Value a = value(state, *type, cursor);
    cursor.expect(",");
    const Value b = value(state, *type, cursor);
    const auto decide = [&](const Value& p, const Value& q, const Type& lane) {
        Mask mask = no;
        const int bits = lane.kind == Type::Kind::pointer ? 64 : lane.bits;
        for (const Case& x : cases_of(p, lane))
            for (const Case& y : cases_of(q, lane)) {
                bool result = false;
                if (x.memory_object == y.memory_object) result = comparison_holds(predicate, x.value, y.value, bits);
                else if (predicate == "eq" || predicate == "ne") result = predicate == "ne";
                else fail("addresses of different objects are compared");
                if (result) mask = nodes_.logical_or(mask, nodes_.logical_and(x.when, y.when));
            }
        return integer_from_mask(mask);
    };
    if (!type->is_vector) return decide(a, b, *type);
    Value masks;
    for (std::size_t k = 0; k < type->count; ++k) {
        std::size_t offset = 0;
        const Type& lane = *type->part(k, offset);
        write_bytes(masks, k, 1,
                    decide(extract_bytes(a, offset, lane.size), extract_bytes(b, offset, lane.size), lane));
    }
    return masks;
}

}  // namespace lostbits::intersect::function
