#include "intersect/function/walk.hpp"

#include <algorithm>
#include <bit>
#include <functional>

#include "intersect/function/block_order.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

constexpr std::size_t max_cases = 128;
constexpr int max_visits = 3000;

/// Returns the names after `label %` in the last instruction of a block.
std::vector<std::string> labels_in(std::string_view line) {
    std::vector<std::string> labels;
    constexpr std::string_view mark = "label %";
    for (std::size_t position = line.find(mark); position != std::string_view::npos;
         position = line.find(mark, position + 1)) {
        Cursor cursor(line.substr(position + mark.size()));
        labels.push_back(cursor.take_name());
    }
    return labels;
}

std::uint64_t low_bits(std::size_t bytes) {
    return bytes >= 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << 8 * bytes) - 1;
}

}  // namespace

// Values

Value Walk::integer_from_cases(std::vector<Case> cases, std::size_t size) const {
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
        const Case& c = scalar.cases[k];
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
    if (value.empty()) return nodes_.constant(0, nodes_.bits() < type.bits);  // undefined: any number
    const auto& [offset, cell] = *value.begin();
    if (cell.scalar.kind == Scalar::Kind::lost) fail(cell.scalar.reason);
    if (cell.scalar.kind == Scalar::Kind::undefined) return nodes_.constant(0, nodes_.bits() < type.bits);
    if (value.size() == 1 && offset == 0 && cell.size == type.size) {
        if (cell.scalar.kind == Scalar::Kind::number) return cell.scalar.node;
        if (const auto bits_number = number_from_bits(cell.scalar, cell.size)) return *bits_number;
    }
    fail("a number that is assembled from the bits of other values is not followed");
}

std::vector<Case> Walk::merge_duplicates(std::vector<Case> cases) {
    std::vector<Case> result;
    for (const Case& c : cases) {
        if (c.when == no) continue;
        const auto duplicate = std::ranges::find_if(
            result, [&c](const Case& f) { return f.memory_object == c.memory_object && f.value == c.value; });
        if (duplicate == result.end()) result.push_back(c);
        else duplicate->when = nodes_.logical_or(duplicate->when, c.when);
        if (result.size() > max_cases) fail("an integer that depends on numbers takes too many values");
    }
    if (result.empty()) result.push_back({yes, 0, 0});  // cannot be reached
    if (result.size() == 1) result[0].when = yes;
    return result;
}

std::vector<Case> Walk::cases_of(const Value& value, const Type& type) {
    if (value.empty()) return {{yes, 0, 0}};  // undefined
    const Scalar& first_scalar = value.begin()->second.scalar;
    if (first_scalar.kind == Scalar::Kind::lost) fail(first_scalar.reason);
    if (value.size() == 1 && value.begin()->first == 0 && first_scalar.kind == Scalar::Kind::integer)
        return first_scalar.cases;
    if (value.size() == 1 && first_scalar.kind == Scalar::Kind::undefined) return {{yes, 0, 0}};
    // Joins adjacent bytes to one integer; a floating-point number among them must be a constant.
    if (type.size > 8 || type.size == 0 || std::prev(value.end())->first >= 8)
        fail("integers of more than 64 bits are not followed");
    std::vector<Case> result{{yes, 0, 0}};
    for (const auto& [offset, cell] : value) {
        std::vector<Case> part_cases;
        if (cell.scalar.kind == Scalar::Kind::integer) part_cases = cell.scalar.cases;
        else if (cell.scalar.kind == Scalar::Kind::number && nodes_[cell.scalar.node].op == TapeOp::constant) {
            const double x = nodes_[cell.scalar.node].value;
            part_cases = {{yes, 0,
                           cell.size == 4
                               ? static_cast<std::int64_t>(std::bit_cast<std::uint32_t>(static_cast<float>(x)))
                               : std::bit_cast<std::int64_t>(x)}};
        } else if (cell.scalar.kind != Scalar::Kind::undefined) {
            fail("an integer operation on the bits of a number is not followed");
        }
        if (part_cases.empty()) continue;
        std::vector<Case> combined;
        for (const Case& a : result)
            for (const Case& b : part_cases) {
                if (b.memory_object != 0) fail("an operation on the bytes of an address is not followed");
                const std::uint64_t shifted = (static_cast<std::uint64_t>(b.value) & low_bits(cell.size)) << 8 * offset;
                combined.push_back({nodes_.logical_and(a.when, b.when), 0,
                                    static_cast<std::int64_t>(static_cast<std::uint64_t>(a.value) | shifted)});
            }
        result = merge_duplicates(std::move(combined));
    }
    if (type.size < 8)
        for (Case& c : result) {  // integers of this class are stored sign-extended
            const auto shift = static_cast<int>(64 - 8 * type.size);
            c.value = static_cast<std::int64_t>(static_cast<std::uint64_t>(c.value) << shift) >> shift;
        }
    return result;
}

Mask Walk::mask_of(const Value& value) {
    Mask mask = no;
    for (const Case& c : cases_of(value, *module_.integer_type(8)))
        if ((c.value & 1) != 0) mask = nodes_.logical_or(mask, c.when);
    return mask;
}

/// Returns the bytes `first_byte` to `first_byte + count` of a scalar; empty if they cannot be separated.
std::optional<Scalar> Walk::slice(const Scalar& scalar, std::size_t size, std::size_t first_byte, std::size_t count) {
    if (first_byte == 0 && count == size) return scalar;
    if (scalar.kind == Scalar::Kind::undefined || scalar.kind == Scalar::Kind::lost) return scalar;
    Scalar bits = scalar;
    if (scalar.kind == Scalar::Kind::number) {
        if (nodes_[scalar.node].op != TapeOp::constant) return {};
        bits = {.kind = Scalar::Kind::integer, .cases = cases_of({{0, {size, scalar}}}, *module_.integer_type(64))};
        if (size == 4) bits.cases = cases_of({{0, {size, scalar}}, {4, {4, {}}}}, *module_.integer_type(64));
    }
    std::vector<Case> cases;
    for (Case c : bits.cases) {
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
    if (a.kind == Kind::integer && b.kind == Kind::integer) {
        std::vector<Case> cases;
        for (const Case& c : a.cases) cases.push_back({nodes_.logical_and(when, c.when), c.memory_object, c.value});
        for (const Case& c : b.cases)
            cases.push_back({nodes_.logical_and(nodes_.logical_not(when), c.when), c.memory_object, c.value});
        if (cases.size() > max_cases)
            return {.kind = Kind::lost, .reason = "an integer that depends on numbers takes too many values"};
        return {.kind = Kind::integer, .cases = merge_duplicates(std::move(cases))};
    }
    const auto as_number = [&](const Scalar& s) {
        return s.kind == Kind::number ? std::optional(s.node) : number_from_bits(s, size);
    };
    const auto x = as_number(a), y = as_number(b);
    if (!x || !y) return {.kind = Kind::lost, .reason = "the same memory holds a number or an address, by a decision"};
    return {.kind = Kind::number, .node = nodes_.select(when, *x, *y)};
}

Value Walk::join(Mask when, const Value& a, const Value& b) {
    if (when == yes) return a;
    if (when == no) return b;
    // Cuts the cells of both values at the same offsets.
    const auto cut_like = [&](const Value& x, const Value& pattern) {
        Value result;
        for (const auto& [offset, cell] : x) {
            std::vector<std::size_t> ends;
            for (const auto& [k, other] : pattern)
                for (const std::size_t e : {k, k + other.size})
                    if (e > offset && e < offset + cell.size) ends.push_back(e);
            ends.push_back(offset + cell.size);
            std::ranges::sort(ends);
            std::size_t begin = offset;
            for (const std::size_t end : ends) {
                if (end == begin) continue;
                const Value part = extract_bytes({{0, cell}}, begin - offset, end - begin);
                result[begin] = part.begin()->second;
                begin = end;
            }
        }
        return result;
    };
    Value joined = cut_like(a, b);
    for (const auto& [offset, cell] : cut_like(b, a)) {
        const auto counterpart = joined.find(offset);
        if (counterpart == joined.end()) joined[offset] = cell;
        else counterpart->second.scalar = join(when, counterpart->second.scalar, cell.scalar, cell.size);
    }
    return joined;
}

Value Walk::zero_value(const Type& type) {
    if (type.kind == Type::Kind::number && type.bits >= nodes_.bits())
        return number(nodes_.constant(0, type.bits > nodes_.bits()));
    return integer_from_cases({{yes, 0, 0}}, type.size);
}

// States

void Walk::join(State& state, State&& other) {
    std::size_t common = 0;
    while (common < std::min(state.path.size(), other.path.size()) && state.path[common] == other.path[common])
        ++common;
    const auto decisions_after_fork = [&](const State& s) {
        Mask conjunction = yes;
        for (std::size_t k = common; k < s.path.size(); ++k) conjunction = nodes_.logical_and(conjunction, s.path[k]);
        return conjunction;
    };
    const Mask target_decision = decisions_after_fork(state), other_decision = decisions_after_fork(other);
    // If the two paths separate at one decision, that decision alone selects between them.
    Mask when = target_decision;
    if (common < state.path.size() && common < other.path.size() &&
        nodes_.logical_not(state.path[common]) == other.path[common])
        when = state.path[common];
    else if (other.path.size() - common < state.path.size() - common) when = nodes_.logical_not(other_decision);
    const Mask either_path = nodes_.logical_or(target_decision, other_decision);
    state.path.resize(common);
    if (either_path != yes) state.path.push_back(either_path);
    state.memory.resize(std::max(state.memory.size(), other.memory.size()));
    for (std::size_t k = 0; k < other.memory.size(); ++k) {
        if (state.memory[k] == other.memory[k] || other.memory[k] == nullptr) continue;
        if (state.memory[k] == nullptr) state.memory[k] = other.memory[k];
        else state.memory[k] = std::make_shared<Value>(join(when, *state.memory[k], *other.memory[k]));
    }
    // A register that is set on only one of the two paths is not read after they join.
    for (auto r = state.registers.begin(); r != state.registers.end();) {
        const auto other_register = other.registers.find(r->first);
        if (other_register == other.registers.end()) {
            r = state.registers.erase(r);
            continue;
        }
        if (r->second != other_register->second) r->second = join(when, r->second, other_register->second);
        ++r;
    }
}

int Walk::new_object(State& state, bool is_written) {
    const int object = object_count_++;
    if (is_written) {
        state.memory.resize(static_cast<std::size_t>(object) + 1);
        state.memory.back() = std::make_shared<Value>();
    }
    return object;
}

Value Walk::load(State& state, const Value& pointer, std::size_t size) {
    std::optional<Value> result;
    const std::vector<Case> cases = cases_of(pointer, *module_.pointer_type());
    for (std::size_t k = cases.size(); k-- > 0;) {
        const Case& c = cases[k];
        if (c.memory_object == 0) {
            if (cases.size() == 1) fail("memory at an unknown address is read");
            continue;
        }
        Value part;
        const auto index = static_cast<std::size_t>(c.memory_object);
        if (const auto global = global_memory_.find(c.memory_object); global != global_memory_.end())
            part = extract_bytes(global->second, static_cast<std::size_t>(c.value), size);
        else if (function_objects_.contains(c.memory_object)) fail("the code of a function is read");
        else if (c.value < 0 || index >= state.memory.size() || state.memory[index] == nullptr)
            fail("memory outside of every variable is read");
        else part = extract_bytes(*state.memory[index], static_cast<std::size_t>(c.value), size);
        result = result ? join(c.when, part, *result) : part;
    }
    if (!result) fail("memory at an unknown address is read");
    return *result;
}

void Walk::store(State& state, const Value& pointer, std::size_t size, const Value& value) {
    const std::vector<Case> cases = cases_of(pointer, *module_.pointer_type());
    for (const Case& c : cases) {
        const auto index = static_cast<std::size_t>(c.memory_object);
        if (global_memory_.contains(c.memory_object)) fail("a global variable is written");
        if (c.memory_object == 0 && cases.size() > 1) continue;
        if (c.memory_object == 0 || c.value < 0 || index >= state.memory.size() || state.memory[index] == nullptr)
            fail("memory at an unknown address is written");
        std::shared_ptr<Value>& memory = state.memory[index];
        if (memory.use_count() > 1) memory = std::make_shared<Value>(*memory);
        const auto offset = static_cast<std::size_t>(c.value);
        write_bytes(*memory, offset, size,
                    c.when == yes ? value : join(c.when, value, extract_bytes(*memory, offset, size)));
    }
}

/// Enters a block: sets its phis, and joins the state with the state that already waits at the start of the block.
void Walk::enter(Frame& frame, State state, const std::string& target) {
    const auto target_block = frame.blocks.find(target);
    if (target_block == frame.blocks.end()) fail("the LLVM IR has no block " + target);
    const Block& block = frame.function->blocks[static_cast<std::size_t>(target_block->second)];
    std::vector<std::pair<std::string, Value>> phis;
    for (const std::string_view line : block.lines) {
        Cursor cursor(line);
        if (!cursor.take("%")) {
            if (cursor.peek() == '#' || cursor.take("call void @llvm.dbg")) continue;
            break;
        }
        const std::string name = cursor.take_name();
        cursor.expect("=");
        if (!cursor.take("phi")) break;
        while (cursor.take("nnan") || cursor.take("ninf") || cursor.take("nsz") || cursor.take("arcp") ||
               cursor.take("contract") || cursor.take("afn") || cursor.take("reassoc") || cursor.take("fast")) {}
        const Type* const type = module_.read_type(cursor);
        bool is_set = false;
        while (cursor.take("[")) {
            Cursor value_cursor = cursor;  // only the value for the preceding block is read; others may be undefined
            std::size_t depth = 0, k = 0;
            const std::string_view text = cursor.rest();
            bool quoted = false;
            for (; k < text.size() && (depth > 0 || quoted || text[k] != ','); ++k) {
                if (text[k] == '"') quoted = !quoted;
                if (std::string_view("([{<").find(text[k]) != std::string_view::npos) ++depth;
                if (std::string_view(")]}>").find(text[k]) != std::string_view::npos && depth > 0) --depth;
            }
            if (k >= text.size()) cursor.fail("a phi has no end");
            cursor = Cursor(text.substr(k));
            cursor.expect(",");
            cursor.expect("%");
            if (cursor.take_name() == frame.block && !is_set) {
                phis.emplace_back(name, value(state, *type, value_cursor));
                is_set = true;
            }
            cursor.expect("]");
            cursor.take(",");
        }
    }
    for (auto& [name, v] : phis) state.registers[name] = std::move(v);
    const int position = frame.positions[static_cast<std::size_t>(target_block->second)];
    const auto [waiting, is_new] = frame.pending.try_emplace(position);
    if (is_new) waiting->second = std::move(state);
    else join(waiting->second, std::move(state));
}

/// Enters a block under the condition `when`. Does nothing if the decisions of the path exclude it.
void Walk::branch(Frame& frame, State& state, Mask when, const std::string& target) {
    if (when == no) return;
    State next_state = state;
    if (when != yes) {
        const Mask negation = next_state.path.empty() ? no : nodes_.logical_not(when);
        for (const Mask m : next_state.path) {
            if (m == negation) return;
            if (m == when) when = yes;
        }
        if (when != yes) next_state.path.push_back(when);
    }
    enter(frame, std::move(next_state), target);
}

void Walk::add_return_state(Frame& frame, State& state, Value value) {
    State return_state = std::move(state);
    return_state.registers.clear();
    return_state.registers["ret"] = std::move(value);
    if (!frame.returned) frame.returned = std::move(return_state);
    else join(*frame.returned, std::move(return_state));
}

auto Walk::run_function(const IrFunction& f, std::vector<Value> arguments, State state, int caller)
    -> std::optional<std::pair<State, Value>> {
    if (depth_ > 60) fail("calls are nested too deeply; a function that calls itself is not followed");
    if (arguments.size() < f.parameters.size()) fail("it is called with too few arguments");
    ++depth_;
    Frame frame{.function = &f, .caller = caller, .positions = {}, .blocks = {}, .pending = {}, .visits = {}};
    std::vector<std::vector<int>> successors(f.blocks.size());
    for (std::size_t b = 0; b < f.blocks.size(); ++b) frame.blocks[f.blocks[b].name] = static_cast<int>(b);
    for (std::size_t b = 0; b < f.blocks.size(); ++b)
        for (const std::string& label : labels_in(f.blocks[b].lines.empty() ? "" : f.blocks[b].lines.back()))
            if (const auto block = frame.blocks.find(label); block != frame.blocks.end())
                successors[b].push_back(block->second);
    frame.positions = BlockOrder(successors).positions();
    frame.visits.assign(f.blocks.size(), 0);
    std::map<int, std::size_t> block_at_position;
    for (std::size_t b = 0; b < f.blocks.size(); ++b) block_at_position[frame.positions[b]] = b;

    const Registers caller_registers = std::move(state.registers);
    state.registers.clear();
    for (std::size_t k = 0; k < f.parameters.size(); ++k) {
        const IrParameter& p = f.parameters[k];
        Value argument = arguments[k];
        if (p.by_value != nullptr) {
            const Value copy = load(state, argument, p.by_value->size);
            argument = integer_from_cases({{yes, new_object(state), 0}}, 8);
            store(state, argument, p.by_value->size, copy);
        }
        state.registers[p.name] = std::move(argument);
    }
    frame.pending.emplace(frame.positions[0], std::move(state));
    while (!frame.pending.empty()) {
        auto first = frame.pending.begin();
        const std::size_t b = block_at_position[first->first];
        State current_state = std::move(first->second);
        frame.pending.erase(first);
        const Block& block = f.blocks[b];
        frame.block = block.name;
        if (++frame.visits[b] > max_visits)
            fail("a loop has no bound that is known before it runs: after " + std::to_string(max_visits) +
                 " rounds it may still go on");
        for (const std::string_view line : block.lines)
            if (!run_instruction(frame, current_state, line)) break;
    }
    --depth_;
    if (!frame.returned) return {};
    State final_state = std::move(*frame.returned);
    Value result = std::move(final_state.registers["ret"]);
    final_state.registers = caller_registers;
    return std::pair(std::move(final_state), std::move(result));
}

Walk::Answer Walk::run(const std::string& name, int inputs) {
    try {
        const IrFunction* const f = module_.find_function(name);
        if (f == nullptr) fail("the LLVM IR does not define " + name);
        State state;
        const std::size_t size = nodes_.bits() / 8;
        std::vector<Value> arguments;
        for (int k = 0; k < 3; ++k) arguments.push_back(integer_from_cases({{yes, new_object(state), 0}}, 8));
        Value input;
        for (int k = 0; k < inputs; ++k)
            write_bytes(input, static_cast<std::size_t>(k) * size, size, number(nodes_.input(k)));
        *state.memory[1] = input;
        auto result = run_function(*f, arguments, std::move(state), -1);
        if (!result) fail("the function never returns");
        const Type number_type{.kind = Type::Kind::number, .size = size, .align = size, .bits = nodes_.bits()};
        const Value& out = *result->first.memory[2];
        const auto answer = [&](std::size_t k) {
            const Value number_bytes = extract_bytes(out, k * size, size);
            return number_bytes.empty() ? no_node : number_of(number_bytes, number_type);
        };
        const Value& hit = *result->first.memory[3];
        Mask hits = no;
        for (const Case& c : cases_of(hit, *module_.integer_type(32)))
            if (c.value != 0) hits = nodes_.logical_or(hits, c.when);
        return {hits, answer(0), answer(1)};
    } catch (const NotFollowed& reason) {
        const int user_place = innermost_user_place(nodes_.place);
        if (user_place < 0) throw InputError(reason.what());
        const SourcePlace& p = places_[static_cast<std::size_t>(user_place)];
        throw InputError(p.file + ":" + std::to_string(p.line) + ":" + std::to_string(p.column) + ": " + reason.what());
    }
}

}  // namespace lostbits::intersect::function
