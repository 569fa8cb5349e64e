// Instructions of LLVM IR: arithmetic, comparisons, loads and stores, and the ends of blocks.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#include "intersect/function/walk.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {

namespace {

/// Takes `label %NAME`, and returns the name.
std::string take_label(Cursor& cursor) {
    cursor.expect("label");
    cursor.expect("%");
    return cursor.take_name();
}

}  // namespace

// Instructions

bool Walk::run_instruction(CallFrame& frame, MemoryState& state, std::string_view line) {
    if (++steps_ > max_steps) fail("the function takes too many steps on one ray");
    if (const int p = place_of_line(line, frame); p >= 0) nodes_.place = p;
    Cursor cursor(line);
    if (cursor.peek() == '#') {
        cursor.expect("#");
        handle_debug_record(state, line, cursor, true);
        return true;
    }

    // `%result = OPERATION ...`
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
    if (op == "invoke") {
        invoke(frame, state, line, result, cursor);
        return false;
    }
    if (op == "br" || op == "switch" || op == "ret" || op == "unreachable" || op == "resume" || op == "indirectbr") {
        end_block(frame, state, op, cursor);
        return false;
    }
    if (op == "call") return call(state, result, cursor);

    Value result_value = compute(state, op, cursor);
    if (frame.function->subprogram < 0) name_after_register(result, result_value);
    if (!result.empty()) state.registers[result] = std::move(result_value);
    return true;
}

/// Performs a call, and sets the register `result`. Returns false if the function does not return.
bool Walk::call(MemoryState& state, const std::string& result, Cursor& cursor) {
    std::optional<Value> answer = run_call_instruction(state, cursor);
    if (!answer) return false;
    if (!result.empty()) state.registers[result] = std::move(*answer);
    return true;
}

/// Performs a call that ends its block, and enters the block to which the call returns. Exceptions are not followed.
void Walk::invoke(CallFrame& frame, MemoryState& state, std::string_view line, const std::string& result,
                  Cursor& cursor) {
    constexpr std::string_view mark = "to label %";
    const std::size_t normal = line.find(mark);
    if (normal == std::string_view::npos) cursor.fail("a call has no block to return to");
    Cursor label(line.substr(normal + mark.size()));
    const std::string next_block = label.take_name();
    if (call(state, result, cursor)) branch(frame, state, yes, next_block);
}

/// Names a number after the register that receives it, in a function of the user without debug information. Registers
/// that only the compiler has named, with a number or a leading dot, give no name.
void Walk::name_after_register(const std::string& register_name, const Value& value) {
    const bool is_users_name =
        !register_name.starts_with('.') && register_name.find_first_not_of("0123456789") != std::string::npos;
    if (depth_ <= 1 || value.size() != 1 || !is_users_name) return;
    const Scalar& s = value.begin()->second.scalar;
    if (s.kind == Scalar::Kind::number) nodes_.name_node(s.node, register_name, depth_);
}

void Walk::end_block(CallFrame& frame, MemoryState& state, std::string_view op, Cursor& cursor) {
    if (op == "unreachable" || op == "resume") return;
    if (op == "ret") {
        const Type* const type = module_.read_type(cursor);
        add_return_state(frame, state, type->kind == Type::Kind::nothing ? Value() : value(state, *type, cursor));
        return;
    }
    if (op == "indirectbr") fail("a jump to a computed place is not followed");
    if (op == "switch") return run_switch(frame, state, cursor);

    // `br label %NEXT`, or `br i1 CONDITION, label %IF_TRUE, label %IF_FALSE`
    if (cursor.peek() == 'l') return branch(frame, state, yes, take_label(cursor));
    const Type* const type = module_.read_type(cursor);
    const Mask when = mask_of(value(state, *type, cursor));
    cursor.expect(",");
    const std::string true_label = take_label(cursor);
    cursor.expect(",");
    branch(frame, state, when, true_label);
    branch(frame, state, nodes_.logical_not(when), take_label(cursor));
}

/// Enters the targets of `switch TYPE VALUE, label %DEFAULT [ TYPE CONSTANT, label %TARGET ... ]`.
void Walk::run_switch(CallFrame& frame, MemoryState& state, Cursor& cursor) {
    const Type* const type = module_.read_type(cursor);
    const std::vector<PossibleValue> cases = cases_of(value(state, *type, cursor), *type);
    cursor.expect(",");
    const std::string default_label = take_label(cursor);

    // Collects the decision that leads to each target.
    std::map<std::string, Mask> targets;
    std::vector<bool> has_target(cases.size());
    cursor.expect("[");
    while (!cursor.take("]")) {
        const Type* const case_type = module_.read_type(cursor);
        const std::int64_t x = cases_of(constant(state, *case_type, cursor), *case_type)[0].value;
        cursor.expect(",");
        Mask& when = targets.try_emplace(take_label(cursor), no).first->second;
        for (std::size_t k = 0; k < cases.size(); ++k) {
            if (cases[k].value != x) continue;
            when = nodes_.logical_or(when, cases[k].when);
            has_target[k] = true;
        }
    }

    // All other values lead to the default.
    Mask& default_decision = targets.try_emplace(default_label, no).first->second;
    for (std::size_t k = 0; k < cases.size(); ++k)
        if (!has_target[k]) default_decision = nodes_.logical_or(default_decision, cases[k].when);
    for (const auto& [target, when] : targets) branch(frame, state, when, target);
}

Value Walk::compute(MemoryState& state, std::string_view op, Cursor& cursor) {
    // Memory
    if (op == "alloca") {
        cursor.take("inalloca");
        static_cast<void>(module_.read_type(cursor));
        return integer_from_cases({{yes, add_object(state), 0}}, 8);
    }
    if (op == "load") return run_load(state, cursor);
    if (op == "store") {
        run_store(state, cursor);
        return {};
    }
    if (op == "getelementptr") return element_address(state, cursor);

    // Arithmetic and decisions
    if (op == "fadd" || op == "fsub" || op == "fmul" || op == "fdiv" || op == "fneg" || op == "frem")
        return arithmetic(state, op, cursor);
    if (op == "fcmp") return compare_numbers(state, cursor);
    if (op == "icmp") return compare_integers(state, cursor);
    if (std::ranges::find(integer_operations, op) != integer_operations.end())
        return integer_arithmetic(state, op, cursor);
    if (op == "select") return run_select(state, cursor);

    // The same value in another form
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
    fail("the instruction " + std::string(op) + " of LLVM IR is not followed");
}

/// Performs `load TYPE, ptr ADDRESS`.
Value Walk::run_load(MemoryState& state, Cursor& cursor) {
    cursor.take("atomic");
    skip_flags(cursor);
    const Type* const type = module_.read_type(cursor);
    cursor.expect(",");
    const Type* const pointer = module_.read_type(cursor);
    return load(state, value(state, *pointer, cursor), type->size);
}

/// Performs `store TYPE VALUE, ptr ADDRESS`, and names the value after the variable at the address.
void Walk::run_store(MemoryState& state, Cursor& cursor) {
    cursor.take("atomic");
    skip_flags(cursor);
    const Type* const type = module_.read_type(cursor);
    const Value stored_value = value(state, *type, cursor);
    cursor.expect(",");
    const Type* const pointer = module_.read_type(cursor);
    const Value address = value(state, *pointer, cursor);

    for (const PossibleValue& c : cases_of(address, *pointer)) {
        const auto variable = variables_.find(c.memory_object);
        if (variable == variables_.end() || c.value < 0) continue;
        const auto& [variable_metadata, depth] = variable->second;
        name_value(variable_metadata, stored_value, static_cast<std::size_t>(c.value), depth);
    }
    store(state, address, type->size, stored_value);
}

/// Performs `select CONDITION, TYPE A, TYPE B`. A vector of conditions selects lane by lane.
Value Walk::run_select(MemoryState& state, Cursor& cursor) {
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

Value Walk::arithmetic(MemoryState& state, std::string_view op, Cursor& cursor) {
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

/// Makes a vector of decisions, one byte each, from `decide_lane(type of a lane, offset)`.
template <class DecideLane>
Value Walk::map_to_masks(const Type& type, const DecideLane& decide_lane) {
    Value masks;
    for (std::size_t k = 0; k < type.count; ++k) {
        std::size_t offset = 0;
        const Type& lane = *type.part(k, offset);
        write_bytes(masks, k, 1, integer_from_mask(decide_lane(lane, offset)));
    }
    return masks;
}

Value Walk::compare_numbers(MemoryState& state, Cursor& cursor) {
    skip_flags(cursor);
    const std::string_view predicate = cursor.take_word();
    const Type* const type = module_.read_type(cursor);
    const Value a = value(state, *type, cursor);
    cursor.expect(",");
    const Value b = value(state, *type, cursor);
    if (predicate.size() < 3) cursor.fail("a comparison is unknown");

    if (!type->is_vector) return integer_from_mask(decide(predicate, number_of(a, *type), number_of(b, *type), cursor));
    return map_to_masks(*type, [&](const Type& lane, std::size_t offset) {
        return decide(predicate, number_of(extract_bytes(a, offset, lane.size), lane),
                      number_of(extract_bytes(b, offset, lane.size), lane), cursor);
    });
}

/// Compares two numbers. A predicate with `o` is false if one of them is NaN, and one with `u` is true: it is the
/// negation of the opposite predicate with `o`.
Mask Walk::decide(std::string_view predicate, NodeId x, NodeId y, const Cursor& cursor) {
    const auto compare = [&](TapeOp op) { return nodes_.compare(op, x, y); };
    const auto equal = [&] { return nodes_.logical_and(compare(TapeOp::less_equal), compare(TapeOp::greater_equal)); };
    const auto different = [&] { return nodes_.logical_or(compare(TapeOp::less), compare(TapeOp::greater)); };
    const auto ordered = [&] {
        return nodes_.logical_and(nodes_.compare(TapeOp::less_equal, x, x), nodes_.compare(TapeOp::less_equal, y, y));
    };

    // Constants, equality and order
    if (predicate == "true") return yes;
    if (predicate == "false") return no;
    if (predicate == "oeq") return equal();
    if (predicate == "une") return nodes_.logical_not(equal());
    if (predicate == "one") return different();
    if (predicate == "ueq") return nodes_.logical_not(different());
    if (predicate == "ord") return ordered();
    if (predicate == "uno") return nodes_.logical_not(ordered());

    // Less and greater
    if (predicate == "olt") return compare(TapeOp::less);
    if (predicate == "ole") return compare(TapeOp::less_equal);
    if (predicate == "ogt") return compare(TapeOp::greater);
    if (predicate == "oge") return compare(TapeOp::greater_equal);
    if (predicate == "ult") return nodes_.logical_not(compare(TapeOp::greater_equal));
    if (predicate == "ule") return nodes_.logical_not(compare(TapeOp::greater));
    if (predicate == "ugt") return nodes_.logical_not(compare(TapeOp::less_equal));
    if (predicate == "uge") return nodes_.logical_not(compare(TapeOp::less));
    cursor.fail("a comparison is unknown");
}

Value Walk::compare_integers(MemoryState& state, Cursor& cursor) {
    skip_flags(cursor);
    const std::string_view predicate = cursor.take_word();
    const Type* const type = module_.read_type(cursor);
    const Value a = value(state, *type, cursor);
    cursor.expect(",");
    const Value b = value(state, *type, cursor);

    if (!type->is_vector) return integer_from_mask(decide(predicate, a, b, *type));
    return map_to_masks(*type, [&](const Type& lane, std::size_t offset) {
        return decide(predicate, extract_bytes(a, offset, lane.size), extract_bytes(b, offset, lane.size), lane);
    });
}

/// Compares two integers or addresses: joins the decisions under which the predicate holds.
Mask Walk::decide(std::string_view predicate, const Value& a, const Value& b, const Type& type) {
    Mask mask = no;
    const int bits = type.kind == Type::Kind::pointer ? 64 : type.bits;
    for (const PossibleValue& x : cases_of(a, type))
        for (const PossibleValue& y : cases_of(b, type)) {
            bool result = false;
            if (x.memory_object == y.memory_object) result = comparison_holds(predicate, x.value, y.value, bits);
            else if (predicate == "eq" || predicate == "ne") result = predicate == "ne";
            else fail("addresses of different objects are compared");
            if (result) mask = nodes_.logical_or(mask, nodes_.logical_and(x.when, y.when));
        }
    return mask;
}

}  // namespace lostbits::intersect::function
