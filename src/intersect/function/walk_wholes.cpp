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

/// Operations on the bits of numbers that compilers and programmers use: changes of the sign, and parts put side by
/// side.
std::optional<Value> Walk::on_bits(std::string_view op, const Type& type, const Value& a, const Value& b) {
    const auto is_number = [&](const Value& v) {
        return v.size() == 1 && v.begin()->second.scalar.kind == Scalar::Kind::number &&
               v.begin()->second.size == type.size && nodes_[v.begin()->second.scalar.node].op != TapeOp::constant;
    };
    const auto known = [&](const Value& v) -> std::optional<std::uint64_t> {
        if (v.size() != 1 || v.begin()->second.scalar.kind != Scalar::Kind::whole) return {};
        const auto& cases = v.begin()->second.scalar.cases;
        if (cases.size() != 1 || cases[0].object != 0) return {};
        return without_sign(cases[0].value, type.bits);
    };
    if (is_number(b) && !is_number(a) && (op == "and" || op == "or" || op == "xor")) return on_bits(op, type, b, a);
    const auto mask = known(b);
    if (is_number(a) && mask) {
        const std::uint64_t sign = std::uint64_t{1} << (type.bits - 1), rest = sign - 1;
        const NodeId x = a.begin()->second.scalar.node;
        if (op == "xor" && *mask == sign) return number(nodes_.number(TapeOp::neg, x));
        if (op == "and" && *mask == rest) return number(nodes_.number(TapeOp::abs, x));
        if (op == "or" && *mask == sign) return number(nodes_.number(TapeOp::neg, nodes_.number(TapeOp::abs, x)));
    }
    const bool has_numbers = [&] {
        for (const Value* v : {&a, &b})
            for (const auto& [at, cell] : *v)
                if (cell.scalar.kind == Scalar::Kind::number) return true;
        return false;
    }();
    if (!has_numbers) return {};
    const auto filled = [&](Value v) {
        Value all;
        put(all, 0, type.size, whole({{yes, 0, 0}}, type.size));
        for (const auto& [at, cell] : v) put(all, at, cell.size, {{0, cell}});
        return all;
    };
    if ((op == "lshr" || op == "shl") && mask && *mask % 8 == 0 && *mask / 8 < type.size) {
        const std::size_t by = *mask / 8;
        return filled(op == "lshr" ? part_of(a, by, type.size - by) : [&] {
            Value moved;
            put(moved, by, type.size - by, part_of(a, 0, type.size - by));
            return moved;
        }());
    }
    if (op == "or") {
        const auto is_zero = [](const MemoryCell& cell) {
            return cell.scalar.kind == Scalar::Kind::whole && cell.scalar.cases.size() == 1 &&
                   cell.scalar.cases[0].object == 0 && cell.scalar.cases[0].value == 0;
        };
        Value all = filled({});
        std::vector<bool> used(type.size);
        for (const Value* v : {&a, &b})
            for (const auto& [at, cell] : *v) {
                if (is_zero(cell)) continue;
                for (std::size_t k = at; k < at + cell.size; ++k) {
                    if (used[k]) return {};
                    used[k] = true;
                }
                put(all, at, cell.size, {{0, cell}});
            }
        return all;
    }
    return {};
}

Value Walk::combine(std::string_view op, const Type& type, const Value& a, const Value& b) {
    if (type.bits > 64) fail("integers of more than 64 bits are not followed");
    if (type.kind != Type::Kind::integer) fail("an operation on integers that has other operands is not followed");
    if (auto known = on_bits(op, type, a, b)) return *known;
    if (type.bits == 1 && (op == "and" || op == "or" || op == "xor")) {
        const Mask x = mask_of(a), y = mask_of(b);
        if (op == "and") return from_mask(nodes_.both(x, y));
        if (op == "or") return from_mask(nodes_.either(x, y));
        return from_mask(nodes_.choose(x, nodes_.opposite(y), y));
    }
    std::vector<Case> all;
    for (const Case& x : cases_of(a, type))
        for (const Case& y : cases_of(b, type)) {
            int object = 0;
            if (x.object != 0 || y.object != 0) {
                const bool moves = (op == "add" && (x.object == 0 || y.object == 0)) || (op == "sub" && y.object == 0);
                if (moves) object = x.object + y.object;
                else if (!(op == "sub" && x.object == y.object) && !(op == "and" && y.object == 0 && y.value < 16))
                    fail("arithmetic with an address is not followed");
            }
            const auto result = computed(op, x.value, y.value, type.bits);
            if (!result && nodes_.both(x.when, y.when) == yes) fail("an integer is divided by zero");
            all.push_back({nodes_.both(x.when, y.when), object, result.value_or(0)});
        }
    return whole(distinct(std::move(all)), type.size);
}

Value Walk::whole_arithmetic(State& state, std::string_view op, Cursor& at) {
    skip_flags(at);
    const Type* const type = module_.type(at);
    const Value a = value(state, *type, at);
    at.expect(",");
    const Value b = value(state, *type, at);
    if (type->is_vector && type->size < type->count) fail("vectors of single bits are not followed");
    return each_lane(*type, [&](const Type& lane, std::size_t from) {
        return combine(op, lane, part_of(a, from, lane.size), part_of(b, from, lane.size));
    });
}

/// `TYPE VALUE to TYPE`
Value Walk::converted(State& state, std::string_view op, Cursor& at) {
    skip_flags(at);
    const Type* const from = module_.type(at);
    const Value x = value(state, *from, at);
    at.expect("to");
    const Type* const to = module_.type(at);
    if (op == "bitcast" || op == "addrspacecast") return x;
    if (op == "inttoptr" || op == "ptrtoint") return part_of(x, 0, std::min(from->size, to->size));
    if (from->is_vector != to->is_vector) at.fail("a conversion is unknown");
    const auto one = [&](const Value& v, const Type& a, const Type& b) -> Value {
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
                const NodeId made = nodes_.constant(rounded, b.bits > nodes_.bits());
                all = all == no_node ? made : nodes_.select(c.when, made, all);
            }
            return number(all);
        }
        if (op == "trunc") {
            if (b.bits == 1) {
                Mask odd = no;
                for (const Case& c : cases_of(v, a))
                    if ((c.value & 1) != 0) odd = nodes_.either(odd, c.when);
                return from_mask(odd);
            }
            return part_of(v, 0, b.size);
        }
        const bool plain = v.size() == 1 && v.begin()->second.scalar.kind == Scalar::Kind::whole;
        if (op == "zext" && !plain && !v.empty()) {
            Value all;
            put(all, 0, b.size, whole({{yes, 0, 0}}, b.size));
            put(all, 0, a.size, v);
            return all;
        }
        std::vector<Case> cases = cases_of(v, a);
        for (Case& c : cases) {
            if (op == "zext") c.value = static_cast<std::int64_t>(without_sign(c.value, a.bits));
            else if (a.bits == 1) c.value = -c.value;
        }
        return whole(std::move(cases), b.size);
    };
    if (!to->is_vector) return one(x, *from, *to);
    Value all;
    for (std::size_t k = 0; k < to->count; ++k) {
        std::size_t source = 0, target = 0;
        if (from->part(k, source) == nullptr) at.fail("a conversion is unknown");
        const Type& a = *from->part(k, source);
        const Type& b = *to->part(k, target);
        const std::size_t where = a.bits == 1 ? k : source;
        put(all, target, b.size, one(part_of(x, where, a.size), a, b));
    }
    return all;
}

namespace {

/// Part of a whole that the indices at the cursor name, and its offset.
std::pair<const Type*, std::size_t> indexed_part(const Type& whole, Cursor& at) {
    const Type* part = &whole;
    std::size_t from = 0;
    while (at.take(",") && at.peek() != '!') {
        std::size_t more = 0;
        part = part->part(static_cast<std::size_t>(at.integer()), more);
        if (part == nullptr) at.fail("an index is outside of its type");
        from += more;
    }
    return {part, from};
}

}  // namespace

Value Walk::shuffled(State& state, std::string_view op, Cursor& at) {
    const Type* const type = module_.type(at);
    Value a = value(state, *type, at);
    if (op == "extractvalue") {
        const auto [part, from] = indexed_part(*type, at);
        return part_of(a, from, part->size);
    }
    at.expect(",");
    if (op == "extractelement") {
        const Type* const index_type = module_.type(at);
        const std::vector<Case> index = cases_of(value(state, *index_type, at), *index_type);
        std::optional<Value> all;
        for (const Case& c : index) {
            std::size_t from = 0;
            const Type* const lane = c.value < 0 ? nullptr : type->part(static_cast<std::size_t>(c.value), from);
            if (lane == nullptr) fail("an index is outside of its vector");
            const Value one = part_of(a, from, lane->size);
            all = all ? join(c.when, one, *all) : one;
        }
        return *all;
    }
    const Type* const second_type = module_.type(at);
    const Value b = value(state, *second_type, at);
    if (op == "insertvalue") {
        const auto [part, to] = indexed_part(*type, at);
        put(a, to, part->size, b);
        return a;
    }
    at.expect(",");
    const Type* const third_type = module_.type(at);
    if (op == "insertelement") {
        const std::vector<Case> index = cases_of(value(state, *third_type, at), *third_type);
        std::size_t to = 0;
        if (index.size() != 1 || index[0].value < 0 ||
            type->part(static_cast<std::size_t>(index[0].value), to) == nullptr)
            fail("an index that depends on numbers is not followed here");
        put(a, to, second_type->size, b);
        return a;
    }
    const Value mask = value(state, *third_type, at);
    if (!type->is_vector || !third_type->is_vector) at.fail("a vector is missing");
    Value all;
    for (std::size_t k = 0; k < third_type->count; ++k) {
        const Value index = part_of(mask, 4 * k, 4);
        if (index.empty()) continue;
        const auto lane = static_cast<std::size_t>(cases_of(index, *third_type->parts[0])[0].value);
        const Type& element = *type->parts[0];
        const bool first = lane < type->count;
        put(all, k * element.size, element.size,
            part_of(first ? a : b, (first ? lane : lane - type->count) * element.size, element.size));
    }
    return all;
}

}  // namespace lostbits::intersect::function
