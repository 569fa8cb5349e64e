// The instructions of LLVM IR.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#include "intersect/function/walk.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

constexpr std::size_t most_steps = 3'000'000;

void skip_flags(Cursor& at) {
    constexpr std::array flags{"nnan",     "ninf", "nsz",      "arcp",     "contract", "afn",
                               "reassoc",  "fast", "nuw",      "nsw",      "exact",    "disjoint",
                               "inbounds", "nneg", "samesign", "volatile", "nusw"};
    for (bool again = true; again;) {
        again = false;
        for (const char* const flag : flags) again = at.take(flag) || again;
    }
}

/// The bits of an integer type, sign-extended; of i1, 0 or 1.
std::int64_t wrapped(std::uint64_t x, int bits) {
    if (bits == 1) return static_cast<std::int64_t>(x & 1);
    if (bits >= 64) return static_cast<std::int64_t>(x);
    return static_cast<std::int64_t>(x << (64 - bits)) >> (64 - bits);
}

std::uint64_t without_sign(std::int64_t x, int bits) {
    return bits >= 64 ? static_cast<std::uint64_t>(x)
                      : static_cast<std::uint64_t>(x) & ((std::uint64_t{1} << bits) - 1);
}

/// Result of an integer operation; nothing if it has none (division by zero).
std::optional<std::int64_t> computed(std::string_view op, std::int64_t a, std::int64_t b, int bits) {
    const std::uint64_t x = without_sign(a, bits), y = without_sign(b, bits);
    const bool shifts = y < static_cast<std::uint64_t>(bits);
    if (op == "add") return wrapped(x + y, bits);
    if (op == "sub") return wrapped(x - y, bits);
    if (op == "mul") return wrapped(x * y, bits);
    if (op == "and") return wrapped(x & y, bits);
    if (op == "or") return wrapped(x | y, bits);
    if (op == "xor") return wrapped(x ^ y, bits);
    if (op == "shl") return shifts ? wrapped(x << y, bits) : 0;
    if (op == "lshr") return shifts ? wrapped(x >> y, bits) : 0;
    if (op == "ashr") return shifts ? wrapped(static_cast<std::uint64_t>(a >> y), bits) : 0;
    if (b == 0 || (b == -1 && a == INT64_MIN)) return {};
    if (op == "udiv") return wrapped(x / y, bits);
    if (op == "urem") return wrapped(x % y, bits);
    if (op == "sdiv") return wrapped(static_cast<std::uint64_t>(a / b), bits);
    if (op == "srem") return wrapped(static_cast<std::uint64_t>(a % b), bits);
    return {};
}

bool holds(std::string_view predicate, std::int64_t a, std::int64_t b, int bits) {
    const std::uint64_t x = without_sign(a, bits), y = without_sign(b, bits);
    if (bits == 1) a = -a, b = -b;
    if (predicate == "eq") return a == b;
    if (predicate == "ne") return a != b;
    if (predicate == "slt") return a < b;
    if (predicate == "sle") return a <= b;
    if (predicate == "sgt") return a > b;
    if (predicate == "sge") return a >= b;
    if (predicate == "ult") return x < y;
    if (predicate == "ule") return x <= y;
    if (predicate == "ugt") return x > y;
    return x >= y;
}

constexpr std::array whole_operations{"add", "sub",  "mul",  "udiv", "sdiv", "urem", "srem",
                                      "shl", "lshr", "ashr", "and",  "or",   "xor"};

/// What a function is called in the source, for messages.
std::string shown(const std::string& name) {
    if (name.starts_with("llvm.")) return name.substr(5, name.find('.', 5) - 5);
    return name;
}

}  // namespace

/// Applies `act(type of a lane, offset)` to each lane of a vector, or to the type itself.
template <class Act>
Value Walk::each_lane(const Type& type, const Act& act) {
    if (!type.is_vector) return act(type, 0);
    Value all;
    for (std::size_t k = 0; k < type.count; ++k) {
        std::size_t at = 0;
        const Type& lane = *type.part(k, at);
        put(all, at, lane.size, act(lane, at));
    }
    return all;
}

// Operands

NodeId Walk::literal(const Type& type, Cursor& at) {
    const std::string_view text = at.rest();
    std::size_t n = 0;
    while (n < text.size() && (std::isalnum(static_cast<unsigned char>(text[n])) != 0 || text[n] == '.' ||
                               text[n] == '-' || text[n] == '+'))
        ++n;
    const std::string_view digits = text.substr(0, n);
    at = Cursor(text.substr(n));
    double x = 0;
    if (digits.starts_with("0x")) {
        std::uint64_t bits = 0;
        const auto [end, error] = std::from_chars(digits.data() + 2, digits.data() + digits.size(), bits, 16);
        if (error != std::errc() || end != digits.data() + digits.size()) at.fail("a number is unknown");
        x = std::bit_cast<double>(bits);
    } else {
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
        if (error != std::errc() || end != digits.data() + digits.size()) at.fail("a number is unknown");
    }
    if (type.bits < nodes_.bits()) fail("a function of double that computes in float inside is not followed");
    return nodes_.constant(x, type.bits > nodes_.bits());
}

Value Walk::address_of(State& state, const std::string& name) {
    const auto [known, is_new] = global_objects_.try_emplace(name, 0);
    if (is_new) {
        known->second = new_object(state, false);
        const int object = known->second;
        if (const auto global = module_.globals.find(name); global != module_.globals.end()) {
            global_memory_[object] = {};
            if (!global->second.value.empty()) {
                Cursor at(global->second.value);
                Value initial = constant(state, *global->second.type, at);
                global_memory_[object] = std::move(initial);
            }
        } else {
            functions_[object] = name;
        }
    }
    return whole({{yes, known->second, 0}}, 8);
}

/// `(TYPE, ptr BASE, i64 0, i32 1)`, of an instruction or in a constant.
Value Walk::element_address(State& state, Cursor& at) {
    skip_flags(at);
    if (at.take("inrange")) at.group();
    const bool is_constant = at.take("(");
    const Type* type = module_.type(at);
    at.expect(",");
    const Type* const pointer = module_.type(at);
    if (pointer->is_vector) fail("vectors of addresses are not followed");
    std::vector<Case> all = cases_of(value(state, *pointer, at), *pointer);
    for (bool first = true; at.take(","); first = false) {
        if (at.peek() == '!') break;
        at.take("inrange");
        const Type* const index_type = module_.type(at);
        const std::vector<Case> index = cases_of(value(state, *index_type, at), *index_type);
        if (!first && type->kind == Type::Kind::structure) {
            std::size_t offset = 0;
            const Type* const part = index.size() == 1 && index[0].value >= 0
                                         ? type->part(static_cast<std::size_t>(index[0].value), offset)
                                         : nullptr;
            if (part == nullptr) fail("an address is outside of its type");
            for (Case& c : all) c.value += static_cast<std::int64_t>(offset);
            type = part;
            continue;
        }
        if (!first) {
            if (type->kind != Type::Kind::sequence) fail("an address is outside of its type");
            type = type->parts[0];
        }
        std::vector<Case> more;
        for (const Case& a : all)
            for (const Case& i : index)
                more.push_back({nodes_.both(a.when, i.when), a.object,
                                static_cast<std::int64_t>(static_cast<std::uint64_t>(a.value) +
                                                          static_cast<std::uint64_t>(i.value) * type->size)});
        all = distinct(std::move(more));
    }
    if (is_constant) at.expect(")");
    return whole(std::move(all), 8);
}

Value Walk::constant(State& state, const Type& type, Cursor& at) {
    struct Nesting {
        int& depth;
        explicit Nesting(int& d) : depth(d) { ++depth; }
        ~Nesting() { --depth; }
        Nesting(const Nesting&) = delete;
        Nesting& operator=(const Nesting&) = delete;
    } const nesting(nesting_);
    if (nesting_ > 100) at.fail("a constant is nested too deeply");
    const char c = at.peek();
    if (c == '@') {
        at.expect("@");
        return address_of(state, at.name());
    }
    if (c == '{' || c == '[' || c == '<') {
        Cursor inside(at.group());
        const bool packed = c == '<' && inside.peek() == '{';
        if (packed) inside = Cursor(inside.group());
        Value all;
        for (std::size_t k = 0; !inside.at_end(); ++k) {
            const Type* const part_type = module_.type(inside);
            std::size_t offset = 0;
            const Type* const part = type.part(k, offset);
            if (part == nullptr || part->size != part_type->size) inside.fail("a constant has another type");
            put(all, offset, part->size, value(state, *part, inside));
            if (!inside.take(",")) break;
        }
        return all;
    }
    if (at.take("zeroinitializer") || at.take("null")) return zero(type);
    if (at.take("undef") || at.take("poison") || at.take("none")) return {};
    if (at.take("true")) return integer(1, type);
    if (at.take("false")) return integer(0, type);
    if (at.take("splat")) {
        Cursor inside(at.group());
        const Type* const lane = module_.type(inside);
        const Value one = value(state, *lane, inside);
        return each_lane(type, [&](const Type&, std::size_t) { return one; });
    }
    if (at.take("getelementptr")) return element_address(state, at);
    for (const char* const op : {"bitcast", "inttoptr", "ptrtoint", "addrspacecast", "trunc", "zext"}) {
        if (!at.take(op)) continue;
        Cursor inside(at.group());
        return converted(state, op, inside);
    }
    if (at.rest().starts_with("c\"")) {
        at.expect("c");
        const std::string text = at.name();
        Value all;
        std::size_t k = 0;
        for (std::size_t i = 0; i < text.size() && k < type.count; ++i, ++k) {
            int byte = static_cast<unsigned char>(text[i]);
            if (text[i] == '\\' && i + 2 < text.size()) {
                std::from_chars(text.data() + i + 1, text.data() + i + 3, byte, 16);
                i += 2;
            }
            put(all, k, 1, whole({{yes, 0, static_cast<signed char>(byte)}}, 1));
        }
        return all;
    }
    if (type.kind == Type::Kind::number) return number(literal(type, at));
    if (type.kind == Type::Kind::integer) {
        if (type.bits > 64) fail("integers of more than 64 bits are not followed");
        Cursor text = at;
        const std::string_view digits = at.word();
        std::int64_t x = 0;
        std::uint64_t u = 0;
        const char* const end = digits.data() + digits.size();
        if (std::from_chars(digits.data(), end, x).ptr != end) x = 0;
        else return integer(wrapped(static_cast<std::uint64_t>(x), type.bits), type);
        if (digits.empty() || std::from_chars(digits.data(), end, u).ptr != end) text.fail("a constant is unknown");
        return integer(wrapped(u, type.bits), type);
    }
    at.fail("a constant is unknown");
}

Value Walk::value(State& state, const Type& type, Cursor& at) {
    if (at.rest().size() > 2'000'000) at.fail("a line is too long");
    module_.skip_attributes(at);
    if (at.take("%")) {
        const std::string name = at.name();
        const auto found = state.registers.find(name);
        if (found == state.registers.end()) fail("the LLVM IR uses %" + name + ", which is not set here");
        return found->second;
    }
    return constant(state, type, at);
}

// Instructions

bool Walk::step(Frame& frame, State& state, std::string_view line) {
    if (++steps_ > most_steps) fail("the function takes too many steps on one ray");
    if (const int p = place_of(line, frame.caller); p >= 0) nodes_.place = p;
    Cursor at(line);
    if (at.peek() == '#') {
        at.expect("#");
        declare(state, line, at, true);
        return true;
    }
    std::string result;
    if (at.take("%")) {
        result = at.name();
        at.expect("=");
    }
    static_cast<void>(at.take("tail") || at.take("musttail") || at.take("notail"));
    const std::string_view op = at.word();
    if (op == "phi") return true;  // set by `enter`
    if (op == "call" && line.find("@llvm.dbg.") != std::string_view::npos) {
        declare(state, line, at, false);
        return true;
    }
    if (op == "br" || op == "switch" || op == "ret" || op == "unreachable" || op == "invoke" || op == "resume" ||
        op == "indirectbr") {
        if (op != "invoke") return end_block(frame, state, op, at);
        const std::vector<std::string> to = [&] {
            const std::size_t normal = line.find("to label %");
            if (normal == std::string_view::npos) at.fail("a call goes nowhere");
            Cursor label(line.substr(normal + 10));
            return std::vector{label.name()};
        }();
        std::optional<Value> answer = called(frame, state, at);
        if (!answer) return false;
        if (!result.empty()) state.registers[result] = std::move(*answer);
        branch(frame, state, yes, to[0]);
        return false;
    }
    if (op == "call") {
        std::optional<Value> answer = called(frame, state, at);
        if (!answer) return false;
        if (!result.empty()) state.registers[result] = std::move(*answer);
        return true;
    }
    Value made = compute(frame, state, op, at);
    if (!result.empty()) state.registers[result] = std::move(made);
    return true;
}

bool Walk::end_block(Frame& frame, State& state, std::string_view op, Cursor& at) {
    if (op == "unreachable" || op == "resume") return false;
    if (op == "ret") {
        const Type* const type = module_.type(at);
        take_return(frame, state, type->kind == Type::Kind::nothing ? Value() : value(state, *type, at));
        return false;
    }
    const auto label = [&at] {
        at.expect("label");
        at.expect("%");
        return at.name();
    };
    if (op == "br") {
        if (at.peek() == 'l') {
            branch(frame, state, yes, label());
            return false;
        }
        const Type* const type = module_.type(at);
        const Mask when = mask_of(value(state, *type, at));
        at.expect(",");
        const std::string left = label();
        at.expect(",");
        branch(frame, state, when, left);
        branch(frame, state, nodes_.opposite(when), label());
        return false;
    }
    if (op == "indirectbr") fail("a jump to a computed place is not followed");
    const Type* const type = module_.type(at);
    const std::vector<Case> cases = cases_of(value(state, *type, at), *type);
    at.expect(",");
    const std::string otherwise = label();
    std::map<std::string, Mask> targets;
    std::vector<bool> taken(cases.size());
    at.expect("[");
    while (!at.take("]")) {
        const Type* const case_type = module_.type(at);
        const std::int64_t x = cases_of(constant(state, *case_type, at), *case_type)[0].value;
        at.expect(",");
        Mask& when = targets.try_emplace(label(), no).first->second;
        for (std::size_t k = 0; k < cases.size(); ++k) {
            if (cases[k].value != x) continue;
            when = nodes_.either(when, cases[k].when);
            taken[k] = true;
        }
    }
    Mask& rest = targets.try_emplace(otherwise, no).first->second;
    for (std::size_t k = 0; k < cases.size(); ++k)
        if (!taken[k]) rest = nodes_.either(rest, cases[k].when);
    for (const auto& [target, when] : targets) branch(frame, state, when, target);
    return false;
}

Value Walk::compute(Frame& frame, State& state, std::string_view op, Cursor& at) {
    if (op == "alloca") {
        at.take("inalloca");
        const Type* const type = module_.type(at);
        static_cast<void>(type);
        return whole({{yes, new_object(state), 0}}, 8);
    }
    if (op == "load") {
        at.take("atomic"), skip_flags(at);
        const Type* const type = module_.type(at);
        at.expect(",");
        const Type* const pointer = module_.type(at);
        return load(state, value(state, *pointer, at), type->size);
    }
    if (op == "store") {
        at.take("atomic"), skip_flags(at);
        const Type* const type = module_.type(at);
        const Value stored = value(state, *type, at);
        at.expect(",");
        const Type* const pointer = module_.type(at);
        const Value address = value(state, *pointer, at);
        for (const Case& c : cases_of(address, *pointer)) {
            const auto variable = variables_.find(c.object);
            if (variable != variables_.end() && c.value >= 0)
                name_value(state, variable->second.first, stored, static_cast<std::size_t>(c.value),
                           variable->second.second);
        }
        store(state, address, type->size, stored);
        return {};
    }
    if (op == "getelementptr") return element_address(state, at);
    if (op == "fadd" || op == "fsub" || op == "fmul" || op == "fdiv" || op == "fneg" || op == "frem")
        return arithmetic(state, op, at);
    if (op == "fcmp") return compare_numbers(state, at);
    if (op == "icmp") return compare_wholes(state, at);
    if (std::ranges::find(whole_operations, op) != whole_operations.end()) return whole_arithmetic(state, op, at);
    if (op == "select") {
        skip_flags(at);
        const Type* const condition = module_.type(at);
        const Value when = value(state, *condition, at);
        at.expect(",");
        const Type* const type = module_.type(at);
        const Value a = value(state, *type, at);
        at.expect(",");
        module_.type(at);
        const Value b = value(state, *type, at);
        if (!condition->is_vector) return join(mask_of(when), a, b);
        std::size_t k = 0;
        return each_lane(*type, [&](const Type& lane, std::size_t from) {
            const Mask m = mask_of(part_of(when, k++, 1));
            return join(m, part_of(a, from, lane.size), part_of(b, from, lane.size));
        });
    }
    if (op == "freeze") {
        const Type* const type = module_.type(at);
        return value(state, *type, at);
    }
    for (const char* const conversion : {"bitcast", "addrspacecast", "inttoptr", "ptrtoint", "trunc", "zext", "sext",
                                         "fpext", "fptrunc", "sitofp", "uitofp", "fptosi", "fptoui"})
        if (op == conversion) return converted(state, op, at);
    if (op == "extractvalue" || op == "insertvalue" || op == "extractelement" || op == "insertelement" ||
        op == "shufflevector")
        return shuffled(state, op, at);
    static_cast<void>(frame);
    fail("the instruction " + std::string(op) + " of LLVM IR is not followed");
}

Value Walk::arithmetic(State& state, std::string_view op, Cursor& at) {
    skip_flags(at);
    const Type* const type = module_.type(at);
    const Value a = value(state, *type, at);
    if (op == "fneg")
        return each_lane(*type, [&](const Type& lane, std::size_t from) {
            return number(nodes_.number(TapeOp::neg, number_of(part_of(a, from, lane.size), lane)));
        });
    at.expect(",");
    const Value b = value(state, *type, at);
    if (op == "frem") fail("the remainder of a division (fmod) is not followed");
    const TapeOp tape_op = op == "fadd"   ? TapeOp::add
                           : op == "fsub" ? TapeOp::sub
                           : op == "fmul" ? TapeOp::mul
                                          : TapeOp::div;
    return each_lane(*type, [&](const Type& lane, std::size_t from) {
        const NodeId x = number_of(part_of(a, from, lane.size), lane), y = number_of(part_of(b, from, lane.size), lane);
        // -0 - x is how older compilers write -x.
        if (tape_op == TapeOp::sub && nodes_[x].op == TapeOp::constant && nodes_[x].value == 0 &&
            std::signbit(nodes_[x].value))
            return number(nodes_.number(TapeOp::neg, y));
        return number(nodes_.number(tape_op, x, y));
    });
}

Value Walk::compare_numbers(State& state, Cursor& at) {
    skip_flags(at);
    const std::string_view predicate = at.word();
    const Type* const type = module_.type(at);
    const Value a = value(state, *type, at);
    at.expect(",");
    const Value b = value(state, *type, at);
    if (predicate.size() < 3 && predicate != "oeq") at.fail("a comparison is unknown");
    const auto decide = [&](NodeId x, NodeId y) -> Mask {
        if (predicate == "true") return yes;
        if (predicate == "false") return no;
        const auto ask = [&](TapeOp op) { return nodes_.compare(op, x, y); };
        const auto equal = [&] { return nodes_.both(ask(TapeOp::less_equal), ask(TapeOp::greater_equal)); };
        const auto apart = [&] { return nodes_.either(ask(TapeOp::less), ask(TapeOp::greater)); };
        const auto ordered = [&] {
            return nodes_.both(nodes_.compare(TapeOp::less_equal, x, x), nodes_.compare(TapeOp::less_equal, y, y));
        };
        if (predicate == "oeq") return equal();
        if (predicate == "une") return nodes_.opposite(equal());
        if (predicate == "one") return apart();
        if (predicate == "ueq") return nodes_.opposite(apart());
        if (predicate == "ord") return ordered();
        if (predicate == "uno") return nodes_.opposite(ordered());
        if (predicate == "olt") return ask(TapeOp::less);
        if (predicate == "ole") return ask(TapeOp::less_equal);
        if (predicate == "ogt") return ask(TapeOp::greater);
        if (predicate == "oge") return ask(TapeOp::greater_equal);
        if (predicate == "ult") return nodes_.opposite(ask(TapeOp::greater_equal));
        if (predicate == "ule") return nodes_.opposite(ask(TapeOp::greater));
        if (predicate == "ugt") return nodes_.opposite(ask(TapeOp::less_equal));
        if (predicate == "uge") return nodes_.opposite(ask(TapeOp::less));
        at.fail("a comparison is unknown");
    };
    if (!type->is_vector) return from_mask(decide(number_of(a, *type), number_of(b, *type)));
    Value all;
    for (std::size_t k = 0; k < type->count; ++k) {
        std::size_t from = 0;
        const Type& lane = *type->part(k, from);
        put(all, k, 1,
            from_mask(
                decide(number_of(part_of(a, from, lane.size), lane), number_of(part_of(b, from, lane.size), lane))));
    }
    return all;
}

Value Walk::compare_wholes(State& state, Cursor& at) {
    skip_flags(at);
    const std::string_view predicate = at.word();
    const Type* const type = module_.type(at);
    const Value a = value(state, *type, at);
    at.expect(",");
    const Value b = value(state, *type, at);
    const auto decide = [&](const Value& p, const Value& q, const Type& lane) {
        Mask all = no;
        const int bits = lane.kind == Type::Kind::pointer ? 64 : lane.bits;
        for (const Case& x : cases_of(p, lane))
            for (const Case& y : cases_of(q, lane)) {
                bool result = false;
                if (x.object == y.object) result = holds(predicate, x.value, y.value, bits);
                else if (predicate == "eq" || predicate == "ne") result = predicate == "ne";
                else fail("addresses of different objects are compared");
                if (result) all = nodes_.either(all, nodes_.both(x.when, y.when));
            }
        return from_mask(all);
    };
    if (!type->is_vector) return decide(a, b, *type);
    Value all;
    for (std::size_t k = 0; k < type->count; ++k) {
        std::size_t from = 0;
        const Type& lane = *type->part(k, from);
        put(all, k, 1, decide(part_of(a, from, lane.size), part_of(b, from, lane.size), lane));
    }
    return all;
}

/// Operations on the bits of numbers that compilers and programmers use: the sign, and parts put side by side.
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
        const auto is_zero = [](const Cell& cell) {
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
    if (auto known = on_bits(op, type, a, b)) return *known;
    if (type.bits == 1 && (op == "and" || op == "or" || op == "xor")) {
        const Mask x = mask_of(a), y = mask_of(b);
        if (op == "and") return from_mask(nodes_.both(x, y));
        if (op == "or") return from_mask(nodes_.either(x, y));
        return from_mask(nodes_.choose(x, nodes_.opposite(y), y));
    }
    if (type.bits > 64) fail("integers of more than 64 bits are not followed");
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
            bool others = false;
            if (nodes_[n].op != TapeOp::constant || std::fabs(nodes_[n].value) > 1e9)
                fail("a number becomes an integer, which is not followed");
            static_cast<void>(others);
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

Value Walk::shuffled(State& state, std::string_view op, Cursor& at) {
    const Type* const type = module_.type(at);
    Value a = value(state, *type, at);
    if (op == "extractvalue") {
        const Type* part = type;
        std::size_t from = 0;
        while (at.take(",") && at.peek() != '!') {
            std::size_t more = 0;
            part = part->part(static_cast<std::size_t>(at.integer()), more);
            if (part == nullptr) at.fail("an index is outside of its type");
            from += more;
        }
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
        const Type* part = type;
        std::size_t to = 0;
        while (at.take(",") && at.peek() != '!') {
            std::size_t more = 0;
            part = part->part(static_cast<std::size_t>(at.integer()), more);
            if (part == nullptr) at.fail("an index is outside of its type");
            to += more;
        }
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

// Calls

/// A call of a function whose meaning is known; nothing if it is none of these.
std::optional<Value> Walk::known_call(State& state, const std::string& name, const Type& type,
                                      const std::vector<Value>& arguments, const std::vector<const Type*>& types) {
    std::string_view base = name;
    const bool is_llvm = base.starts_with("llvm.");
    if (is_llvm) base.remove_prefix(5);
    const auto is = [&](std::string_view word) {
        if (is_llvm) return base == word || (base.starts_with(word) && base[word.size()] == '.');
        return base == word || (base.size() == word.size() + 1 && base.starts_with(word) && base.back() == 'f');
    };
    const auto lanes = [&](std::size_t count, const auto& act) {
        return each_lane(type, [&](const Type& lane, std::size_t from) {
            std::vector<NodeId> x;
            for (std::size_t k = 0; k < count && k < arguments.size(); ++k)
                x.push_back(number_of(part_of(arguments[k], from, lane.size), lane));
            if (x.size() < count) fail("it calls " + shown(name) + " with too few arguments");
            return number(act(x));
        });
    };
    const bool of_numbers =
        type.kind == Type::Kind::number || (type.is_vector && type.parts[0]->kind == Type::Kind::number);
    if (of_numbers && arguments.size() >= 1) {
        if (is("sqrt")) return lanes(1, [&](const auto& x) { return nodes_.number(TapeOp::sqrt, x[0]); });
        if (is("fabs")) return lanes(1, [&](const auto& x) { return nodes_.number(TapeOp::abs, x[0]); });
        if (arguments.size() >= 2) {
            if (is("copysign"))
                return lanes(2, [&](const auto& x) { return nodes_.number(TapeOp::copysign, x[0], x[1]); });
            if (is("minnum") || is("fmin") || is("minimumnum"))
                return lanes(2, [&](const auto& x) { return nodes_.least(TapeOp::min, x[0], x[1]); });
            if (is("maxnum") || is("fmax") || is("maximumnum"))
                return lanes(2, [&](const auto& x) { return nodes_.least(TapeOp::max, x[0], x[1]); });
        }
        if (arguments.size() >= 3) {
            if (is("fma")) return lanes(3, [&](const auto& x) { return nodes_.number(TapeOp::fma, x[0], x[1], x[2]); });
            if (is("fmuladd"))
                return lanes(3, [&](const auto& x) {
                    return nodes_.number(TapeOp::add, nodes_.number(TapeOp::mul, x[0], x[1]), x[2]);
                });
        }
    }
    const auto count_of = [&](std::size_t k) -> std::size_t {
        const std::vector<Case> n = cases_of(arguments[k], *types[k]);
        if (n.size() != 1 || n[0].value < 0 || n[0].value > (1 << 20)) fail("a copy has a length that is not known");
        return static_cast<std::size_t>(n[0].value);
    };
    if (arguments.size() >= 3 && (is("memcpy") || is("memmove"))) {
        const std::size_t n = count_of(2);
        if (n == 0) return arguments[0];
        const Value copied = load(state, arguments[1], n);
        for (const Case& c : cases_of(arguments[0], *types[0]))
            if (const auto v = variables_.find(c.object); v != variables_.end() && c.value >= 0)
                name_value(state, v->second.first, copied, static_cast<std::size_t>(c.value), v->second.second);
        store(state, arguments[0], n, copied);
        return arguments[0];
    }
    if (arguments.size() >= 3 && is("memset")) {
        const std::size_t n = count_of(2);
        const std::vector<Case> byte = cases_of(arguments[1], *types[1]);
        Value all;
        if (byte.size() == 1 && byte[0].value == 0) all = whole(byte, n);
        else
            for (std::size_t k = 0; k < n; ++k) put(all, k, 1, whole(byte, 1));
        if (n > 0) store(state, arguments[0], n, all);
        return arguments[0];
    }
    if (!is_llvm) return {};
    if (is("lifetime") || is("assume") || is("experimental.noalias.scope.decl") || is("stackrestore") ||
        is("donothing") || is("va_start") || is("va_end"))
        return Value();
    if (is("expect") && !arguments.empty()) return arguments[0];
    if (is("stacksave")) return whole({{yes, 0, 0}}, 8);
    if (is("is.constant")) return integer(0, type);
    if (arguments.size() >= 2 && (is("smax") || is("smin") || is("umax") || is("umin"))) {
        const std::string_view predicate = is("smax") ? "sgt" : is("smin") ? "slt" : is("umax") ? "ugt" : "ult";
        std::vector<Case> all;
        for (const Case& x : cases_of(arguments[0], type))
            for (const Case& y : cases_of(arguments[1], type))
                all.push_back({nodes_.both(x.when, y.when), 0,
                               holds(predicate, x.value, y.value, type.bits) ? x.value : y.value});
        return whole(distinct(std::move(all)), type.size);
    }
    for (const char* const op : {"sadd", "uadd", "ssub", "usub", "smul", "umul"}) {
        if (!is(std::string(op) + ".with.overflow") || arguments.size() < 2) continue;
        const Type& whole_type = *types[0];
        Value all;
        put(all, 0, whole_type.size, combine(std::string_view(op).substr(1), whole_type, arguments[0], arguments[1]));
        put(all, whole_type.size, 1, integer(0, *module_.integer_type(8)));  // a counter that wraps is not followed
        return all;
    }
    if (is("is.fpclass") && arguments.size() >= 2) {
        const NodeId x = number_of(arguments[0], *types[0]);
        const std::int64_t classes = cases_of(arguments[1], *types[1])[0].value;
        if (classes == 3) return from_mask(nodes_.is_nan(x));
    }
    return {};
}

std::optional<Value> Walk::called(Frame& frame, State& state, Cursor& at) {
    const int here = nodes_.place;
    skip_flags(at);
    // The type may be preceded by a calling convention and attributes.
    for (;;) {
        Cursor ahead = at;
        const std::string_view word = ahead.word();
        if (word.empty() || word == "void" || word == "float" || word == "double" || word == "ptr" ||
            (word[0] == 'i' && word.size() > 1 && std::isdigit(static_cast<unsigned char>(word[1])) != 0) ||
            word == "half" || word == "x86_fp80")
            break;
        at = ahead;
        if (at.peek() == '(') at.group();
        else if (word == "align") at.integer();
    }
    const Type* type = module_.type(at);
    if (at.take("asm")) fail("inline assembly is not followed");
    std::string name;
    if (at.take("%")) {
        const std::vector<Case> callee = cases_of(state.registers[at.name()], *module_.pointer_type());
        const auto found = functions_.find(callee[0].object);
        if (callee.size() != 1 || found == functions_.end())
            fail("a function that is chosen at run time (a virtual call or a pointer to a function) is not followed");
        name = found->second;
    } else if (at.take("@")) {
        name = at.name();
    } else if (at.take("bitcast")) {
        Cursor inside(at.group());
        while (!inside.at_end() && inside.peek() != '@') inside = Cursor(inside.rest().substr(1));
        inside.expect("@");
        name = inside.name();
    } else {
        fail("a function that is chosen at run time is not followed");
    }
    Cursor given(at.group());
    std::vector<Value> arguments;
    std::vector<const Type*> types;
    while (!given.at_end()) {
        types.push_back(module_.type(given));
        if (types.back()->size == 16 && types.back()->kind == Type::Kind::other && given.peek() == '!') {
            arguments.emplace_back();  // metadata
            given = Cursor("");
            break;
        }
        arguments.push_back(value(state, *types.back(), given));
        if (!given.take(",")) break;
    }
    if (auto known = known_call(state, name, *type, arguments, types)) return known;
    if (const Function* const f = module_.function(name)) {
        auto over = call(*f, std::move(arguments), std::move(state), here);
        nodes_.place = here;
        if (!over) return {};
        state = std::move(over->first);
        return std::move(over->second);
    }
    constexpr std::array ends{"abort",           "exit",        "__assert_fail",     "llvm.trap",
                              "_ZSt9terminatev", "__cxa_throw", "__cxa_pure_virtual"};
    if (std::ranges::find(ends, name) != ends.end() || name.find("panic") != std::string::npos) return {};
    static_cast<void>(frame);
    fail("it calls " + shown(name) +
         ", which is not followed: operations are + - * / sqrt fma fabs copysign fmin fmax and comparisons");
}

// Places and names

int Walk::place_at(int location, int caller) {
    const auto [known, is_new] = known_places_.try_emplace({location, caller}, -1);
    if (!is_new) return known->second;
    const std::string_view text = module_.metadata(location);
    const std::string line = field(text, "line");
    if (text.find("DILocation") == std::string_view::npos || line.empty()) return -1;
    Place made;
    const auto number = [](const std::string& digits) {
        int n = 0;
        std::from_chars(digits.data(), digits.data() + digits.size(), n);
        return n;
    };
    made.line = number(line), made.column = number(field(text, "column"));
    made.caller = caller;
    if (const int inlined = reference(field(text, "inlinedAt")); inlined >= 0 && inlined != location)
        made.caller = place_at(inlined, caller);
    const int scope = reference(field(text, "scope"));
    const std::string_view file = module_.metadata(reference(field(module_.metadata(scope), "file")));
    made.file = field(file, "filename");
    const std::string folder = field(file, "directory");
    if (!made.file.starts_with('/') && !folder.empty()) made.file = folder + "/" + made.file;
    places_.push_back(std::move(made));
    const int index = static_cast<int>(places_.size() - 1);
    known_places_[{location, caller}] = index;
    return index;
}

int Walk::place_of(std::string_view line, int caller) {
    constexpr std::string_view mark = "!dbg !";
    const std::size_t at = line.rfind(mark);
    return at == std::string_view::npos ? -1 : place_at(reference(line.substr(at + 5)), caller);
}

int Walk::own_place(int place) const {
    for (int guard = 0; place >= 0 && guard < 100; ++guard) {
        const Place& p = places_[static_cast<std::size_t>(place)];
        if (p.line > 0 && p.file.starts_with(own_)) return place;
        place = p.caller;
    }
    return -1;
}

/// Names the numbers of a value by the variable that it is stored in, from this offset of the variable on.
void Walk::name_value(State& state, int variable, const Value& value, std::size_t from, int depth) {
    static_cast<void>(state);
    const std::string_view text = module_.metadata(variable);
    if (!field(text, "arg").empty() || field(text, "flags") == "DIFlagArtificial") return;
    const std::string name = field(text, "name");
    if (name.empty() || name.starts_with("lb_")) return;  // of the wrapper
    std::string prefix;
    if (depth > 2) {
        int scope = reference(field(text, "scope"));
        for (int guard = 0; guard < 20 && scope >= 0; ++guard) {
            const std::string_view around = module_.metadata(scope);
            if (around.find("DISubprogram") != std::string_view::npos) {
                prefix = field(around, "name") + ".";
                break;
            }
            scope = reference(field(around, "scope"));
        }
    }
    // The path to each number by the types of the debug information.
    const auto path = [&](std::size_t offset) {
        std::string found;
        int type = reference(field(text, "type"));
        for (int guard = 0; guard < 20 && type >= 0; ++guard) {
            const std::string_view t = module_.metadata(type);
            const auto number = [](const std::string& s) {
                std::size_t n = 0;
                std::from_chars(s.data(), s.data() + s.size(), n);
                return n;
            };
            if (t.find("DIDerivedType") != std::string_view::npos) {
                type = reference(field(t, "baseType"));
            } else if (t.find("DW_TAG_array_type") != std::string_view::npos) {
                type = reference(field(t, "baseType"));
                const std::size_t size = number(field(module_.metadata(type), "size")) / 8;
                if (size == 0) break;
                found += "[" + std::to_string(offset / size) + "]";
                offset %= size;
            } else if (t.find("DICompositeType") != std::string_view::npos) {
                int inside = -1;
                for (const int m : references(module_.metadata(reference(field(t, "elements"))))) {
                    const std::string_view member = module_.metadata(m);
                    const std::string tag = field(member, "tag");
                    if (tag != "DW_TAG_member" && tag != "DW_TAG_inheritance") continue;
                    const std::size_t begin = number(field(member, "offset")) / 8;
                    const std::size_t size = number(field(member, "size")) / 8;
                    if (offset < begin || offset >= begin + size) continue;
                    if (const std::string n = field(member, "name"); !n.empty()) found += "." + n;
                    inside = reference(field(member, "baseType"));
                    offset -= begin;
                    break;
                }
                if (inside < 0) break;
                type = inside;
            } else {
                break;
            }
        }
        return found;
    };
    for (const auto& [at, cell] : value)
        if (cell.scalar.kind == Scalar::Kind::number)
            nodes_.name(cell.scalar.node, prefix + name + path(from + at), depth);
}

/// `llvm.dbg.declare`, `llvm.dbg.value`, and the records that stand in their place since LLVM 19.
void Walk::declare(State& state, std::string_view line, Cursor at, bool is_record) {
    const bool is_memory =
        line.find("dbg_declare") != std::string_view::npos || line.find("@llvm.dbg.declare") != std::string_view::npos;
    const bool is_value =
        line.find("dbg_value") != std::string_view::npos || line.find("@llvm.dbg.value") != std::string_view::npos;
    if (!is_memory && !is_value) return;
    while (!at.at_end() && at.peek() != '(') at = Cursor(at.rest().substr(1));
    Cursor inside(at.group());
    inside.take("metadata");
    if (inside.peek() == '!' || inside.take("poison") || inside.take("undef")) return;
    const Type* const type = module_.type(inside);
    if (!inside.take("%")) return;
    const std::string name = inside.name();
    const auto found = state.registers.find(name);
    if (found == state.registers.end()) return;
    const std::size_t reference_at = inside.rest().find('!');
    if (reference_at == std::string_view::npos) return;
    const int variable = reference(inside.rest().substr(reference_at));
    int depth = depth_;
    if (is_record) {
        int location = reference(line.substr(std::min(line.rfind('!'), line.size())));
        for (int guard = 0; location >= 0 && guard < 50; ++guard) {
            location = reference(field(module_.metadata(location), "inlinedAt"));
            if (location >= 0) ++depth;
        }
    }
    if (is_memory) {
        if (line.find("DIExpression()") == std::string_view::npos) return;
        for (const Case& c : cases_of(found->second, *type)) variables_[c.object] = {variable, depth};
        return;
    }
    std::size_t from = 0;
    if (line.find("DIExpression()") == std::string_view::npos) {
        constexpr std::string_view fragment = "DIExpression(DW_OP_LLVM_fragment, ";
        const std::size_t begin = line.find(fragment);
        if (begin == std::string_view::npos) return;
        const std::string_view digits = line.substr(begin + fragment.size());
        std::from_chars(digits.data(), digits.data() + digits.size(), from);
        from /= 8;
    }
    name_value(state, variable, found->second, from, depth);
}

}  // namespace lostbits::intersect::function
