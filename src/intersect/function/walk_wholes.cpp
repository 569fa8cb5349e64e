// Integers, their bits, conversions, and parts of vectors and structures.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <utility>

#include "intersect/function/walk.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

/// Returns the bits of an integer with one known value; nothing for an address or any other value.
std::optional<std::uint64_t> known_bits(const Value& value, int bits) {
    if (value.size() != 1 || value.begin()->second.scalar.kind != Scalar::Kind::integer) return {};
    const auto& cases = value.begin()->second.scalar.cases;
    if (cases.size() != 1 || cases[0].memory_object != 0) return {};
    return as_unsigned(cases[0].value, bits);
}

bool contains_number(const Value& value) {
    return std::ranges::any_of(value,
                               [](const auto& entry) { return entry.second.scalar.kind == Scalar::Kind::number; });
}

bool is_zero(const MemoryCell& cell) {
    return cell.scalar.kind == Scalar::Kind::integer && cell.scalar.cases.size() == 1 &&
           cell.scalar.cases[0].memory_object == 0 && cell.scalar.cases[0].value == 0;
}

/// Returns the part of a structure or array that the indices at the cursor select, and its offset in bytes.
std::pair<const Type*, std::size_t> indexed_part(const Type& type, Cursor& cursor) {
    const Type* part = &type;
    std::size_t offset = 0;
    while (cursor.take(",") && cursor.peek() != '!') {
        std::size_t part_offset = 0;
        part = part->part(static_cast<std::size_t>(cursor.take_integer()), part_offset);
        if (part == nullptr) cursor.fail("an index is outside of its type");
        offset += part_offset;
    }
    return {part, offset};
}

}  // namespace

/// Performs the operations on the bits of numbers that compilers and programmers use: a change of the sign, and joining
/// parts side by side. Returns nothing for any other operation.
std::optional<Value> Walk::bit_operation(std::string_view op, const Type& type, const Value& a, const Value& b) {
    const auto is_number = [&](const Value& v) {
        return v.size() == 1 && v.begin()->second.scalar.kind == Scalar::Kind::number &&
               v.begin()->second.size == type.size && nodes_[v.begin()->second.scalar.node].op != TapeOp::constant;
    };
    if (is_number(b) && !is_number(a) && (op == "and" || op == "or" || op == "xor"))
        return bit_operation(op, type, b, a);

    // Operations on the sign of a number.
    const auto mask = known_bits(b, type.bits);
    if (is_number(a) && mask) {
        const std::uint64_t sign_bit = std::uint64_t{1} << (type.bits - 1), other_bits = sign_bit - 1;
        const NodeId x = a.begin()->second.scalar.node;
        if (op == "xor" && *mask == sign_bit) return number(nodes_.arithmetic(TapeOp::neg, x));
        if (op == "and" && *mask == other_bits) return number(nodes_.arithmetic(TapeOp::abs, x));
        if (op == "or" && *mask == sign_bit)
            return number(nodes_.arithmetic(TapeOp::neg, nodes_.arithmetic(TapeOp::abs, x)));
    }

    // Integers are combined elsewhere.
    if (!contains_number(a) && !contains_number(b)) return {};

    if ((op == "lshr" || op == "shl") && mask && *mask % 8 == 0 && *mask / 8 < type.size) {
        const std::size_t moved_by = *mask / 8, kept = type.size - moved_by;
        if (op == "lshr") return fill_with_zeros(extract_bytes(a, moved_by, kept), type.size);
        Value shifted;
        write_bytes(shifted, moved_by, kept, extract_bytes(a, 0, kept));
        return fill_with_zeros(shifted, type.size);
    }
    if (op == "or") return join_parts(type, a, b);
    return {};
}

/// Sets the bytes without a scalar to 0.
Value Walk::fill_with_zeros(const Value& value, std::size_t size) {
    Value result;
    write_bytes(result, 0, size, integer_from_cases({{yes, 0, 0}}, size));
    for (const auto& [offset, cell] : value) write_bytes(result, offset, cell.size, {{0, cell}});
    return result;
}

/// Joins two values of which each is 0 in the bytes that the other one sets. Returns nothing for other values.
std::optional<Value> Walk::join_parts(const Type& type, const Value& a, const Value& b) {
    Value result = fill_with_zeros({}, type.size);
    std::vector<bool> is_used(type.size);  // true for bytes that one of the operands sets
    for (const Value* v : {&a, &b})
        for (const auto& [offset, cell] : *v) {
            if (is_zero(cell)) continue;
            for (std::size_t k = offset; k < offset + cell.size; ++k) {
                if (is_used[k]) return {};
                is_used[k] = true;
            }
            write_bytes(result, offset, cell.size, {{0, cell}});
        }
    return result;
}

Value Walk::combine_integers(std::string_view op, const Type& type, const Value& a, const Value& b) {
    if (type.bits > 64) fail("integers of more than 64 bits are not followed");
    if (type.kind != Type::Kind::integer) fail("an operation on integers that has other operands is not followed");
    if (auto bit_result = bit_operation(op, type, a, b)) return *bit_result;

    // Decisions
    if (type.bits == 1 && (op == "and" || op == "or" || op == "xor")) {
        const Mask x = mask_of(a), y = mask_of(b);
        if (op == "and") return integer_from_mask(nodes_.logical_and(x, y));
        if (op == "or") return integer_from_mask(nodes_.logical_or(x, y));
        return integer_from_mask(nodes_.select_mask(x, nodes_.logical_not(y), y));
    }

    // Every value of one integer with every value of the other.
    std::vector<PossibleValue> cases;
    for (const PossibleValue& x : cases_of(a, type))
        for (const PossibleValue& y : cases_of(b, type)) {
            const int memory_object = combined_object(op, x, y);
            const auto result = integer_result(op, x.value, y.value, type.bits);
            if (!result && nodes_.logical_and(x.when, y.when) == yes) fail("an integer is divided by zero");
            cases.push_back({nodes_.logical_and(x.when, y.when), memory_object, result.value_or(0)});
        }
    return integer_from_cases(merge_duplicates(std::move(cases)), type.size);
}

/// Returns the object into which the result of an operation points; 0 for an integer. The difference of two addresses
/// in one object is an integer, and so is an address under a mask below 16.
int Walk::combined_object(std::string_view op, const PossibleValue& x, const PossibleValue& y) const {
    if (x.memory_object == 0 && y.memory_object == 0) return 0;
    const bool keeps_object =
        (op == "add" && (x.memory_object == 0 || y.memory_object == 0)) || (op == "sub" && y.memory_object == 0);
    if (keeps_object) return x.memory_object + y.memory_object;
    const bool gives_integer =
        (op == "sub" && x.memory_object == y.memory_object) || (op == "and" && y.memory_object == 0 && y.value < 16);
    if (!gives_integer) fail("arithmetic with an address is not followed");
    return 0;
}

Value Walk::integer_arithmetic(MemoryState& state, std::string_view op, Cursor& cursor) {
    skip_flags(cursor);
    const Type* const type = module_.read_type(cursor);
    const Value a = value(state, *type, cursor);
    cursor.expect(",");
    const Value b = value(state, *type, cursor);
    if (type->is_vector && type->size < type->count) fail("vectors of single bits are not followed");
    return map_lanes(*type, [&](const Type& lane, std::size_t offset) {
        return combine_integers(op, lane, extract_bytes(a, offset, lane.size), extract_bytes(b, offset, lane.size));
    });
}

/// Reads and performs a conversion, `TYPE VALUE to TYPE`.
Value Walk::convert(MemoryState& state, std::string_view op, Cursor& cursor) {
    skip_flags(cursor);
    const Type* const source_type = module_.read_type(cursor);
    const Value x = value(state, *source_type, cursor);
    cursor.expect("to");
    const Type* const target_type = module_.read_type(cursor);

    // Conversions that keep the bytes.
    if (op == "bitcast" || op == "addrspacecast") return x;
    if (op == "inttoptr" || op == "ptrtoint")
        return extract_bytes(x, 0, std::min(source_type->size, target_type->size));

    if (source_type->is_vector != target_type->is_vector) cursor.fail("a conversion is unknown");
    if (!target_type->is_vector) return convert_lane(op, x, *source_type, *target_type);
    Value result;
    for (std::size_t k = 0; k < target_type->count; ++k) {
        std::size_t source_offset = 0, target_offset = 0;
        if (source_type->part(k, source_offset) == nullptr) cursor.fail("a conversion is unknown");
        const Type& a = *source_type->part(k, source_offset);
        const Type& b = *target_type->part(k, target_offset);
        const std::size_t lane_offset = a.bits == 1 ? k : source_offset;
        write_bytes(result, target_offset, b.size, convert_lane(op, extract_bytes(x, lane_offset, a.size), a, b));
    }
    return result;
}

Value Walk::convert_lane(std::string_view op, const Value& value, const Type& source, const Type& target) {
    if (op == "fpext" || op == "fptrunc") {
        if (source.kind != Type::Kind::number || target.kind != Type::Kind::number)
            fail("numbers of a type other than float and double are not followed");
        const NodeId n = number_of(value, source);
        if (target.bits < nodes_.bits()) fail("a function of double that computes in float inside is not followed");
        return number(target.bits > source.bits ? nodes_.widen(n) : nodes_.narrow(n));
    }
    if (op == "fptosi" || op == "fptoui") {
        const NodeId n = number_of(value, source);
        if (nodes_[n].op != TapeOp::constant || !(std::fabs(nodes_[n].value) <= 1e9))
            fail("a number becomes an integer, which is not followed");
        return integer(static_cast<std::int64_t>(nodes_[n].value), target);
    }
    if (op == "sitofp" || op == "uitofp") return integer_to_number(op == "sitofp", value, source, target);
    if (op == "trunc") return truncate_integer(value, source, target);
    return extend_integer(op == "zext", value, source, target);
}

/// Converts an integer to a number: one constant for each of its values.
Value Walk::integer_to_number(bool is_signed, const Value& value, const Type& source, const Type& target) {
    if (target.kind != Type::Kind::number || target.bits < nodes_.bits())
        fail("numbers of a type other than float and double are not followed");
    NodeId result = no_node;
    for (const PossibleValue& c : cases_of(value, source)) {
        if (c.memory_object != 0) fail("an address becomes a number");
        const double d = is_signed && source.bits > 1 ? static_cast<double>(c.value)
                                                      : static_cast<double>(as_unsigned(c.value, source.bits));
        const double rounded = target.bits == 32 ? static_cast<double>(static_cast<float>(d)) : d;
        const NodeId case_number = nodes_.constant(rounded, target.bits > nodes_.bits());
        result = result == no_node ? case_number : nodes_.select(c.when, case_number, result);
    }
    return number(result);
}

/// Keeps the lowest bits of an integer; one bit is a decision.
Value Walk::truncate_integer(const Value& value, const Type& source, const Type& target) {
    if (target.bits != 1) return extract_bytes(value, 0, target.size);
    Mask is_odd = no;
    for (const PossibleValue& c : cases_of(value, source))
        if ((c.value & 1) != 0) is_odd = nodes_.logical_or(is_odd, c.when);
    return integer_from_mask(is_odd);
}

/// Extends an integer by zeros or by copies of its sign.
Value Walk::extend_integer(bool with_zeros, const Value& value, const Type& source, const Type& target) {
    // The bytes of other values stay, and zeros follow them.
    const bool is_single_integer = value.size() == 1 && value.begin()->second.scalar.kind == Scalar::Kind::integer;
    if (with_zeros && !is_single_integer && !value.empty()) {
        Value result;
        write_bytes(result, 0, target.size, integer_from_cases({{yes, 0, 0}}, target.size));
        write_bytes(result, 0, source.size, value);
        return result;
    }

    std::vector<PossibleValue> cases = cases_of(value, source);
    for (PossibleValue& c : cases) {
        if (with_zeros) c.value = static_cast<std::int64_t>(as_unsigned(c.value, source.bits));
        else if (source.bits == 1) c.value = -c.value;
    }
    return integer_from_cases(std::move(cases), target.size);
}

Value Walk::rearrange(MemoryState& state, std::string_view op, Cursor& cursor) {
    // Operations on one value.
    const Type* const type = module_.read_type(cursor);
    Value a = value(state, *type, cursor);
    if (op == "extractvalue") {
        const auto [part, offset] = indexed_part(*type, cursor);
        return extract_bytes(a, offset, part->size);
    }
    cursor.expect(",");
    if (op == "extractelement") return extract_lane(state, *type, a, cursor);

    // Operations on two values.
    const Type* const second_type = module_.read_type(cursor);
    const Value b = value(state, *second_type, cursor);
    if (op == "insertvalue") {
        const auto [part, target_offset] = indexed_part(*type, cursor);
        write_bytes(a, target_offset, part->size, b);
        return a;
    }

    // Operations with an index or a list of indices.
    cursor.expect(",");
    const Type* const third_type = module_.read_type(cursor);
    if (op == "insertelement") {
        const std::vector<PossibleValue> index = cases_of(value(state, *third_type, cursor), *third_type);
        std::size_t target_offset = 0;
        if (index.size() != 1 || index[0].value < 0 ||
            type->part(static_cast<std::size_t>(index[0].value), target_offset) == nullptr)
            fail("an index that depends on numbers is not followed here");
        write_bytes(a, target_offset, second_type->size, b);
        return a;
    }
    const Value indices = value(state, *third_type, cursor);
    if (!type->is_vector || !third_type->is_vector) cursor.fail("a vector is missing");
    return shuffle(*type, a, b, *third_type, indices);
}

/// Reads an index, and selects the lane that it names.
Value Walk::extract_lane(MemoryState& state, const Type& type, const Value& vector, Cursor& cursor) {
    const Type* const index_type = module_.read_type(cursor);
    const std::vector<PossibleValue> index = cases_of(value(state, *index_type, cursor), *index_type);
    std::optional<Value> result;
    for (const PossibleValue& c : index) {
        std::size_t offset = 0;
        const Type* const lane = c.value < 0 ? nullptr : type.part(static_cast<std::size_t>(c.value), offset);
        if (lane == nullptr) fail("an index is outside of its vector");
        const Value lane_value = extract_bytes(vector, offset, lane->size);
        result = result ? join(c.when, lane_value, *result) : lane_value;
    }
    return *result;
}

/// Makes a vector of lanes of `a` and `b`. Indices count the lanes of `a`, then those of `b`; a lane whose index is
/// undefined stays undefined.
Value Walk::shuffle(const Type& type, const Value& a, const Value& b, const Type& index_type, const Value& indices) {
    Value result;
    for (std::size_t k = 0; k < index_type.count; ++k) {
        const Value index = extract_bytes(indices, 4 * k, 4);
        if (index.empty()) continue;
        const auto lane = static_cast<std::size_t>(cases_of(index, *index_type.parts[0])[0].value);
        const std::size_t lane_size = type.parts[0]->size;
        const bool is_in_first = lane < type.count;
        const std::size_t source_offset = (is_in_first ? lane : lane - type.count) * lane_size;
        write_bytes(result, k * lane_size, lane_size, extract_bytes(is_in_first ? a : b, source_offset, lane_size));
    }
    return result;
}

}  // namespace lostbits::intersect::function
