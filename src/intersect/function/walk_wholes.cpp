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

/// Operations on the bits of numbers that compilers and programmers use: changes of the sign, and parts joined side by
/// side.
std::optional<Value> Walk::bit_operation(std::string_view op, const Type& type, const Value& a, const Value& b) {
    const auto is_number = [&](const Value& v) {
        return v.size() == 1 && v.begin()->second.scalar.kind == Scalar::Kind::number &&
               v.begin()->second.size == type.size && nodes_[v.begin()->second.scalar.node].op != TapeOp::constant;
    };
    const auto known_bits = [&](const Value& v) -> std::optional<std::uint64_t> {
        if (v.size() != 1 || v.begin()->second.scalar.kind != Scalar::Kind::integer) return {};
        const auto& cases = v.begin()->second.scalar.cases;
        if (cases.size() != 1 || cases[0].object != 0) return {};
        return without_sign(cases[0].value, type.bits);
    };
    if (is_number(b) && !is_number(a) && (op == "and" || op == "or" || op == "xor"))
        return bit_operation(op, type, b, a);
    const auto mask = known_bits(b);
    if (is_number(a) && mask) {
        const std::uint64_t sign = std::uint64_t{1} << (type.bits - 1), rest = sign - 1;
        const NodeId x = a.begin()->second.scalar.node;
        if (op == "xor" && *mask == sign) return number(nodes_.number(TapeOp::neg, x));
        if (op == "and" && *mask == rest) return number(nodes_.number(TapeOp::abs, x));
        if (op == "or" && *mask == sign) return number(nodes_.number(TapeOp::neg, nodes_.number(TapeOp::abs, x)));
    }
    const bool has_numbers = [&] {
        for (const Value* v : {&a, &b})
            for (const auto& [offset, cell] : *v)
                if (cell.scalar.kind == Scalar::Kind::number) return true;
        return false;
    }();
    if (!has_numbers) return {};
    const auto zero_filled = [&](Value v) {
        Value result;
        write_bytes(result, 0, type.size, from_cases({{yes, 0, 0}}, type.size));
        for (const auto& [offset, cell] : v) write_bytes(result, offset, cell.size, {{0, cell}});
        return result;
    };
    if ((op == "lshr" || op == "shl") && mask && *mask % 8 == 0 && *mask / 8 < type.size) {
        const std::size_t byte_count = *mask / 8;
        return zero_filled(op == "lshr" ? part_of(a, byte_count, type.size - byte_count) : [&] {
            Value moved;
            write_bytes(moved, byte_count, type.size - byte_count, part_of(a, 0, type.size - byte_count));
            return moved;
        }());
    }
    if (op == "or") {
        const auto is_zero = [](const MemoryCell& cell) {
            return cell.scalar.kind == Scalar::Kind::integer && cell.scalar.cases.size() == 1 &&
                   cell.scalar.cases[0].object == 0 && cell.scalar.cases[0].value == 0;
        };
        Value result = zero_filled({});
        std::vector<bool> used(type.size);
        for (const Value* v : {&a, &b})
            for (const auto& [offset, cell] : *v) {
                if (is_zero(cell)) continue;
                for (std::size_t k = offset; k < offset + cell.size; ++k) {
                    if (used[k]) return {};
                    used[k] = true;
                }
                write_bytes(result, offset, cell.size, {{0, cell}});
            }
        return result;
    }
    return {};
}

Value Walk::combine(std::string_view op, const Type& type, const Value& a, const Value& b) {
    if (type.bits > 64) fail("integers of more than 64 bits are not followed");
    if (type.kind != Type::Kind::integer) fail("an operation on integers that has other operands is not followed");
    if (auto bit_result = bit_operation(op, type, a, b)) return *bit_result;
    if (type.bits == 1 && (op == "and" || op == "or" || op == "xor")) {
        const Mask x = mask_of(a), y = mask_of(b);
        if (op == "and") return from_mask(nodes_.both(x, y));
        if (op == "or") return from_mask(nodes_.either(x, y));
        return from_mask(nodes_.choose(x, nodes_.opposite(y), y));
    }
    std::vector<Case> cases;
    for (const Case& x : cases_of(a, type))
        for (const Case& y : cases_of(b, type)) {
            int object = 0;
            if (x.object != 0 || y.object != 0) {
                const bool moves = (op == "add" && (x.object == 0 || y.object == 0)) || (op == "sub" && y.object == 0);
                if (moves) object = x.object + y.object;
                else if (!(op == "sub" && x.object == y.object) && !(op == "and" && y.object == 0 && y.value < 16))
                    fail("arithmetic with an address is not followed");
            }
            const auto result = integer_result(op, x.value, y.value, type.bits);
            if (!result && nodes_.both(x.when, y.when) == yes) fail("an integer is divided by zero");
            cases.push_back({nodes_.both(x.when, y.when), object, result.value_or(0)});
        }
    return from_cases(distinct(std::move(cases)), type.size);
}

Value Walk::integer_arithmetic(State& state, std::string_view op, Cursor& cursor) {
    skip_flags(cursor);
    const Type* const type = module_.type(cursor);
    const Value a = value(state, *type, cursor);
    cursor.expect(",");
    const Value b = value(state, *type, cursor);
    if (type->is_vector && type->size < type->count) fail("vectors of single bits are not followed");
    return each_lane(*type, [&](const Type& lane, std::size_t offset) {
        return combine(op, lane, part_of(a, offset, lane.size), part_of(b, offset, lane.size));
    });
}

/// Reads and performs a conversion, `TYPE VALUE to TYPE`.
Value Walk::convert(State& state, std::string_view op, Cursor& cursor) {
    skip_flags(cursor);
    const Type* const source_type = module_.type(cursor);
    const Value x = value(state, *source_type, cursor);
    cursor.expect("to");
    const Type* const target_type = module_.type(cursor);
    if (op == "bitcast" || op == "addrspacecast") return x;
    if (op == "inttoptr" || op == "ptrtoint") return part_of(x, 0, std::min(source_type->size, target_type->size));
    if (source_type->is_vector != target_type->is_vector) cursor.fail("a conversion is unknown");
    const auto convert_lane = [&](const Value& v, const Type& a, const Type& b) -> Value {
        if (op == "fpext" || op == "fptrunc") {
            if (a.kind != Type::Kind::number || b.kind != Type::Kind::number)
                fail("numbers of a type other than float and double are not followed");
            const NodeId n = number_of(v, a);
            if (b.bits < nodes_.bits()) fail("a function of double that computes in float inside is not followed");
            return number(b.bits > a.bits ? nodes_.widen(n) : nodes_.narrow(n));
        }
        if (op == "fptosi" || op == "fptoui") {
            const NodeId n = number_of(v, a);
            if (nodes_[n].op != TapeOp::constant || !(std::fabs(nodes_[n].value) <= 1e9))
                fail("a number becomes an integer, which is not followed");
            return integer(static_cast<std::int64_t>(nodes_[n].value), b);
        }
        if (op == "sitofp" || op == "uitofp") {
            if (b.kind != Type::Kind::number || b.bits < nodes_.bits())
                fail("numbers of a type other than float and double are not followed");
            NodeId all = no_node;
            for (const Case& c : cases_of(v, a)) {
                if (c.object != 0) fail("an address becomes a number");
                const bool is_signed = op == "sitofp" && a.bits > 1;
                const double d =
                    is_signed ? static_cast<double>(c.value) : static_cast<double>(without_sign(c.value, a.bits));
                const double rounded = b.bits == 32 ? static_cast<double>(static_cast<float>(d)) : d;
                const NodeId case_number = nodes_.constant(rounded, b.bits > nodes_.bits());
                all = all == no_node ? case_number : nodes_.select(c.when, case_number, all);
            }
            return number(all);
        }
        if (op == "trunc") {
            if (b.bits == 1) {
                Mask is_odd = no;
                for (const Case& c : cases_of(v, a))
                    if ((c.value & 1) != 0) is_odd = nodes_.either(is_odd, c.when);
                return from_mask(is_odd);
            }
            return part_of(v, 0, b.size);
        }
        const bool is_single_integer = v.size() == 1 && v.begin()->second.scalar.kind == Scalar::Kind::integer;
        if (op == "zext" && !is_single_integer && !v.empty()) {
            Value all;
            write_bytes(all, 0, b.size, from_cases({{yes, 0, 0}}, b.size));
            write_bytes(all, 0, a.size, v);
            return all;
        }
        std::vector<Case> cases = cases_of(v, a);
        for (Case& c : cases) {
            if (op == "zext") c.value = static_cast<std::int64_t>(without_sign(c.value, a.bits));
            else if (a.bits == 1) c.value = -c.value;
        }
        return from_cases(std::move(cases), b.size);
    };
    if (!target_type->is_vector) return convert_lane(x, *source_type, *target_type);
    Value all;
    for (std::size_t k = 0; k < target_type->count; ++k) {
        std::size_t source_offset = 0, target_offset = 0;
        if (source_type->part(k, source_offset) == nullptr) cursor.fail("a conversion is unknown");
        const Type& a = *source_type->part(k, source_offset);
        const Type& b = *target_type->part(k, target_offset);
        const std::size_t lane_offset = a.bits == 1 ? k : source_offset;
        write_bytes(all, target_offset, b.size, convert_lane(part_of(x, lane_offset, a.size), a, b));
    }
    return all;
}

namespace {

/// Part of a whole that the indices at the cursor name, and its offset.
std::pair<const Type*, std::size_t> indexed_part(const Type& whole_type, Cursor& cursor) {
    const Type* part = &whole_type;
    std::size_t offset = 0;
    while (cursor.take(",") && cursor.peek() != '!') {
        std::size_t part_offset = 0;
        part = part->part(static_cast<std::size_t>(cursor.integer()), part_offset);
        if (part == nullptr) cursor.fail("an index is outside of its type");
        offset += part_offset;
    }
    return {part, offset};
}

}  // namespace

Value Walk::rearrange(State& state, std::string_view op, Cursor& cursor) {
    const Type* const type = module_.type(cursor);
    Value a = value(state, *type, cursor);
    if (op == "extractvalue") {
        const auto [part, offset] = indexed_part(*type, cursor);
        return part_of(a, offset, part->size);
    }
    cursor.expect(",");
    if (op == "extractelement") {
        const Type* const index_type = module_.type(cursor);
        const std::vector<Case> index = cases_of(value(state, *index_type, cursor), *index_type);
        std::optional<Value> all;
        for (const Case& c : index) {
            std::size_t offset = 0;
            const Type* const lane = c.value < 0 ? nullptr : type->part(static_cast<std::size_t>(c.value), offset);
            if (lane == nullptr) fail("an index is outside of its vector");
            const Value lane_value = part_of(a, offset, lane->size);
            all = all ? join(c.when, lane_value, *all) : lane_value;
        }
        return *all;
    }
    const Type* const second_type = module_.type(cursor);
    const Value b = value(state, *second_type, cursor);
    if (op == "insertvalue") {
        const auto [part, target_offset] = indexed_part(*type, cursor);
        write_bytes(a, target_offset, part->size, b);
        return a;
    }
    cursor.expect(",");
    const Type* const third_type = module_.type(cursor);
    if (op == "insertelement") {
        const std::vector<Case> index = cases_of(value(state, *third_type, cursor), *third_type);
        std::size_t target_offset = 0;
        if (index.size() != 1 || index[0].value < 0 ||
            type->part(static_cast<std::size_t>(index[0].value), target_offset) == nullptr)
            fail("an index that depends on numbers is not followed here");
        write_bytes(a, target_offset, second_type->size, b);
        return a;
    }
    const Value mask = value(state, *third_type, cursor);
    if (!type->is_vector || !third_type->is_vector) cursor.fail("a vector is missing");
    Value all;
    for (std::size_t k = 0; k < third_type->count; ++k) {
        const Value index = part_of(mask, 4 * k, 4);
        if (index.empty()) continue;
        const auto lane = static_cast<std::size_t>(cases_of(index, *third_type->parts[0])[0].value);
        const Type& element = *type->parts[0];
        const bool first = lane < type->count;
        write_bytes(all, k * element.size, element.size,
                    part_of(first ? a : b, (first ? lane : lane - type->count) * element.size, element.size));
    }
    return all;
}

}  // namespace lostbits::intersect::function
