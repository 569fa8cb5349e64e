#include "intersect/function/walk.hpp"

#include <algorithm>
#include <bit>
#include <functional>

#include "intersect/function/block_order.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

constexpr std::size_t most_cases = 128;
constexpr int most_visits = 3000;

/// Names after `label %` in the last instruction of a block.
std::vector<std::string> labels_in(std::string_view line) {
    std::vector<std::string> found;
    constexpr std::string_view mark = "label %";
    for (std::size_t at = line.find(mark); at != std::string_view::npos; at = line.find(mark, at + 1)) {
        Cursor name(line.substr(at + mark.size()));
        found.push_back(name.name());
    }
    return found;
}

std::uint64_t low_bits(std::size_t bytes) {
    return bytes >= 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << 8 * bytes) - 1;
}

}  // namespace

// Values

Value Walk::whole(std::vector<Case> cases, std::size_t size) const {
    return {{0, {size, {.kind = Scalar::Kind::whole, .cases = std::move(cases)}}}};
}

Value Walk::number(NodeId node) const {
    const std::size_t size = nodes_.bits() == 64 || nodes_[node].wide ? 8 : 4;
    return {{0, {size, {.kind = Scalar::Kind::number, .node = node}}}};
}

Value Walk::from_mask(Mask m, std::size_t size) {
    if (m == yes || m == no) return whole({{yes, 0, m == yes}}, size);
    return whole({{m, 0, 1}, {nodes_.opposite(m), 0, 0}}, size);
}

/// A number whose bits are known integers.
std::optional<NodeId> Walk::from_bits(const Scalar& scalar, std::size_t size) {
    if (scalar.kind != Scalar::Kind::whole || (size != 4 && size != 8)) return {};
    NodeId all = no_node;
    for (std::size_t k = scalar.cases.size(); k-- > 0;) {
        const Case& c = scalar.cases[k];
        if (c.object != 0) return {};
        const double x = size == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(c.value))
                                   : std::bit_cast<double>(static_cast<std::uint64_t>(c.value));
        const NodeId one = nodes_.constant(x, nodes_.bits() == 32 && size == 8);
        all = all == no_node ? one : nodes_.select(c.when, one, all);
    }
    return all;
}

NodeId Walk::number_of(const Value& value, const Type& type) {
    if (type.kind != Type::Kind::number) fail("numbers of a type other than float and double are not followed");
    if (type.bits < nodes_.bits()) fail("a function of double that computes in float inside is not followed");
    if (value.empty()) return nodes_.constant(0, nodes_.bits() < type.bits);  // undefined: any number
    const auto& [at, cell] = *value.begin();
    if (cell.scalar.kind == Scalar::Kind::lost) fail(cell.scalar.why);
    if (cell.scalar.kind == Scalar::Kind::undefined) return nodes_.constant(0, nodes_.bits() < type.bits);
    if (value.size() == 1 && at == 0 && cell.size == type.size) {
        if (cell.scalar.kind == Scalar::Kind::number) return cell.scalar.node;
        if (const auto known = from_bits(cell.scalar, cell.size)) return *known;
    }
    fail("a number is made of the bits of others");
}

std::vector<Case> Walk::distinct(std::vector<Case> cases) {
    std::vector<Case> found;
    for (const Case& c : cases) {
        if (c.when == no) continue;
        const auto same =
            std::ranges::find_if(found, [&c](const Case& f) { return f.object == c.object && f.value == c.value; });
        if (same == found.end()) found.push_back(c);
        else same->when = nodes_.either(same->when, c.when);
        if (found.size() > most_cases) fail("an integer that depends on numbers takes too many values");
    }
    if (found.empty()) found.push_back({yes, 0, 0});  // cannot be reached
    if (found.size() == 1) found[0].when = yes;
    return found;
}

std::vector<Case> Walk::cases_of(const Value& value, const Type& type) {
    if (value.empty()) return {{yes, 0, 0}};  // undefined
    const Scalar& first = value.begin()->second.scalar;
    if (first.kind == Scalar::Kind::lost) fail(first.why);
    if (value.size() == 1 && value.begin()->first == 0 && first.kind == Scalar::Kind::whole) return first.cases;
    if (value.size() == 1 && first.kind == Scalar::Kind::undefined) return {{yes, 0, 0}};
    // Bytes beside each other, and numbers that are known.
    if (type.size > 8 || type.size == 0 || std::prev(value.end())->first >= 8)
        fail("integers of more than 64 bits are not followed");
    std::vector<Case> all{{yes, 0, 0}};
    for (const auto& [at, cell] : value) {
        std::vector<Case> bits;
        if (cell.scalar.kind == Scalar::Kind::whole) bits = cell.scalar.cases;
        else if (cell.scalar.kind == Scalar::Kind::number && nodes_[cell.scalar.node].op == TapeOp::constant) {
            const double x = nodes_[cell.scalar.node].value;
            bits = {{yes, 0,
                     cell.size == 4 ? static_cast<std::int64_t>(std::bit_cast<std::uint32_t>(static_cast<float>(x)))
                                    : std::bit_cast<std::int64_t>(x)}};
        } else if (cell.scalar.kind != Scalar::Kind::undefined) {
            fail("an integer operation on the bits of a number is not followed");
        }
        if (bits.empty()) continue;
        std::vector<Case> more;
        for (const Case& a : all)
            for (const Case& b : bits) {
                if (b.object != 0) fail("an operation on the bytes of an address is not followed");
                const std::uint64_t shifted = (static_cast<std::uint64_t>(b.value) & low_bits(cell.size)) << 8 * at;
                more.push_back({nodes_.both(a.when, b.when), 0,
                                static_cast<std::int64_t>(static_cast<std::uint64_t>(a.value) | shifted)});
            }
        all = distinct(std::move(more));
    }
    if (type.size < 8)
        for (Case& c : all) {  // as every integer here: sign-extended
            const auto shift = static_cast<int>(64 - 8 * type.size);
            c.value = static_cast<std::int64_t>(static_cast<std::uint64_t>(c.value) << shift) >> shift;
        }
    return all;
}

Mask Walk::mask_of(const Value& value) {
    Mask all = no;
    for (const Case& c : cases_of(value, *module_.integer_type(8)))
        if ((c.value & 1) != 0) all = nodes_.either(all, c.when);
    return all;
}

/// Bytes `from` to `from + count` of a scalar.
std::optional<Scalar> Walk::slice(const Scalar& scalar, std::size_t size, std::size_t from, std::size_t count) {
    if (from == 0 && count == size) return scalar;
    if (scalar.kind == Scalar::Kind::undefined || scalar.kind == Scalar::Kind::lost) return scalar;
    Scalar bits = scalar;
    if (scalar.kind == Scalar::Kind::number) {
        if (nodes_[scalar.node].op != TapeOp::constant) return {};
        bits = {.kind = Scalar::Kind::whole, .cases = cases_of({{0, {size, scalar}}}, *module_.integer_type(64))};
        if (size == 4) bits.cases = cases_of({{0, {size, scalar}}, {4, {4, {}}}}, *module_.integer_type(64));
    }
    std::vector<Case> cases;
    for (Case c : bits.cases) {
        if (c.object != 0) return {};
        const std::uint64_t moved = from >= 8 ? 0 : static_cast<std::uint64_t>(c.value) >> 8 * from;
        const auto shift = static_cast<int>(64 - 8 * std::min<std::size_t>(count, 8));
        c.value = static_cast<std::int64_t>(moved << shift) >> shift;
        cases.push_back(c);
    }
    return Scalar{.kind = Scalar::Kind::whole, .cases = distinct(std::move(cases))};
}

Value Walk::part_of(const Value& value, std::size_t from, std::size_t count) {
    Value found;
    for (const auto& [at, cell] : value) {
        const std::size_t begin = std::max(at, from), end = std::min(at + cell.size, from + count);
        if (begin >= end) continue;
        auto part = slice(cell.scalar, cell.size, begin - at, end - begin);
        if (!part) part = Scalar{.kind = Scalar::Kind::lost, .why = "an operation on some bytes of a number"};
        found[begin - from] = {end - begin, std::move(*part)};
    }
    return found;
}

/// Replaces bytes `at` to `at + size`.
void Walk::put(Value& into, std::size_t at, std::size_t size, const Value& value) {
    auto place = into.lower_bound(at);
    if (place != into.begin() && std::prev(place)->first + std::prev(place)->second.size > at) --place;
    Value kept;
    while (place != into.end() && place->first < at + size) {
        const std::size_t begin = place->first, end = begin + place->second.size;
        const Value one{{0, place->second}};
        if (begin < at) kept[begin] = part_of(one, 0, at - begin).begin()->second;
        if (end > at + size) kept[at + size] = part_of(one, at + size - begin, end - at - size).begin()->second;
        place = into.erase(place);
    }
    for (auto& [k, cell] : kept) into[k] = cell;
    const auto last = value.empty() ? value.end() : std::prev(value.end());
    const bool fits = value.empty() || last->first + last->second.size <= size;
    const Value cut = fits ? Value() : part_of(value, 0, size);
    for (const auto& [k, cell] : fits ? value : cut) into[at + k] = cell;
}

Scalar Walk::join(Mask when, const Scalar& a, const Scalar& b, std::size_t size) {
    using Kind = Scalar::Kind;
    if (a == b || b.kind == Kind::undefined) return a;
    if (a.kind == Kind::undefined) return b;
    if (a.kind == Kind::lost) return a;
    if (b.kind == Kind::lost) return b;
    if (a.kind == Kind::whole && b.kind == Kind::whole) {
        std::vector<Case> cases;
        for (const Case& c : a.cases) cases.push_back({nodes_.both(when, c.when), c.object, c.value});
        for (const Case& c : b.cases) cases.push_back({nodes_.both(nodes_.opposite(when), c.when), c.object, c.value});
        if (cases.size() > most_cases)
            return {.kind = Kind::lost, .why = "an integer that depends on numbers takes too many values"};
        return {.kind = Kind::whole, .cases = distinct(std::move(cases))};
    }
    const auto as_number = [&](const Scalar& s) {
        return s.kind == Kind::number ? std::optional(s.node) : from_bits(s, size);
    };
    const auto x = as_number(a), y = as_number(b);
    if (!x || !y) return {.kind = Kind::lost, .why = "the same memory holds a number or an address, by a decision"};
    return {.kind = Kind::number, .node = nodes_.select(when, *x, *y)};
}

Value Walk::join(Mask when, const Value& a, const Value& b) {
    if (when == yes) return a;
    if (when == no) return b;
    // Cuts the cells of both values at the same offsets.
    const auto cut = [&](const Value& x, const Value& like) {
        Value made;
        for (const auto& [at, cell] : x) {
            std::vector<std::size_t> ends;
            for (const auto& [k, other] : like)
                for (const std::size_t e : {k, k + other.size})
                    if (e > at && e < at + cell.size) ends.push_back(e);
            ends.push_back(at + cell.size);
            std::ranges::sort(ends);
            std::size_t begin = at;
            for (const std::size_t end : ends) {
                if (end == begin) continue;
                const Value part = part_of({{0, cell}}, begin - at, end - begin);
                made[begin] = part.begin()->second;
                begin = end;
            }
        }
        return made;
    };
    const Value x = cut(a, b), y = cut(b, a);
    Value all = x;
    for (const auto& [at, cell] : y) {
        const auto same = all.find(at);
        if (same == all.end()) all[at] = cell;
        else same->second.scalar = join(when, same->second.scalar, cell.scalar, cell.size);
    }
    return all;
}

Value Walk::zero(const Type& type) {
    if (type.kind == Type::Kind::number && type.bits >= nodes_.bits())
        return number(nodes_.constant(0, type.bits > nodes_.bits()));
    return whole({{yes, 0, 0}}, type.size);
}

// States

void Walk::join(State& into, State&& other) {
    std::size_t common = 0;
    while (common < std::min(into.path.size(), other.path.size()) && into.path[common] == other.path[common]) ++common;
    const auto rest = [&](const State& s) {
        Mask all = yes;
        for (std::size_t k = common; k < s.path.size(); ++k) all = nodes_.both(all, s.path[k]);
        return all;
    };
    const Mask left = rest(into), right = rest(other);
    // If the two paths part by one decision, that decision alone separates them.
    Mask when = left;
    if (common < into.path.size() && common < other.path.size() &&
        nodes_.opposite(into.path[common]) == other.path[common])
        when = into.path[common];
    else if (other.path.size() - common < into.path.size() - common) when = nodes_.opposite(right);
    const Mask any = nodes_.either(left, right);
    into.path.resize(common);
    if (any != yes) into.path.push_back(any);
    into.memory.resize(std::max(into.memory.size(), other.memory.size()));
    for (std::size_t k = 0; k < other.memory.size(); ++k) {
        if (into.memory[k] == other.memory[k] || other.memory[k] == nullptr) continue;
        if (into.memory[k] == nullptr) into.memory[k] = other.memory[k];
        else into.memory[k] = std::make_shared<Value>(join(when, *into.memory[k], *other.memory[k]));
    }
    // A register that only one of the two paths has set is not read after this point.
    for (auto r = into.registers.begin(); r != into.registers.end();) {
        const auto same = other.registers.find(r->first);
        if (same == other.registers.end()) {
            r = into.registers.erase(r);
            continue;
        }
        if (r->second != same->second) r->second = join(when, r->second, same->second);
        ++r;
    }
}

int Walk::new_object(State& state, bool is_written) {
    const int object = objects_++;
    if (is_written) {
        state.memory.resize(static_cast<std::size_t>(object) + 1);
        state.memory.back() = std::make_shared<Value>();
    }
    return object;
}

Value Walk::load(State& state, const Value& pointer, std::size_t size) {
    std::optional<Value> all;
    const std::vector<Case> cases = cases_of(pointer, *module_.pointer_type());
    for (std::size_t k = cases.size(); k-- > 0;) {
        const Case& c = cases[k];
        if (c.object == 0) {
            if (cases.size() == 1) fail("memory at an unknown address is read");
            continue;
        }
        Value found;
        const auto index = static_cast<std::size_t>(c.object);
        if (const auto global = global_memory_.find(c.object); global != global_memory_.end())
            found = part_of(global->second, static_cast<std::size_t>(c.value), size);
        else if (functions_.contains(c.object)) fail("the code of a function is read");
        else if (c.value < 0 || index >= state.memory.size() || state.memory[index] == nullptr)
            fail("memory is read that is not there");
        else found = part_of(*state.memory[index], static_cast<std::size_t>(c.value), size);
        all = all ? join(c.when, found, *all) : found;
    }
    if (!all) fail("memory at an unknown address is read");
    return *all;
}

void Walk::store(State& state, const Value& pointer, std::size_t size, const Value& value) {
    const std::vector<Case> cases = cases_of(pointer, *module_.pointer_type());
    for (const Case& c : cases) {
        const auto index = static_cast<std::size_t>(c.object);
        if (global_memory_.contains(c.object)) fail("a global variable is written");
        if (c.object == 0 && cases.size() > 1) continue;
        if (c.object == 0 || c.value < 0 || index >= state.memory.size() || state.memory[index] == nullptr)
            fail("memory at an unknown address is written");
        std::shared_ptr<Value>& memory = state.memory[index];
        if (memory.use_count() > 1) memory = std::make_shared<Value>(*memory);
        const auto at = static_cast<std::size_t>(c.value);
        put(*memory, at, size, c.when == yes ? value : join(c.when, value, part_of(*memory, at, size)));
    }
}

/// Enters a block: sets its phis, and joins the state with those that wait there.
void Walk::enter(Frame& frame, State state, const std::string& target) {
    const auto found = frame.blocks.find(target);
    if (found == frame.blocks.end()) fail("the LLVM IR has no block " + target);
    const Block& block = frame.function->blocks[static_cast<std::size_t>(found->second)];
    std::vector<std::pair<std::string, Value>> phis;
    for (const std::string_view line : block.lines) {
        Cursor at(line);
        if (!at.take("%")) {
            if (at.peek() == '#' || at.take("call void @llvm.dbg")) continue;
            break;
        }
        const std::string name = at.name();
        at.expect("=");
        if (!at.take("phi")) break;
        while (at.take("nnan") || at.take("ninf") || at.take("nsz") || at.take("arcp") || at.take("contract") ||
               at.take("afn") || at.take("reassoc") || at.take("fast")) {}
        const Type* const type = module_.type(at);
        bool is_set = false;
        while (at.take("[")) {
            Cursor skipped = at;  // a value is read only if it is the one, since others may not be known yet
            std::size_t depth = 0, k = 0;
            const std::string_view text = at.rest();
            bool quoted = false;
            for (; k < text.size() && (depth > 0 || quoted || text[k] != ','); ++k) {
                if (text[k] == '"') quoted = !quoted;
                if (std::string_view("([{<").find(text[k]) != std::string_view::npos) ++depth;
                if (std::string_view(")]}>").find(text[k]) != std::string_view::npos && depth > 0) --depth;
            }
            if (k >= text.size()) at.fail("a phi has no end");
            at = Cursor(text.substr(k));
            at.expect(",");
            at.expect("%");
            if (at.name() == frame.block && !is_set) {
                phis.emplace_back(name, value(state, *type, skipped));
                is_set = true;
            }
            at.expect("]");
            at.take(",");
        }
    }
    for (auto& [name, v] : phis) state.registers[name] = std::move(v);
    const int position = frame.order[static_cast<std::size_t>(found->second)];
    const auto [waiting, is_new] = frame.pending.try_emplace(position);
    if (is_new) waiting->second = std::move(state);
    else join(waiting->second, std::move(state));
}

/// Enters a block if the decision holds.
void Walk::branch(Frame& frame, State& state, Mask when, const std::string& target) {
    if (when == no) return;
    State there = state;
    if (when != yes) {
        const Mask other = there.path.empty() ? no : nodes_.opposite(when);
        for (const Mask m : there.path) {
            if (m == other) return;
            if (m == when) when = yes;
        }
        if (when != yes) there.path.push_back(when);
    }
    enter(frame, std::move(there), target);
}

void Walk::take_return(Frame& frame, State& state, Value value) {
    State over = std::move(state);
    over.registers.clear();
    over.registers["ret"] = std::move(value);
    if (!frame.returned) frame.returned = std::move(over);
    else join(*frame.returned, std::move(over));
}

auto Walk::call(const IrFunction& f, std::vector<Value> arguments, State state, int caller)
    -> std::optional<std::pair<State, Value>> {
    if (depth_ > 60) fail("calls are nested too deeply; a function that calls itself is not followed");
    if (arguments.size() < f.parameters.size()) fail("it is called with too few arguments");
    ++depth_;
    Frame frame{.function = &f, .caller = caller, .order = {}, .blocks = {}, .pending = {}, .visits = {}};
    std::vector<std::vector<int>> next(f.blocks.size());
    for (std::size_t b = 0; b < f.blocks.size(); ++b) frame.blocks[f.blocks[b].name] = static_cast<int>(b);
    for (std::size_t b = 0; b < f.blocks.size(); ++b)
        for (const std::string& to : labels_in(f.blocks[b].lines.empty() ? "" : f.blocks[b].lines.back()))
            if (const auto block = frame.blocks.find(to); block != frame.blocks.end()) next[b].push_back(block->second);
    frame.order = BlockOrder(next).positions();
    frame.visits.assign(f.blocks.size(), 0);
    std::map<int, std::size_t> at_position;
    for (std::size_t b = 0; b < f.blocks.size(); ++b) at_position[frame.order[b]] = b;

    const Registers before = std::move(state.registers);
    state.registers.clear();
    for (std::size_t k = 0; k < f.parameters.size(); ++k) {
        const IrParameter& p = f.parameters[k];
        Value given = arguments[k];
        if (p.by_value != nullptr) {
            const Value copy = load(state, given, p.by_value->size);
            given = whole({{yes, new_object(state), 0}}, 8);
            store(state, given, p.by_value->size, copy);
        }
        state.registers[p.name] = std::move(given);
    }
    frame.pending.emplace(frame.order[0], std::move(state));
    while (!frame.pending.empty()) {
        auto first = frame.pending.begin();
        const std::size_t b = at_position[first->first];
        State here = std::move(first->second);
        frame.pending.erase(first);
        const Block& block = f.blocks[b];
        frame.block = block.name;
        if (++frame.visits[b] > most_visits)
            fail("a loop has no bound that is known before it runs: after " + std::to_string(most_visits) +
                 " rounds it may still go on");
        for (const std::string_view line : block.lines)
            if (!step(frame, here, line)) break;
    }
    --depth_;
    if (!frame.returned) return {};
    State after = std::move(*frame.returned);
    Value result = std::move(after.registers["ret"]);
    after.registers = before;
    return std::pair(std::move(after), std::move(result));
}

Walk::Answer Walk::run(const std::string& name, int inputs) {
    try {
        const IrFunction* const f = module_.function(name);
        if (f == nullptr) fail("the LLVM IR does not define " + name);
        State state;
        const std::size_t size = nodes_.bits() / 8;
        std::vector<Value> arguments;
        for (int k = 0; k < 3; ++k) arguments.push_back(whole({{yes, new_object(state), 0}}, 8));
        Value given;
        for (int k = 0; k < inputs; ++k) put(given, static_cast<std::size_t>(k) * size, size, number(nodes_.input(k)));
        *state.memory[1] = given;
        auto over = call(*f, arguments, std::move(state), -1);
        if (!over) fail("the function never returns");
        const Type number_type{.kind = Type::Kind::number, .size = size, .align = size, .bits = nodes_.bits()};
        const Value& out = *over->first.memory[2];
        const auto answer = [&](std::size_t k) {
            const Value one = part_of(out, k * size, size);
            return one.empty() ? no_node : number_of(one, number_type);
        };
        const Value& hit = *over->first.memory[3];
        Mask hits = no;
        for (const Case& c : cases_of(hit, *module_.integer_type(32)))
            if (c.value != 0) hits = nodes_.either(hits, c.when);
        return {hits, answer(0), answer(1)};
    } catch (const NotFollowed& reason) {
        const int own = own_place(nodes_.place);
        if (own < 0) throw InputError(reason.what());
        const SourcePlace& p = places_[static_cast<std::size_t>(own)];
        throw InputError(p.file + ":" + std::to_string(p.line) + ":" + std::to_string(p.column) + ": " + reason.what());
    }
}

}  // namespace lostbits::intersect::function
