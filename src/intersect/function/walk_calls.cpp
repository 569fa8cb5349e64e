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
namespace {

constexpr std::string_view llvm_prefix = "llvm.";

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

/// A function that returns one of two integers: the first one if the predicate of icmp holds for them.
struct ExtremumFunction {
    const char* name;
    const char* predicate;
};
constexpr std::array extremum_functions{ExtremumFunction{"smax", "sgt"}, ExtremumFunction{"smin", "slt"},
                                        ExtremumFunction{"umax", "ugt"}, ExtremumFunction{"umin", "ult"}};

/// True if the function is `word`: in LLVM with or without types after it, `llvm.WORD.f32`; in C as `WORD` or `WORDf`.
bool is_name_of(std::string_view name, std::string_view word) {
    if (name.starts_with(llvm_prefix)) {
        const std::string_view base = name.substr(llvm_prefix.size());
        return base == word || (base.starts_with(word) && base[word.size()] == '.');
    }
    return name == word || (name.size() == word.size() + 1 && name.starts_with(word) && name.back() == 'f');
}

/// Skips the calling convention and the attributes in front of the returned type.
void skip_to_returned_type(Cursor& cursor) {
    for (;;) {
        Cursor ahead = cursor;
        const std::string_view word = ahead.take_word();
        if (word.empty() || word == "void" || word == "float" || word == "double" || word == "ptr" ||
            (word[0] == 'i' && word.size() > 1 && std::isdigit(static_cast<unsigned char>(word[1])) != 0) ||
            word == "half" || word == "x86_fp80")
            return;
        cursor = ahead;
        if (cursor.peek() == '(') cursor.take_group();
        else if (word == "align") cursor.take_integer();
    }
}

/// True for functions that end the program.
bool never_returns(const std::string& name) {
    constexpr std::array ending_functions{"abort",           "exit",        "__assert_fail",     "llvm.trap",
                                          "_ZSt9terminatev", "__cxa_throw", "__cxa_pure_virtual"};
    return std::ranges::find(ending_functions, name) != ending_functions.end() ||
           name.find("panic") != std::string::npos;
}

}  // namespace

// Calls

/// Performs a call of an intrinsic or of a function of the C library. Returns nothing for any other function.
std::optional<Value> Walk::run_known_function(MemoryState& state, const std::string& name, const Type& type,
                                              const std::vector<Value>& arguments,
                                              const std::vector<const Type*>& types) {
    const bool returns_numbers =
        type.kind == Type::Kind::number || (type.is_vector && type.parts[0]->kind == Type::Kind::number);
    if (returns_numbers && !arguments.empty())
        if (auto result = run_number_function(name, type, arguments)) return result;
    if (auto result = run_memory_function(state, name, arguments, types)) return result;
    return run_llvm_function(name, type, arguments, types);
}

/// Performs a function of numbers, lane by lane.
std::optional<Value> Walk::run_number_function(const std::string& name, const Type& type,
                                               const std::vector<Value>& arguments) {
    const auto is_function = [&](std::string_view word) { return is_name_of(name, word); };
    const auto apply_to_lanes = [&](std::size_t count, const auto& act) {
        return map_lanes(type, [&](const Type& lane, std::size_t first_byte) {
            std::vector<NodeId> x;
            for (std::size_t k = 0; k < count && k < arguments.size(); ++k)
                x.push_back(number_of(extract_bytes(arguments[k], first_byte, lane.size), lane));
            if (x.size() < count) fail("it calls " + source_name(name) + " with too few arguments");
            return number(act(x));
        });
    };
    const auto apply = [&](std::size_t count, TapeOp op) {
        return apply_to_lanes(count, [&](const std::vector<NodeId>& x) {
            return nodes_.arithmetic(op, x[0], count > 1 ? x[1] : no_node, count > 2 ? x[2] : no_node);
        });
    };

    // Functions of one number
    if (is_function("sqrt")) return apply(1, TapeOp::sqrt);
    if (is_function("fabs")) return apply(1, TapeOp::abs);
    for (const RoundingFunction& r : rounding_functions)
        if (is_function(r.name))
            return apply_to_lanes(1, [&](const auto& x) { return nodes_.round_to_whole(r.rounding, x[0]); });

    // Functions of two numbers
    if (arguments.size() < 2) return {};
    if ((is_function("pow") || is_function("powi")) && is_two(arguments[1]))  // compilers multiply
        return apply_to_lanes(1, [&](const auto& x) { return nodes_.arithmetic(TapeOp::mul, x[0], x[0]); });
    if (is_function("copysign")) return apply(2, TapeOp::copysign);
    if (is_function("minnum") || is_function("fmin") || is_function("minimumnum"))
        return apply_to_lanes(2, [&](const auto& x) { return nodes_.minimum_or_maximum(TapeOp::min, x[0], x[1]); });
    if (is_function("maxnum") || is_function("fmax") || is_function("maximumnum"))
        return apply_to_lanes(2, [&](const auto& x) { return nodes_.minimum_or_maximum(TapeOp::max, x[0], x[1]); });

    // Functions of three numbers
    if (arguments.size() < 3) return {};
    if (is_function("fma")) return apply(3, TapeOp::fma);
    if (is_function("fmuladd"))
        return apply_to_lanes(3, [&](const auto& x) {
            return nodes_.arithmetic(TapeOp::add, nodes_.arithmetic(TapeOp::mul, x[0], x[1]), x[2]);
        });
    return {};
}

/// True if a value is the number 2, as an integer or a floating-point constant.
bool Walk::is_two(const Value& value) const {
    const Scalar s = value.empty() ? Scalar() : value.begin()->second.scalar;
    if (s.kind == Scalar::Kind::integer) return s.cases.size() == 1 && s.cases[0].value == 2;
    return s.kind == Scalar::Kind::number && nodes_[s.node].op == TapeOp::constant && nodes_[s.node].value == 2;
}

/// Performs memcpy, memmove and memset, which return the address of their target.
std::optional<Value> Walk::run_memory_function(MemoryState& state, const std::string& name,
                                               const std::vector<Value>& arguments,
                                               const std::vector<const Type*>& types) {
    const bool copies = is_name_of(name, "memcpy") || is_name_of(name, "memmove");
    if (arguments.size() < 3 || (!copies && !is_name_of(name, "memset"))) return {};
    const std::vector<PossibleValue> byte_counts = cases_of(arguments[2], *types[2]);
    if (byte_counts.size() != 1 || byte_counts[0].value < 0 || byte_counts[0].value > (1 << 20))
        fail("the number of bytes that it copies or fills depends on numbers");
    const auto n = static_cast<std::size_t>(byte_counts[0].value);

    if (!copies) {
        const Value filled = filled_bytes(cases_of(arguments[1], *types[1]), n);
        if (n > 0) store(state, arguments[0], n, filled);
        return arguments[0];
    }
    if (n == 0) return arguments[0];
    const Value copied = load(state, arguments[1], n);
    for (const PossibleValue& c : cases_of(arguments[0], *types[0]))
        if (const auto v = variables_.find(c.memory_object); v != variables_.end() && c.value >= 0)
            name_value(v->second.first, copied, static_cast<std::size_t>(c.value), v->second.second);
    store(state, arguments[0], n, copied);
    return arguments[0];
}

/// Repeats a byte n times. Zeros are one integer, of any size.
Value Walk::filled_bytes(const std::vector<PossibleValue>& byte, std::size_t n) {
    if (byte.size() == 1 && byte[0].value == 0) return integer_from_cases(byte, n);
    if (n > 4096) fail("it fills more than 4096 bytes with a value other than 0");
    Value filled;
    for (std::size_t k = 0; k < n; ++k) write_bytes(filled, k, 1, integer_from_cases(byte, 1));
    return filled;
}

/// Performs other functions of LLVM.
std::optional<Value> Walk::run_llvm_function(const std::string& name, const Type& type,
                                             const std::vector<Value>& arguments,
                                             const std::vector<const Type*>& types) {
    if (!name.starts_with(llvm_prefix)) return {};
    const auto is_function = [&](std::string_view word) { return is_name_of(name, word); };

    // Hints to the optimiser
    for (const char* const hint :
         {"lifetime", "assume", "experimental.noalias.scope.decl", "stackrestore", "donothing", "va_start", "va_end"})
        if (is_function(hint)) return Value();
    if (is_function("expect") && !arguments.empty()) return arguments[0];
    if (is_function("stacksave")) return integer_from_cases({{yes, 0, 0}}, 8);
    if (is_function("is.constant")) return integer(0, type);

    // Functions of integers
    for (const auto& [function, predicate] : extremum_functions)
        if (arguments.size() >= 2 && is_function(function))
            return choose_by_comparison(predicate, type, arguments[0], arguments[1]);
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

    // Tests of numbers: only the test for NaN, quiet or signalling.
    if (is_function("is.fpclass") && arguments.size() >= 2) {
        const NodeId x = number_of(arguments[0], *types[0]);
        const std::int64_t class_count = cases_of(arguments[1], *types[1])[0].value;
        if (class_count == 3) return integer_from_mask(nodes_.is_nan(x));
    }
    return {};
}

/// Returns `a` where the predicate holds for a and b, and `b` elsewhere.
Value Walk::choose_by_comparison(std::string_view predicate, const Type& type, const Value& a, const Value& b) {
    std::vector<PossibleValue> chosen;
    for (const PossibleValue& x : cases_of(a, type))
        for (const PossibleValue& y : cases_of(b, type))
            chosen.push_back({nodes_.logical_and(x.when, y.when), 0,
                              comparison_holds(predicate, x.value, y.value, type.bits) ? x.value : y.value});
    return integer_from_cases(merge_duplicates(std::move(chosen)), type.size);
}

std::optional<Value> Walk::run_call_instruction(MemoryState& state, Cursor& cursor) {
    // Reads `TYPE @NAME(TYPE ARGUMENT, ...)`.
    const int call_place = nodes_.place;
    skip_flags(cursor);
    skip_to_returned_type(cursor);
    const Type* type = module_.read_type(cursor);
    if (cursor.take("asm")) fail("inline assembly is not followed");
    const std::string name = read_callee(state, cursor);
    std::vector<const Type*> types;
    std::vector<Value> arguments = read_arguments(state, cursor, types);

    if (name.starts_with(spirv::refusal_prefix)) fail(name.substr(std::string_view(spirv::refusal_prefix).size()));
    if (auto known_result = run_known_function(state, name, *type, arguments, types)) return known_result;

    // A function of the file
    if (const IrFunction* const f = module_.find_function(name)) {
        auto result = run_function(*f, std::move(arguments), std::move(state), call_place);
        nodes_.place = call_place;
        if (!result) return {};
        state = std::move(result->first);
        return std::move(result->second);
    }

    if (never_returns(name)) return {};
    fail("it calls " + source_name(name) +
         ", which is not followed: operations are + - * / sqrt fma fabs copysign fmin fmax pow(x, 2) floor ceil trunc "
         "round roundeven rint nearbyint and comparisons; to measure this function's answers all the same, call it "
         "from a plugin (docs/your-own-intersector.md)");
}

/// Reads the function that is called: by its name, by an address that is known, or by its name in a cast.
std::string Walk::read_callee(MemoryState& state, Cursor& cursor) {
    if (cursor.take("%")) {
        const std::vector<PossibleValue> callee =
            cases_of(state.registers[cursor.take_name()], *module_.pointer_type());
        const auto callee_name = function_objects_.find(callee[0].memory_object);
        if (callee.size() != 1 || callee_name == function_objects_.end())
            fail("a function that is chosen at run time (a virtual call or a pointer to a function) is not followed");
        return callee_name->second;
    }
    if (cursor.take("@")) return cursor.take_name();
    if (cursor.take("bitcast")) {
        Cursor inside(cursor.take_group());
        while (!inside.at_end() && inside.peek() != '@') inside = Cursor(inside.rest().substr(1));
        inside.expect("@");
        return inside.take_name();
    }
    fail("a function that is chosen at run time is not followed");
}

/// Reads the arguments of a call in brackets, up to the first one that is metadata, and sets their types.
std::vector<Value> Walk::read_arguments(MemoryState& state, Cursor& cursor, std::vector<const Type*>& types) {
    Cursor argument_cursor(cursor.take_group());
    std::vector<Value> arguments;
    while (!argument_cursor.at_end()) {
        types.push_back(module_.read_type(argument_cursor));
        const bool is_metadata =
            types.back()->size == 16 && types.back()->kind == Type::Kind::other && argument_cursor.peek() == '!';
        if (is_metadata) {
            arguments.emplace_back();
            break;
        }
        arguments.push_back(value(state, *types.back(), argument_cursor));
        if (!argument_cursor.take(",")) break;
    }
    return arguments;
}

}  // namespace lostbits::intersect::function
