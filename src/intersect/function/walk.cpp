#include "intersect/function/walk.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

constexpr int max_visits = 3000;

/// Indices of the memory objects to which the three pointers of `run` point.
constexpr std::size_t in_object = 1, out_object = 2, hit_object = 3;

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

/// Skips the value of a phi, up to the comma before the name of its block.
void skip_phi_value(Cursor& cursor) {
    const std::string_view text = cursor.rest();
    std::size_t depth = 0, k = 0;
    bool is_quoted = false;
    for (; k < text.size() && (depth > 0 || is_quoted || text[k] != ','); ++k) {
        if (text[k] == '"') is_quoted = !is_quoted;
        if (std::string_view("([{<").find(text[k]) != std::string_view::npos) ++depth;
        if (std::string_view(")]}>").find(text[k]) != std::string_view::npos && depth > 0) --depth;
    }
    if (k >= text.size()) cursor.fail("a phi has no end");
    cursor = Cursor(text.substr(k));
}

/// Positions of the blocks: all blocks of a loop come before the blocks after the loop, and each block comes before its
/// successors, except along edges back to the head of a loop. The block with the lowest position runs next (F.
/// Bourdoncle, Efficient chaotic iteration strategies with widenings, 1993: a weak topological order).
class BlockOrder {
public:
    explicit BlockOrder(std::vector<std::vector<int>> successors)
        : successors_(std::move(successors)), position_(successors_.size(), -1) {
        std::vector<bool> every_block(successors_.size(), true);
        arrange(0, every_block);
        for (int& p : position_)
            if (p < 0) p = next_position_++;  // a block that cannot be reached
    }
    [[nodiscard]] const std::vector<int>& positions() const { return position_; }

private:
    /// Finds the strongly connected components of the `allowed` blocks that `entry` reaches, by Tarjan's algorithm with
    /// a stack in place of recursion. The components come in reverse order. The last block of each is its head: the
    /// block by which the component is entered first.
    [[nodiscard]] std::vector<std::vector<int>> find_components(int entry, const std::vector<bool>& allowed) const {
        const std::size_t n = successors_.size();
        std::vector<int> visit_index(n, -1), low_link(n, 0), stack;
        std::vector<bool> on_stack(n, false);
        std::vector<std::vector<int>> components;
        struct Visit {
            int block;
            std::size_t edge;
        };
        std::vector<Visit> visits{{entry, 0}};
        int visit_count = 0;
        while (!visits.empty()) {
            // The first visit of a block.
            auto& [block, edge] = visits.back();
            const auto block_index = static_cast<std::size_t>(block);
            if (edge == 0 && visit_index[block_index] < 0) {
                visit_index[block_index] = low_link[block_index] = visit_count++;
                stack.push_back(block);
                on_stack[block_index] = true;
            }

            // Follows the next edge.
            if (edge < successors_[block_index].size()) {
                const int successor = successors_[block_index][edge++];
                const auto successor_index = static_cast<std::size_t>(successor);
                if (!allowed[successor_index]) continue;
                if (visit_index[successor_index] < 0) visits.push_back({successor, 0});
                else if (on_stack[successor_index])
                    low_link[block_index] = std::min(low_link[block_index], visit_index[successor_index]);
                continue;
            }

            // After the last edge: a block that reaches no block before itself is the head of a component.
            if (low_link[block_index] == visit_index[block_index]) {
                components.emplace_back();
                int top = -1;
                do {
                    top = stack.back();
                    stack.pop_back();
                    on_stack[top] = false;
                    components.back().push_back(top);
                } while (top != block);
            }
            const int block_low_link = low_link[block_index];
            visits.pop_back();
            if (!visits.empty()) {
                int& parent_low_link = low_link[visits.back().block];
                parent_low_link = std::min(parent_low_link, block_low_link);
            }
        }
        return components;
    }

    /// Gives positions to the `allowed` blocks that `entry` reaches. The components follow one another, and
    /// the blocks of each component are arranged again without its head.
    void arrange(int entry, const std::vector<bool>& allowed) {
        const std::vector<std::vector<int>> components = find_components(entry, allowed);
        for (std::size_t c = components.size(); c-- > 0;) {
            const int head = components[c].back();
            position_[head] = next_position_++;
            if (components[c].size() == 1) continue;

            std::vector<bool> without_head(successors_.size(), false);
            for (const int b : components[c]) without_head[b] = b != head;
            for (const int successor : successors_[head])
                if (without_head[successor] && position_[successor] < 0) arrange_and_remove(successor, without_head);
            for (const int b : components[c])
                if (position_[b] < 0) arrange_and_remove(b, without_head);
        }
    }
    /// Arranges the blocks that `entry` reaches, and removes every block that has a position from `allowed`.
    void arrange_and_remove(int entry, std::vector<bool>& allowed) {
        arrange(entry, allowed);
        for (std::size_t b = 0; b < allowed.size(); ++b) allowed[b] = allowed[b] && position_[b] < 0;
    }

    std::vector<std::vector<int>> successors_;
    std::vector<int> position_;
    int next_position_ = 0;
};

}  // namespace

// States

/// Cuts the cells of a value at the offsets at which cells of `pattern` begin and end.
Value Walk::cut_like(const Value& value, const Value& pattern) {
    Value result;
    for (const auto& [offset, cell] : value) {
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
}

Value Walk::join(Mask when, const Value& a, const Value& b) {
    if (when == yes) return a;
    if (when == no) return b;
    Value joined = cut_like(a, b);
    for (const auto& [offset, cell] : cut_like(b, a)) {
        const auto counterpart = joined.find(offset);
        if (counterpart == joined.end()) joined[offset] = cell;
        else counterpart->second.scalar = join(when, counterpart->second.scalar, cell.scalar, cell.size);
    }
    return joined;
}

void Walk::join(MemoryState& state, MemoryState&& other) {
    // Finds the decisions of each path after the last one that both share.
    std::size_t common = 0;
    while (common < std::min(state.path.size(), other.path.size()) && state.path[common] == other.path[common])
        ++common;
    const auto decisions_after_fork = [&](const MemoryState& s) {
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
    join_memory(when, state, other);
    join_registers(when, state.registers, other.registers);
}

void Walk::join_memory(Mask when, MemoryState& state, const MemoryState& other) {
    state.memory.resize(std::max(state.memory.size(), other.memory.size()));
    for (std::size_t k = 0; k < other.memory.size(); ++k) {
        if (state.memory[k] == other.memory[k] || other.memory[k] == nullptr) continue;
        if (state.memory[k] == nullptr) state.memory[k] = other.memory[k];
        else state.memory[k] = std::make_shared<Value>(join(when, *state.memory[k], *other.memory[k]));
    }
}

/// Joins two sets of registers. A register that is set on only one of the two paths is not read after they join.
void Walk::join_registers(Mask when, Registers& registers, const Registers& others) {
    for (auto r = registers.begin(); r != registers.end();) {
        const auto other_register = others.find(r->first);
        if (other_register == others.end()) {
            r = registers.erase(r);
            continue;
        }
        if (r->second != other_register->second) r->second = join(when, r->second, other_register->second);
        ++r;
    }
}

int Walk::add_object(MemoryState& state, bool is_written) {
    const int object = object_count_++;
    if (is_written) {
        state.memory.resize(static_cast<std::size_t>(object) + 1);
        state.memory.back() = std::make_shared<Value>();
    }
    return object;
}

Value Walk::load(MemoryState& state, const Value& pointer, std::size_t size) {
    std::optional<Value> result;
    const std::vector<PossibleValue> cases = cases_of(pointer, *module_.pointer_type());
    for (std::size_t k = cases.size(); k-- > 0;) {
        const PossibleValue& c = cases[k];
        if (c.memory_object == 0) {
            if (cases.size() == 1) fail("memory at an unknown address is read");
            continue;
        }
        const Value part = load_from(state, c, size);
        result = result ? join(c.when, part, *result) : part;
    }
    if (!result) fail("memory at an unknown address is read");
    return *result;
}

/// Reads the bytes at one of the values of an address.
Value Walk::load_from(const MemoryState& state, const PossibleValue& address, std::size_t size) {
    const auto offset = static_cast<std::size_t>(address.value);
    if (const auto global = global_memory_.find(address.memory_object); global != global_memory_.end())
        return extract_bytes(global->second, offset, size);
    if (function_objects_.contains(address.memory_object)) fail("the code of a function is read");

    const auto index = static_cast<std::size_t>(address.memory_object);
    if (address.value < 0 || index >= state.memory.size() || state.memory[index] == nullptr)
        fail("memory outside of every variable is read");
    return extract_bytes(*state.memory[index], offset, size);
}

void Walk::store(MemoryState& state, const Value& pointer, std::size_t size, const Value& value) {
    const std::vector<PossibleValue> cases = cases_of(pointer, *module_.pointer_type());
    for (const PossibleValue& c : cases) {
        const auto index = static_cast<std::size_t>(c.memory_object);
        if (global_memory_.contains(c.memory_object)) fail("a global variable is written");
        if (c.memory_object == 0 && cases.size() > 1) continue;
        if (c.memory_object == 0 || c.value < 0 || index >= state.memory.size() || state.memory[index] == nullptr)
            fail("memory at an unknown address is written");

        // States share objects until one of them writes the object.
        std::shared_ptr<Value>& memory = state.memory[index];
        if (memory.use_count() > 1) memory = std::make_shared<Value>(*memory);
        const auto offset = static_cast<std::size_t>(c.value);
        write_bytes(*memory, offset, size,
                    c.when == yes ? value : join(c.when, value, extract_bytes(*memory, offset, size)));
    }
}

/// Enters a block: sets its phis, and joins the state with the state that already waits at the start of the block.
void Walk::enter(CallFrame& frame, MemoryState state, const std::string& target) {
    const auto target_block = frame.blocks.find(target);
    if (target_block == frame.blocks.end()) fail("the LLVM IR has no block " + target);
    const auto block_index = static_cast<std::size_t>(target_block->second);

    // A phi may read a register that another phi of the block sets, so all are read before one is set.
    std::vector<std::pair<std::string, Value>> phis = read_phis(frame, state, frame.function->blocks[block_index]);
    for (auto& [name, v] : phis) state.registers[name] = std::move(v);

    const auto [waiting, is_new] = frame.pending.try_emplace(frame.positions[block_index]);
    if (is_new) waiting->second = std::move(state);
    else join(waiting->second, std::move(state));
}

/// Returns the registers that the phis of a block set, and their values.
std::vector<std::pair<std::string, Value>> Walk::read_phis(const CallFrame& frame, MemoryState& state,
                                                           const Block& block) {
    std::vector<std::pair<std::string, Value>> phis;
    for (const std::string_view line : block.lines) {
        // Phis stand at the start of the block; debug records may stand between them.
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
        if (auto v = read_phi(frame, state, *type, cursor)) phis.emplace_back(name, std::move(*v));
    }
    return phis;
}

/// Reads `[VALUE, %BLOCK], ...`, and returns the value for the preceding block. The others may be undefined, so they
/// are not read.
std::optional<Value> Walk::read_phi(const CallFrame& frame, MemoryState& state, const Type& type, Cursor& cursor) {
    std::optional<Value> result;
    while (cursor.take("[")) {
        Cursor value_cursor = cursor;
        skip_phi_value(cursor);
        cursor.expect(",");
        cursor.expect("%");
        if (cursor.take_name() == frame.block && !result) result = value(state, type, value_cursor);
        cursor.expect("]");
        cursor.take(",");
    }
    return result;
}

/// Enters a block under the condition `when`. Does nothing if the decisions of the path exclude it.
void Walk::branch(CallFrame& frame, MemoryState& state, Mask when, const std::string& target) {
    if (when == no) return;
    MemoryState next_state = state;
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

void Walk::add_return_state(CallFrame& frame, MemoryState& state, Value value) {
    MemoryState return_state = std::move(state);
    return_state.registers.clear();
    return_state.registers["ret"] = std::move(value);
    if (!frame.returned) frame.returned = std::move(return_state);
    else join(*frame.returned, std::move(return_state));
}

auto Walk::run_function(const IrFunction& f, std::vector<Value> arguments, MemoryState state, int caller)
    -> std::optional<std::pair<MemoryState, Value>> {
    if (depth_ > 60) fail("calls are nested too deeply; a function that calls itself is not followed");
    if (arguments.size() < f.parameters.size()) fail("it is called with too few arguments");
    ++depth_;
    CallFrame frame = make_frame(f, caller);

    const Registers caller_registers = std::move(state.registers);
    state.registers.clear();
    set_parameters(state, f, arguments);
    frame.pending.emplace(frame.positions[0], std::move(state));
    run_blocks(frame);
    --depth_;

    if (!frame.returned) return {};
    MemoryState final_state = std::move(*frame.returned);
    Value result = std::move(final_state.registers["ret"]);
    final_state.registers = caller_registers;
    return std::pair(std::move(final_state), std::move(result));
}

/// Prepares a call: finds the successors of each block, and the order in which the blocks run.
Walk::CallFrame Walk::make_frame(const IrFunction& function, int caller) {
    CallFrame frame{
        .function = &function, .caller = caller, .positions = {}, .blocks = {}, .pending = {}, .visits = {}};
    for (std::size_t b = 0; b < function.blocks.size(); ++b)
        frame.blocks[function.blocks[b].name] = static_cast<int>(b);

    std::vector<std::vector<int>> successors(function.blocks.size());
    for (std::size_t b = 0; b < function.blocks.size(); ++b)
        for (const std::string& label :
             labels_in(function.blocks[b].lines.empty() ? "" : function.blocks[b].lines.back()))
            if (const auto block = frame.blocks.find(label); block != frame.blocks.end())
                successors[b].push_back(block->second);
    frame.positions = BlockOrder(successors).positions();
    frame.visits.assign(function.blocks.size(), 0);
    return frame;
}

/// Sets the registers of the parameters. A structure that is passed by value is copied.
void Walk::set_parameters(MemoryState& state, const IrFunction& function, const std::vector<Value>& arguments) {
    for (std::size_t k = 0; k < function.parameters.size(); ++k) {
        const IrParameter& p = function.parameters[k];
        Value argument = arguments[k];
        if (p.by_value != nullptr) {
            const Value copy = load(state, argument, p.by_value->size);
            argument = integer_from_cases({{yes, add_object(state), 0}}, 8);
            store(state, argument, p.by_value->size, copy);
        }
        state.registers[p.name] = std::move(argument);
    }
}

/// Runs blocks until no state waits: each time the block with the lowest position at which one waits.
void Walk::run_blocks(CallFrame& frame) {
    const std::vector<Block>& blocks = frame.function->blocks;
    std::map<int, std::size_t> block_at_position;
    for (std::size_t b = 0; b < blocks.size(); ++b) block_at_position[frame.positions[b]] = b;

    while (!frame.pending.empty()) {
        auto first = frame.pending.begin();
        const std::size_t b = block_at_position[first->first];
        MemoryState current_state = std::move(first->second);
        frame.pending.erase(first);

        frame.block = blocks[b].name;
        if (++frame.visits[b] > max_visits)
            fail("a loop has no bound that is known before it runs: after " + std::to_string(max_visits) +
                 " rounds it may still go on");
        for (const std::string_view line : blocks[b].lines)
            if (!run_instruction(frame, current_state, line)) break;
    }
}

Walk::Answer Walk::run(const std::string& name, int input_count) {
    try {
        const IrFunction* const f = module_.find_function(name);
        if (f == nullptr) fail("the LLVM IR does not define " + name);

        // Passes a pointer to each of the three objects.
        MemoryState state;
        std::vector<Value> arguments;
        for (int k = 0; k < 3; ++k) arguments.push_back(integer_from_cases({{yes, add_object(state), 0}}, 8));
        const std::size_t size = nodes_.bits() / 8;
        Value input;
        for (int k = 0; k < input_count; ++k)
            write_bytes(input, static_cast<std::size_t>(k) * size, size, number(nodes_.input(k)));
        *state.memory[in_object] = input;

        const auto result = run_function(*f, arguments, std::move(state), -1);
        if (!result) fail("the function never returns");
        return read_answer(result->first);
    } catch (const NotFollowed& reason) {
        const int user_place = innermost_user_place(nodes_.place);
        if (user_place < 0) throw InputError(reason.what());
        const SourcePlace& p = places_[user_place];
        throw InputError(p.file + ":" + std::to_string(p.line) + ":" + std::to_string(p.column) + ": " + reason.what());
    }
}

/// Reads what the function has written to its outputs: t and the far t, and whether it hits.
Walk::Answer Walk::read_answer(const MemoryState& state) {
    Mask hits = no;
    for (const PossibleValue& c : cases_of(*state.memory[hit_object], *module_.integer_type(32)))
        if (c.value != 0) hits = nodes_.logical_or(hits, c.when);

    const std::size_t size = nodes_.bits() / 8;
    const Type number_type{.kind = Type::Kind::number, .size = size, .align = size, .bits = nodes_.bits()};
    const auto output = [&](std::size_t k) {
        const Value bytes = extract_bytes(*state.memory[out_object], k * size, size);
        return bytes.empty() ? no_node : number_of(bytes, number_type);
    };
    return {hits, output(0), output(1)};
}

}  // namespace lostbits::intersect::function
