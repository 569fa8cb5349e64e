// Values, and the operands of instructions: registers, constants and addresses.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#include "intersect/function/walk.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

constexpr std::size_t max_cases = 128;

std::uint64_t low_bits(std::size_t bytes) {
    return bytes >= 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << 8 * bytes) - 1;
}

/// Reads the text of a floating-point constant: a decimal number, or `0x` and the bits of a double.
double parse_literal(std::string_view digits, const Cursor& cursor) {
    const char* const digits_end = digits.data() + digits.size();
    const bool gives_bits = digits.starts_with("0x");
    double x = 0;
    std::uint64_t bits = 0;
    const auto [end, error] = gives_bits ? std::from_chars(digits.data() + 2, digits_end, bits, 16)
                                         : std::from_chars(digits.data(), digits_end, x);
    if (error != std::errc() || end != digits_end) cursor.fail("a number cannot be read");
    return gives_bits ? std::bit_cast<double>(bits) : x;
}

/// Counts the constants inside constants that are being read.
class NestingCounter {
public:
    explicit NestingCounter(int& depth) : depth_(depth) { ++depth_; }
    ~NestingCounter() { --depth_; }
    NestingCounter(const NestingCounter&) = delete;
    NestingCounter& operator=(const NestingCounter&) = delete;

private:
    int& depth_;
};

}  // namespace

// Values

Value Walk::integer_from_cases(std::vector<PossibleValue> cases, std::size_t size) const {
    return {{0, {size, {.kind = Scalar::Kind::integer, .cases = std::move(cases)}}}};
}

Value Walk::number(NodeId node) const {
    const std::size_t size = nodes_.bits() == 64 || nodes_[node].wide ? 8 : 4;
    return {{0, {size, {.kind = Scalar::Kind::number, .node = node}}}};
}

Value Walk::integer_from_mask(Mask m, std::size_t size) {
    if (m == yes || m == no) return integer_from_cases({{yes, 0, m == yes}}, size);
    return integer_from_cases({{m, 0, 1}, {nodes_.logical_not(m), 0, 0}}, size);
}

/// The floating-point number with the bits of an integer; empty if the scalar is not an integer of 4 or 8 bytes.
std::optional<NodeId> Walk::number_from_bits(const Scalar& scalar, std::size_t size) {
    if (scalar.kind != Scalar::Kind::integer || (size != 4 && size != 8)) return {};
    NodeId result = no_node;
    for (std::size_t k = scalar.cases.size(); k-- > 0;) {
        const PossibleValue& c = scalar.cases[k];
        if (c.memory_object != 0) return {};
        const double x = size == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(c.value))
                                   : std::bit_cast<double>(static_cast<std::uint64_t>(c.value));
        const NodeId case_number = nodes_.constant(x, nodes_.bits() == 32 && size == 8);
        result = result == no_node ? case_number : nodes_.select(c.when, case_number, result);
    }
    return result;
}

NodeId Walk::number_of(const Value& value, const Type& type) {
    if (type.kind != Type::Kind::number) fail("numbers of a type other than float and double are not followed");
    if (type.bits < nodes_.bits()) fail("a function of double that computes in float inside is not followed");

    // An undefined number may be any number.
    const bool is_wide = nodes_.bits() < type.bits;
    if (value.empty()) return nodes_.constant(0, is_wide);
    const auto& [offset, cell] = *value.begin();
    if (cell.scalar.kind == Scalar::Kind::lost) fail(cell.scalar.reason);
    if (cell.scalar.kind == Scalar::Kind::undefined) return nodes_.constant(0, is_wide);

    if (value.size() == 1 && offset == 0 && cell.size == type.size) {
        if (cell.scalar.kind == Scalar::Kind::number) return cell.scalar.node;
        if (const auto bits_number = number_from_bits(cell.scalar, cell.size)) return *bits_number;
    }
    fail("a number that is assembled from the bits of other values is not followed");
}

std::vector<PossibleValue> Walk::merge_duplicates(std::vector<PossibleValue> cases) {
    std::vector<PossibleValue> result;
    for (const PossibleValue& c : cases) {
        if (c.when == no) continue;
        const auto duplicate = std::ranges::find_if(
            result, [&c](const PossibleValue& f) { return f.memory_object == c.memory_object && f.value == c.value; });
        if (duplicate == result.end()) result.push_back(c);
        else duplicate->when = nodes_.logical_or(duplicate->when, c.when);
        if (result.size() > max_cases) fail("an integer that depends on numbers takes too many values");
    }
    if (result.empty()) result.push_back({yes, 0, 0});  // cannot be reached
    if (result.size() == 1) result[0].when = yes;
    return result;
}

std::vector<PossibleValue> Walk::cases_of(const Value& value, const Type& type) {
    if (value.empty()) return {{yes, 0, 0}};  // undefined
    const Scalar& first_scalar = value.begin()->second.scalar;
    if (first_scalar.kind == Scalar::Kind::lost) fail(first_scalar.reason);
    if (value.size() == 1 && value.begin()->first == 0 && first_scalar.kind == Scalar::Kind::integer)
        return first_scalar.cases;
    if (value.size() == 1 && first_scalar.kind == Scalar::Kind::undefined) return {{yes, 0, 0}};

    // Joins adjacent bytes to one integer.
    if (type.size > 8 || type.size == 0 || std::prev(value.end())->first >= 8)
        fail("integers of more than 64 bits are not followed");
    std::vector<PossibleValue> result{{yes, 0, 0}};
    for (const auto& [offset, cell] : value) {
        const std::vector<PossibleValue> cell_cases = cases_of_cell(cell);
        if (!cell_cases.empty()) result = insert_bytes(result, cell_cases, offset, cell.size);
    }

    // Integers of this class are stored sign-extended.
    if (type.size < 8)
        for (PossibleValue& c : result) {
            const auto shift = static_cast<int>(64 - 8 * type.size);
            c.value = static_cast<std::int64_t>(static_cast<std::uint64_t>(c.value) << shift) >> shift;
        }
    return result;
}

/// Returns the possible values of a cell's bytes as an integer; empty if they are undefined. A floating-point number
/// must be a constant.
std::vector<PossibleValue> Walk::cases_of_cell(const MemoryCell& cell) const {
    if (cell.scalar.kind == Scalar::Kind::integer) return cell.scalar.cases;
    if (cell.scalar.kind == Scalar::Kind::number && nodes_[cell.scalar.node].op == TapeOp::constant) {
        const double x = nodes_[cell.scalar.node].value;
        const std::int64_t bits = cell.size == 4
                                      ? static_cast<std::int64_t>(std::bit_cast<std::uint32_t>(static_cast<float>(x)))
                                      : std::bit_cast<std::int64_t>(x);
        return {{yes, 0, bits}};
    }
    if (cell.scalar.kind != Scalar::Kind::undefined)
        fail("an integer operation on the bits of a number is not followed");
    return {};
}

/// Sets the bytes from `offset` on of each of the integers to each of the values of a cell.
std::vector<PossibleValue> Walk::insert_bytes(const std::vector<PossibleValue>& integers,
                                              const std::vector<PossibleValue>& cell_cases, std::size_t offset,
                                              std::size_t size) {
    std::vector<PossibleValue> combined;
    for (const PossibleValue& a : integers)
        for (const PossibleValue& b : cell_cases) {
            if (b.memory_object != 0) fail("an operation on the bytes of an address is not followed");
            const std::uint64_t shifted = (static_cast<std::uint64_t>(b.value) & low_bits(size)) << 8 * offset;
            combined.push_back({nodes_.logical_and(a.when, b.when), 0,
                                static_cast<std::int64_t>(static_cast<std::uint64_t>(a.value) | shifted)});
        }
    return merge_duplicates(std::move(combined));
}

Mask Walk::mask_of(const Value& value) {
    Mask mask = no;
    for (const PossibleValue& c : cases_of(value, *module_.integer_type(8)))
        if ((c.value & 1) != 0) mask = nodes_.logical_or(mask, c.when);
    return mask;
}

/// Returns the bytes `first_byte` to `first_byte + count` of a scalar; empty if they cannot be separated.
std::optional<Scalar> Walk::slice(const Scalar& scalar, std::size_t size, std::size_t first_byte, std::size_t count) {
    if (first_byte == 0 && count == size) return scalar;
    if (scalar.kind == Scalar::Kind::undefined || scalar.kind == Scalar::Kind::lost) return scalar;

    // The bits of a constant are an integer, whose upper half is undefined for a float.
    Scalar bits = scalar;
    if (scalar.kind == Scalar::Kind::number) {
        if (nodes_[scalar.node].op != TapeOp::constant) return {};
        bits = {.kind = Scalar::Kind::integer, .cases = cases_of({{0, {size, scalar}}}, *module_.integer_type(64))};
        if (size == 4) bits.cases = cases_of({{0, {size, scalar}}, {4, {4, {}}}}, *module_.integer_type(64));
    }

    // Moves the bytes to the front, and extends the sign.
    std::vector<PossibleValue> cases;
    for (PossibleValue c : bits.cases) {
        if (c.memory_object != 0) return {};
        const std::uint64_t shifted = first_byte >= 8 ? 0 : static_cast<std::uint64_t>(c.value) >> 8 * first_byte;
        const auto shift = static_cast<int>(64 - 8 * std::min<std::size_t>(count, 8));
        c.value = static_cast<std::int64_t>(shifted << shift) >> shift;
        cases.push_back(c);
    }
    return Scalar{.kind = Scalar::Kind::integer, .cases = merge_duplicates(std::move(cases))};
}

Value Walk::extract_bytes(const Value& value, std::size_t first_byte, std::size_t count) {
    Value result;
    for (const auto& [offset, cell] : value) {
        const std::size_t begin = std::max(offset, first_byte), end = std::min(offset + cell.size, first_byte + count);
        if (begin >= end) continue;
        auto part = slice(cell.scalar, cell.size, begin - offset, end - begin);
        if (!part) part = Scalar{.kind = Scalar::Kind::lost, .reason = "an operation on some bytes of a number"};
        result[begin - first_byte] = {end - begin, std::move(*part)};
    }
    return result;
}

/// Replaces the bytes `offset` to `offset + size` of `target`.
void Walk::write_bytes(Value& target, std::size_t offset, std::size_t size, const Value& value) {
    auto entry = target.lower_bound(offset);
    if (entry != target.begin() && std::prev(entry)->first + std::prev(entry)->second.size > offset) --entry;

    // Removes the cells that overlap the bytes, and keeps what stands before and after the bytes.
    Value remainders;
    while (entry != target.end() && entry->first < offset + size) {
        const std::size_t begin = entry->first, end = begin + entry->second.size;
        const Value old_cell{{0, entry->second}};
        if (begin < offset) remainders[begin] = extract_bytes(old_cell, 0, offset - begin).begin()->second;
        if (end > offset + size)
            remainders[offset + size] =
                extract_bytes(old_cell, offset + size - begin, end - offset - size).begin()->second;
        entry = target.erase(entry);
    }
    for (auto& [k, cell] : remainders) target[k] = cell;

    // Writes the value, without the bytes that exceed the size.
    const auto last_cell = value.empty() ? value.end() : std::prev(value.end());
    const bool value_fits = value.empty() || last_cell->first + last_cell->second.size <= size;
    const Value shortened = value_fits ? Value() : extract_bytes(value, 0, size);
    for (const auto& [k, cell] : value_fits ? value : shortened) target[offset + k] = cell;
}

Scalar Walk::join(Mask when, const Scalar& a, const Scalar& b, std::size_t size) {
    using Kind = Scalar::Kind;
    if (a == b || b.kind == Kind::undefined) return a;
    if (a.kind == Kind::undefined) return b;
    if (a.kind == Kind::lost) return a;
    if (b.kind == Kind::lost) return b;

    // Two integers: the values of both, each under its side of the decision.
    if (a.kind == Kind::integer && b.kind == Kind::integer) {
        std::vector<PossibleValue> cases;
        for (const PossibleValue& c : a.cases)
            cases.push_back({nodes_.logical_and(when, c.when), c.memory_object, c.value});
        for (const PossibleValue& c : b.cases)
            cases.push_back({nodes_.logical_and(nodes_.logical_not(when), c.when), c.memory_object, c.value});
        if (cases.size() > max_cases)
            return {.kind = Kind::lost, .reason = "an integer that depends on numbers takes too many values"};
        return {.kind = Kind::integer, .cases = merge_duplicates(std::move(cases))};
    }

    // Otherwise one of them is a number, so both are joined as numbers.
    const auto as_number = [&](const Scalar& s) {
        return s.kind == Kind::number ? std::optional(s.node) : number_from_bits(s, size);
    };
    const auto x = as_number(a), y = as_number(b);
    if (!x || !y) return {.kind = Kind::lost, .reason = "the same memory holds a number or an address, by a decision"};
    return {.kind = Kind::number, .node = nodes_.select(when, *x, *y)};
}

Value Walk::zero_value(const Type& type) {
    if (type.kind == Type::Kind::number && type.bits >= nodes_.bits())
        return number(nodes_.constant(0, type.bits > nodes_.bits()));
    return integer_from_cases({{yes, 0, 0}}, type.size);
}

// Operands

NodeId Walk::read_literal(const Type& type, Cursor& cursor) {
    const std::string_view text = cursor.rest();
    std::size_t n = 0;
    while (n < text.size() && (std::isalnum(static_cast<unsigned char>(text[n])) != 0 || text[n] == '.' ||
                               text[n] == '-' || text[n] == '+'))
        ++n;
    cursor = Cursor(text.substr(n));

    const double x = parse_literal(text.substr(0, n), cursor);
    if (type.bits < nodes_.bits()) fail("a function of double that computes in float inside is not followed");
    return nodes_.constant(x, type.bits > nodes_.bits());
}

Value Walk::address_of(MemoryState& state, const std::string& name) {
    const auto [known_object, is_new] = global_objects_.try_emplace(name, 0);
    if (is_new) {
        known_object->second = add_object(state, false);
        const int object = known_object->second;
        const auto global = module_.globals.find(name);
        if (global == module_.globals.end()) {
            function_objects_[object] = name;
        } else {
            // A global may contain its own address, so its object exists before its contents are read.
            global_memory_[object] = {};
            if (!global->second.value.empty()) {
                Cursor cursor(global->second.value);
                Value initial = constant(state, *global->second.type, cursor);
                global_memory_[object] = std::move(initial);
            }
        }
    }
    return integer_from_cases({{yes, known_object->second, 0}}, 8);
}

/// Reads the operands of getelementptr in an instruction or in a constant, such as `(TYPE, ptr BASE, i64 0, i32 1)`,
/// and returns the address.
Value Walk::element_address(MemoryState& state, Cursor& cursor) {
    skip_flags(cursor);
    if (cursor.take("inrange")) cursor.take_group();
    const bool is_constant = cursor.take("(");

    // The type at the address, and the address.
    const Type* type = module_.read_type(cursor);
    cursor.expect(",");
    const Type* const pointer = module_.read_type(cursor);
    if (pointer->is_vector) fail("vectors of addresses are not followed");
    std::vector<PossibleValue> cases = cases_of(value(state, *pointer, cursor), *pointer);

    // The first index moves by whole objects of the type. Each later index selects a part.
    for (bool is_first = true; cursor.take(","); is_first = false) {
        if (cursor.peek() == '!') break;
        cursor.take("inrange");
        const Type* const index_type = module_.read_type(cursor);
        const std::vector<PossibleValue> index = cases_of(value(state, *index_type, cursor), *index_type);

        if (!is_first && type->kind == Type::Kind::structure) {
            type = move_to_member(cases, *type, index);
            continue;
        }
        if (!is_first) {
            if (type->kind != Type::Kind::sequence) fail("an address is outside of its type");
            type = type->parts[0];
        }
        cases = move_by_items(cases, index, type->size);
    }

    if (is_constant) cursor.expect(")");
    return integer_from_cases(std::move(cases), 8);
}

/// Moves addresses of a structure to one of its members, and returns the type of the member.
const Type* Walk::move_to_member(std::vector<PossibleValue>& addresses, const Type& structure,
                                 const std::vector<PossibleValue>& index) {
    std::size_t offset = 0;
    const Type* const member = index.size() == 1 && index[0].value >= 0
                                   ? structure.part(static_cast<std::size_t>(index[0].value), offset)
                                   : nullptr;
    if (member == nullptr) fail("an address is outside of its type");
    for (PossibleValue& a : addresses)
        a.value = static_cast<std::int64_t>(static_cast<std::uint64_t>(a.value) + offset);
    return member;
}

/// Moves each of the addresses by each of the numbers of items.
std::vector<PossibleValue> Walk::move_by_items(const std::vector<PossibleValue>& addresses,
                                               const std::vector<PossibleValue>& item_counts, std::size_t item_size) {
    std::vector<PossibleValue> moved;
    for (const PossibleValue& a : addresses)
        for (const PossibleValue& n : item_counts)
            moved.push_back({nodes_.logical_and(a.when, n.when), a.memory_object,
                             static_cast<std::int64_t>(static_cast<std::uint64_t>(a.value) +
                                                       static_cast<std::uint64_t>(n.value) * item_size)});
    return merge_duplicates(std::move(moved));
}

Value Walk::constant(MemoryState& state, const Type& type, Cursor& cursor) {
    const NestingCounter nesting(nesting_);
    if (nesting_ > 100) cursor.fail("a constant is nested too deeply");

    // Addresses and composite values begin with a sign.
    const char first_character = cursor.peek();
    if (first_character == '@') {
        cursor.expect("@");
        return address_of(state, cursor.take_name());
    }
    if (first_character == '{' || first_character == '[' || first_character == '<')
        return read_composite(state, type, cursor);

    // Words that stand for a value of any type.
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

    // Operations on other constants.
    if (cursor.take("getelementptr")) return element_address(state, cursor);
    for (const char* const op : {"bitcast", "inttoptr", "ptrtoint", "addrspacecast", "trunc", "zext"}) {
        if (!cursor.take(op)) continue;
        Cursor inside(cursor.take_group());
        return convert(state, op, inside);
    }

    // Texts and numbers.
    if (cursor.rest().starts_with("c\"")) return read_byte_string(type, cursor);
    if (type.kind == Type::Kind::number) return number(read_literal(type, cursor));
    if (type.kind == Type::Kind::integer) return read_integer(type, cursor);
    cursor.fail("a constant cannot be read");
}

/// Reads a structure `{TYPE VALUE, ...}`, a packed structure `<{...}>`, an array `[...]` or a vector `<...>`.
Value Walk::read_composite(MemoryState& state, const Type& type, Cursor& cursor) {
    const bool may_be_packed = cursor.peek() == '<';
    Cursor inside(cursor.take_group());
    if (may_be_packed && inside.peek() == '{') inside = Cursor(inside.take_group());

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

/// Reads `c"TEXT"`, in which a backslash and two hexadecimal digits stand for a byte.
Value Walk::read_byte_string(const Type& type, Cursor& cursor) {
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

/// Reads a decimal integer, which may be signed or unsigned.
Value Walk::read_integer(const Type& type, Cursor& cursor) {
    if (type.bits > 64) fail("integers of more than 64 bits are not followed");
    const Cursor begin = cursor;
    const std::string_view digits = cursor.take_word();
    const char* const end = digits.data() + digits.size();

    std::int64_t x = 0;
    if (std::from_chars(digits.data(), end, x).ptr == end)
        return integer(wrap(static_cast<std::uint64_t>(x), type.bits), type);

    std::uint64_t u = 0;
    if (digits.empty() || std::from_chars(digits.data(), end, u).ptr != end) begin.fail("a constant cannot be read");
    return integer(wrap(u, type.bits), type);
}

Value Walk::value(MemoryState& state, const Type& type, Cursor& cursor) {
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
