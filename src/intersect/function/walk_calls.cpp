// Calls of functions of the file, and of functions whose meaning is known.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#include "intersect/function/walk.hpp"
#include "intersect/spirv/llvm_text.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {

// Calls

/// Performs a call of an intrinsic or of a function of the C library. Returns nothing for any other function.
std::optional<Value> Walk::run_known_function(State& state, const std::string& name, const Type& type,
                                              const std::vector<Value>& arguments,
                                              const std::vector<const Type*>& types) {
    std::string_view base = name;
    const bool is_llvm = base.starts_with("llvm.");
    if (is_llvm) base.remove_prefix(5);
    const auto is_function = [&](std::string_view word) {
        if (is_llvm) return base == word || (base.starts_with(word) && base[word.size()] == '.');
        return base == word || (base.size() == word.size() + 1 && base.starts_with(word) && base.back() == 'f');
    };
    const auto apply_to_lanes = [&](std::size_t count, const auto& act) {
        return map_lanes(type, [&](const Type& lane, std::size_t first_byte) {
            std::vector<NodeId> x;
            for (std::size_t k = 0; k < count && k < arguments.size(); ++k)
                x.push_back(number_of(extract_bytes(arguments[k], first_byte, lane.size), lane));
            if (x.size() < count) fail("it calls " + source_name(name) + " with too few arguments");
            return number(act(x));
        });
    };
    const bool returns_numbers =
        type.kind == Type::Kind::number || (type.is_vector && type.parts[0]->kind == Type::Kind::number);
    if (returns_numbers && arguments.size() >= 1) {
        if (is_function("sqrt"))
            return apply_to_lanes(1, [&](const auto& x) { return nodes_.arithmetic(TapeOp::sqrt, x[0]); });
        if (is_function("fabs"))
            return apply_to_lanes(1, [&](const auto& x) { return nodes_.arithmetic(TapeOp::abs, x[0]); });
        struct RoundingFunction {
            const char* name;
            Nodes::WholeNumber rounding;
        };
        constexpr std::array rounding_functions{RoundingFunction{"floor", Nodes::WholeNumber::below},
                                                RoundingFunction{"ceil", Nodes::WholeNumber::above},
                                                RoundingFunction{"trunc", Nodes::WholeNumber::towards_zero},
                                                RoundingFunction{"round", Nodes::WholeNumber::nearest_or_away},
                                                RoundingFunction{"roundeven", Nodes::WholeNumber::nearest_or_even},
                                                RoundingFunction{"rint", Nodes::WholeNumber::nearest_or_even},
                                                RoundingFunction{"nearbyint", Nodes::WholeNumber::nearest_or_even}};
        for (const RoundingFunction& r : rounding_functions)
            if (is_function(r.name))
                return apply_to_lanes(1, [&](const auto& x) { return nodes_.round_to_whole(r.rounding, x[0]); });
        if (arguments.size() >= 2) {
            const auto is_two = [&](const Value& exponent) {
                const Scalar s = exponent.empty() ? Scalar() : exponent.begin()->second.scalar;
                if (s.kind == Scalar::Kind::integer) return s.cases.size() == 1 && s.cases[0].value == 2;
                return s.kind == Scalar::Kind::number && nodes_[s.node].op == TapeOp::constant &&
                       nodes_[s.node].value == 2;
            };
            if ((is_function("pow") || is_function("powi")) && is_two(arguments[1]))  // compilers multiply
                return apply_to_lanes(1, [&](const auto& x) { return nodes_.arithmetic(TapeOp::mul, x[0], x[0]); });
            if (is_function("copysign"))
                return apply_to_lanes(2,
                                      [&](const auto& x) { return nodes_.arithmetic(TapeOp::copysign, x[0], x[1]); });
            if (is_function("minnum") || is_function("fmin") || is_function("minimumnum"))
                return apply_to_lanes(
                    2, [&](const auto& x) { return nodes_.minimum_or_maximum(TapeOp::min, x[0], x[1]); });
            if (is_function("maxnum") || is_function("fmax") || is_function("maximumnum"))
                return apply_to_lanes(
                    2, [&](const auto& x) { return nodes_.minimum_or_maximum(TapeOp::max, x[0], x[1]); });
        }
        if (arguments.size() >= 3) {
            if (is_function("fma"))
                return apply_to_lanes(3,
                                      [&](const auto& x) { return nodes_.arithmetic(TapeOp::fma, x[0], x[1], x[2]); });
            if (is_function("fmuladd"))
                return apply_to_lanes(3, [&](const auto& x) {
                    return nodes_.arithmetic(TapeOp::add, nodes_.arithmetic(TapeOp::mul, x[0], x[1]), x[2]);
                });
        }
    }
    const auto byte_count_of = [&](std::size_t k) -> std::size_t {
        const std::vector<Case> n = cases_of(arguments[k], *types[k]);
        if (n.size() != 1 || n[0].value < 0 || n[0].value > (1 << 20))
            fail("the number of bytes that it copies or fills depends on numbers");
        return static_cast<std::size_t>(n[0].value);
    };
    if (arguments.size() >= 3 && (is_function("memcpy") || is_function("memmove"))) {
        const std::size_t n = byte_count_of(2);
        if (n == 0) return arguments[0];
        const Value copied = load(state, arguments[1], n);
        for (const Case& c : cases_of(arguments[0], *types[0]))
            if (const auto v = variables_.find(c.memory_object); v != variables_.end() && c.value >= 0)
                name_value(v->second.first, copied, static_cast<std::size_t>(c.value), v->second.second);
        store(state, arguments[0], n, copied);
        return arguments[0];
    }
    if (arguments.size() >= 3 && is_function("memset")) {
        const std::size_t n = byte_count_of(2);
        const std::vector<Case> byte = cases_of(arguments[1], *types[1]);
        Value filled;
        if (byte.size() == 1 && byte[0].value == 0) filled = integer_from_cases(byte, n);
        else if (n > 4096) fail("it fills more than 4096 bytes with a value other than 0");
        else
            for (std::size_t k = 0; k < n; ++k) write_bytes(filled, k, 1, integer_from_cases(byte, 1));
        if (n > 0) store(state, arguments[0], n, filled);
        return arguments[0];
    }
    if (!is_llvm) return {};
    if (is_function("lifetime") || is_function("assume") || is_function("experimental.noalias.scope.decl") ||
        is_function("stackrestore") || is_function("donothing") || is_function("va_start") || is_function("va_end"))
        return Value();
    if (is_function("expect") && !arguments.empty()) return arguments[0];
    if (is_function("stacksave")) return integer_from_cases({{yes, 0, 0}}, 8);
    if (is_function("is.constant")) return integer(0, type);
    if (arguments.size() >= 2 &&
        (is_function("smax") || is_function("smin") || is_function("umax") || is_function("umin"))) {
        const std::string_view predicate = is_function("smax")   ? "sgt"
                                           : is_function("smin") ? "slt"
                                           : is_function("umax") ? "ugt"
                                                                 : "ult";
        std::vector<Case> extrema;
        for (const Case& x : cases_of(arguments[0], type))
            for (const Case& y : cases_of(arguments[1], type))
                extrema.push_back({nodes_.logical_and(x.when, y.when), 0,
                                   comparison_holds(predicate, x.value, y.value, type.bits) ? x.value : y.value});
        return integer_from_cases(merge_duplicates(std::move(extrema)), type.size);
    }
    for (const char* const op : {"sadd", "uadd", "ssub", "usub", "smul", "umul"}) {
        if (!is_function(std::string(op) + ".with.overflow") || arguments.size() < 2) continue;
        const Type& integer_type = *types[0];
        Value result_and_flag;
        write_bytes(result_and_flag, 0, integer_type.size,
                    combine_integers(std::string_view(op).substr(1), integer_type, arguments[0], arguments[1]));
        write_bytes(result_and_flag, integer_type.size, 1,
                    integer(0, *module_.integer_type(8)));  // a counter that wraps is not followed
        return result_and_flag;
    }
    if (is_function("is.fpclass") && arguments.size() >= 2) {
        const NodeId x = number_of(arguments[0], *types[0]);
        const std::int64_t classes = cases_of(arguments[1], *types[1])[0].value;
        if (classes == 3) return integer_from_mask(nodes_.is_nan(x));
    }
    return {};
}

std::optional<Value> Walk::run_call_instruction(Frame& frame, State& state, Cursor& cursor) {
    const int call_place = nodes_.place;
    skip_flags(cursor);
    // The type may be preceded by a calling convention and attributes.
    for (;;) {
        Cursor ahead = cursor;
        const std::string_view word = ahead.take_word();
        if (word.empty() || word == "void" || word == "float" || word == "double" || word == "ptr" ||
            (word[0] == 'i' && word.size() > 1 && std::isdigit(static_cast<unsigned char>(word[1])) != 0) ||
            word == "half" || word == "x86_fp80")
            break;
        cursor = ahead;
        if (cursor.peek() == '(') cursor.take_group();
        else if (word == "align") cursor.take_integer();
    }
    const Type* type = module_.read_type(cursor);
    if (cursor.take("asm")) fail("inline assembly is not followed");
    std::string name;
    if (cursor.take("%")) {
        const std::vector<Case> callee = cases_of(state.registers[cursor.take_name()], *module_.pointer_type());
        const auto callee_name = function_objects_.find(callee[0].memory_object);
        if (callee.size() != 1 || callee_name == function_objects_.end())
            fail("a function that is chosen at run time (a virtual call or a pointer to a function) is not followed");
        name = callee_name->second;
    } else if (cursor.take("@")) {
        name = cursor.take_name();
    } else if (cursor.take("bitcast")) {
        Cursor inside(cursor.take_group());
        while (!inside.at_end() && inside.peek() != '@') inside = Cursor(inside.rest().substr(1));
        inside.expect("@");
        name = inside.take_name();
    } else {
        fail("a function that is chosen at run time is not followed");
    }
    Cursor argument_cursor(cursor.take_group());
    std::vector<Value> arguments;
    std::vector<const Type*> types;
    while (!argument_cursor.at_end()) {
        types.push_back(module_.read_type(argument_cursor));
        if (types.back()->size == 16 && types.back()->kind == Type::Kind::other && argument_cursor.peek() == '!') {
            arguments.emplace_back();  // metadata
            argument_cursor = Cursor("");
            break;
        }
        arguments.push_back(value(state, *types.back(), argument_cursor));
        if (!argument_cursor.take(",")) break;
    }
    if (name.starts_with(spirv::refusal_prefix)) fail(name.substr(std::string_view(spirv::refusal_prefix).size()));
    if (auto known_result = run_known_function(state, name, *type, arguments, types)) return known_result;
    if (const IrFunction* const f = module_.find_function(name)) {
        auto result = run_function(*f, std::move(arguments), std::move(state), call_place);
        nodes_.place = call_place;
        if (!result) return {};
        state = std::move(result->first);
        return std::move(result->second);
    }
    constexpr std::array ending_functions{"abort",           "exit",        "__assert_fail",     "llvm.trap",
                                          "_ZSt9terminatev", "__cxa_throw", "__cxa_pure_virtual"};
    if (std::ranges::find(ending_functions, name) != ending_functions.end() || name.find("panic") != std::string::npos)
        return {};
    static_cast<void>(frame);
    fail("it calls " + source_name(name) +
         ", which is not followed: operations are + - * / sqrt fma fabs copysign fmin fmax pow(x, 2) floor ceil trunc "
         "round roundeven rint nearbyint and comparisons; to measure this function's answers all the same, call it "
         "from a "
         "plugin (docs/your-own-intersector.md)");
}

}  // namespace lostbits::intersect::function
