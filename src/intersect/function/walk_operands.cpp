// Operands of instructions: registers, constants and addresses.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#include "intersect/function/walk.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {

// Operands

NodeId Walk::read_literal(const Type& type, Cursor& cursor) {
    const std::string_view text = cursor.rest();
    std::size_t n = 0;
    while (n < text.size() && (std::isalnum(static_cast<unsigned char>(text[n])) != 0 || text[n] == '.' ||
                               text[n] == '-' || text[n] == '+'))
        ++n;
    const std::string_view digits = text.substr(0, n);
    cursor = Cursor(text.substr(n));
    double x = 0;
    if (digits.starts_with("0x")) {
        std::uint64_t bits = 0;
        const auto [end, error] = std::from_chars(digits.data() + 2, digits.data() + digits.size(), bits, 16);
        if (error != std::errc() || end != digits.data() + digits.size()) cursor.fail("a number cannot be read");
        x = std::bit_cast<double>(bits);
    } else {
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
        if (error != std::errc() || end != digits.data() + digits.size()) cursor.fail("a number cannot be read");
    }
    if (type.bits < nodes_.bits()) fail("a function of double that computes in float inside is not followed");
    return nodes_.constant(x, type.bits > nodes_.bits());
}

Value Walk::address_of(State& state, const std::string& name) {
    const auto [known_object, is_new] = global_objects_.try_emplace(name, 0);
    if (is_new) {
        known_object->second = new_object(state, false);
        const int object = known_object->second;
        if (const auto global = module_.globals.find(name); global != module_.globals.end()) {
            global_memory_[object] = {};
            if (!global->second.value.empty()) {
                Cursor cursor(global->second.value);
                Value initial = constant(state, *global->second.type, cursor);
                global_memory_[object] = std::move(initial);
            }
        } else {
            function_objects_[object] = name;
        }
    }
    return integer_from_cases({{yes, known_object->second, 0}}, 8);
}

/// Reads the operands of getelementptr in an instruction or in a constant, such as `(TYPE, ptr BASE, i64 0, i32 1)`,
/// and returns the address.
Value Walk::element_address(State& state, Cursor& cursor) {
    skip_flags(cursor);
    if (cursor.take("inrange")) cursor.take_group();
    const bool is_constant = cursor.take("(");
    const Type* type = module_.read_type(cursor);
    cursor.expect(",");
    const Type* const pointer = module_.read_type(cursor);
    if (pointer->is_vector) fail("vectors of addresses are not followed");
    std::vector<Case> cases = cases_of(value(state, *pointer, cursor), *pointer);
    for (bool first = true; cursor.take(","); first = false) {
        if (cursor.peek() == '!') break;
        cursor.take("inrange");
        const Type* const index_type = module_.read_type(cursor);
        const std::vector<Case> index = cases_of(value(state, *index_type, cursor), *index_type);
        if (!first && type->kind == Type::Kind::structure) {
            std::size_t offset = 0;
            const Type* const part = index.size() == 1 && index[0].value >= 0
                                         ? type->part(static_cast<std::size_t>(index[0].value), offset)
                                         : nullptr;
            if (part == nullptr) fail("an address is outside of its type");
            for (Case& c : cases) c.value = static_cast<std::int64_t>(static_cast<std::uint64_t>(c.value) + offset);
            type = part;
            continue;
        }
        if (!first) {
            if (type->kind != Type::Kind::sequence) fail("an address is outside of its type");
            type = type->parts[0];
        }
        std::vector<Case> combined;
        for (const Case& a : cases)
            for (const Case& i : index)
                combined.push_back({nodes_.logical_and(a.when, i.when), a.memory_object,
                                    static_cast<std::int64_t>(static_cast<std::uint64_t>(a.value) +
                                                              static_cast<std::uint64_t>(i.value) * type->size)});
        cases = merge_duplicates(std::move(combined));
    }
    if (is_constant) cursor.expect(")");
    return integer_from_cases(std::move(cases), 8);
}

Value Walk::constant(State& state, const Type& type, Cursor& cursor) {
    struct Nesting {
        int& depth;
        explicit Nesting(int& d) : depth(d) { ++depth; }
        ~Nesting() { --depth; }
        Nesting(const Nesting&) = delete;
        Nesting& operator=(const Nesting&) = delete;
    } const nesting(nesting_);
    if (nesting_ > 100) cursor.fail("a constant is nested too deeply");
    const char first_character = cursor.peek();
    if (first_character == '@') {
        cursor.expect("@");
        return address_of(state, cursor.take_name());
    }
    if (first_character == '{' || first_character == '[' || first_character == '<') {
        Cursor inside(cursor.take_group());
        const bool packed = first_character == '<' && inside.peek() == '{';
        if (packed) inside = Cursor(inside.take_group());
        Value result;
        for (std::size_t k = 0; !inside.at_end(); ++k) {
            const Type* const part_type = module_.read_type(inside);
            std::size_t offset = 0;
            const Type* const part = type.part(k, offset);
            if (part == nullptr || part->size != part_type->size) inside.fail("a constant has another type");
            write_bytes(result, offset, part->size, value(state, *part, inside));
            if (!inside.take(",")) break;
        }
        return result;
    }
    if (cursor.take("zeroinitializer") || cursor.take("null")) return zero_value(type);
    if (cursor.take("undef") || cursor.take("poison") || cursor.take("none")) return {};
    if (cursor.take("true")) return integer(1, type);
    if (cursor.take("false")) return integer(0, type);
    if (cursor.take("splat")) {
        Cursor inside(cursor.take_group());
        const Type* const lane = module_.read_type(inside);
        const Value lane_value = value(state, *lane, inside);
        return map_lanes(type, [&](const Type&, std::size_t) { return lane_value; });
    }
    if (cursor.take("getelementptr")) return element_address(state, cursor);
    for (const char* const op : {"bitcast", "inttoptr", "ptrtoint", "addrspacecast", "trunc", "zext"}) {
        if (!cursor.take(op)) continue;
        Cursor inside(cursor.take_group());
        return convert(state, op, inside);
    }
    if (cursor.rest().starts_with("c\"")) {
        cursor.expect("c");
        const std::string text = cursor.take_name();
        Value result;
        std::size_t k = 0;
        for (std::size_t i = 0; i < text.size() && k < type.count; ++i, ++k) {
            int byte = static_cast<unsigned char>(text[i]);
            if (text[i] == '\\' && i + 2 < text.size()) {
                std::from_chars(text.data() + i + 1, text.data() + i + 3, byte, 16);
                i += 2;
            }
            write_bytes(result, k, 1, integer_from_cases({{yes, 0, static_cast<signed char>(byte)}}, 1));
        }
        return result;
    }
    if (type.kind == Type::Kind::number) return number(read_literal(type, cursor));
    if (type.kind == Type::Kind::integer) {
        if (type.bits > 64) fail("integers of more than 64 bits are not followed");
        Cursor text = cursor;
        const std::string_view digits = cursor.take_word();
        std::int64_t x = 0;
        std::uint64_t u = 0;
        const char* const end = digits.data() + digits.size();
        if (std::from_chars(digits.data(), end, x).ptr != end) x = 0;
        else return integer(wrap(static_cast<std::uint64_t>(x), type.bits), type);
        if (digits.empty() || std::from_chars(digits.data(), end, u).ptr != end) text.fail("a constant cannot be read");
        return integer(wrap(u, type.bits), type);
    }
    cursor.fail("a constant cannot be read");
}

Value Walk::value(State& state, const Type& type, Cursor& cursor) {
    if (cursor.rest().size() > 2'000'000) cursor.fail("a line is too long");
    module_.skip_attributes(cursor);
    if (cursor.take("%")) {
        const std::string name = cursor.take_name();
        const auto entry = state.registers.find(name);
        if (entry == state.registers.end()) fail("the LLVM IR uses %" + name + ", which is not set here");
        return entry->second;
    }
    return constant(state, type, cursor);
}

}  // namespace lostbits::intersect::function
