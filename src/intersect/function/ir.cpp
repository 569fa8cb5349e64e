#include "intersect/function/ir.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

bool is_of_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-' || c == '$';
}

std::size_t rounded_up(std::size_t size, std::size_t align) { return (size + align - 1) / align * align; }

/// True for words that are values, so that they are not read as attributes of one.
bool is_value_word(std::string_view word) {
    constexpr std::array words{"true",
                               "false",
                               "null",
                               "undef",
                               "poison",
                               "zeroinitializer",
                               "none",
                               "getelementptr",
                               "bitcast",
                               "inttoptr",
                               "ptrtoint",
                               "addrspacecast",
                               "splat",
                               "c",
                               "metadata",
                               "asm",
                               "add",
                               "sub",
                               "select",
                               "icmp",
                               "trunc",
                               "zext",
                               "sext",
                               "nan",
                               "dso_local_equivalent"};
    return word.empty() || std::isdigit(static_cast<unsigned char>(word[0])) != 0 || word[0] == '-' ||
           std::ranges::find(words, word) != words.end();
}

constexpr std::size_t most_bytes = 1 << 20, most_lanes = 1024;  // of a type; larger ones are refused

}  // namespace

const Type* Type::part(std::size_t k, std::size_t& offset) const {
    if (kind == Kind::structure && k < parts.size()) {
        offset = at[k];
        return parts[k];
    }
    if (kind == Kind::sequence && k < count) {
        offset = k * parts[0]->size;
        return parts[0];
    }
    return nullptr;
}

void Cursor::skip_blanks() {
    while (!rest_.empty() && (std::isspace(static_cast<unsigned char>(rest_.front())) != 0)) rest_.remove_prefix(1);
}

bool Cursor::take(std::string_view text) {
    skip_blanks();
    if (!rest_.starts_with(text)) return false;
    if (is_of_word(text.back()) && rest_.size() > text.size() && is_of_word(rest_[text.size()])) return false;
    rest_.remove_prefix(text.size());
    return true;
}

void Cursor::expect(std::string_view text) {
    if (!take(text)) fail("\"" + std::string(text) + "\" is missing");
}

std::string_view Cursor::word() {
    skip_blanks();
    std::size_t n = 0;
    while (n < rest_.size() && is_of_word(rest_[n])) ++n;
    const std::string_view found = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return found;
}

std::string Cursor::name() {
    if (!rest_.starts_with('"')) return std::string(word());
    const std::size_t end = rest_.find('"', 1);
    if (end == std::string_view::npos) fail("a name has no end");
    const std::string_view found = rest_.substr(1, end - 1);
    rest_.remove_prefix(end + 1);
    return std::string(found);
}

std::int64_t Cursor::integer() {
    const std::string_view digits = word();
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size()) fail("a number is missing");
    return value;
}

std::string_view Cursor::group() {
    skip_blanks();
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < rest_.size(); ++i) {
        const char c = rest_[i];
        if (c == '"') quoted = !quoted;
        if (quoted) continue;
        if (c == '(' || c == '[' || c == '{' || c == '<') ++depth;
        if (c == ')' || c == ']' || c == '}' || c == '>') --depth;
        if (depth == 0) {
            const std::string_view inside = rest_.substr(1, i > 0 ? i - 1 : 0);
            rest_.remove_prefix(i + 1);
            return inside;
        }
    }
    fail("a bracket has no end");
}

void Cursor::fail(const std::string& what) const {
    const std::size_t at = line_.size() - rest_.size();
    throw InputError("the LLVM IR cannot be read: " + what + " at character " + std::to_string(at + 1) + " of \"" +
                     std::string(line_.substr(0, 120)) + "\"");
}

const Type* Module::integer_type(int bits) {
    for (const Type& t : types_)
        if (t.kind == Type::Kind::integer && t.bits == bits) return &t;
    std::size_t size = 1;
    while (size * 8 < static_cast<std::size_t>(bits)) size *= 2;
    return add({.kind = Type::Kind::integer, .size = size, .align = std::min<std::size_t>(size, 8), .bits = bits});
}

const Type* Module::structure(std::vector<const Type*> parts, bool packed) {
    Type made{.kind = Type::Kind::structure};
    for (const Type* part : parts) {
        const std::size_t align = packed ? 1 : part->align;
        made.at.push_back(rounded_up(made.size, align));
        made.size = made.at.back() + part->size;
        made.align = std::max(made.align, align);
    }
    made.size = rounded_up(made.size, made.align);
    made.parts = std::move(parts);
    return add(std::move(made));
}

const Type* Module::structure_of(Cursor& at, char close, bool packed) {
    std::vector<const Type*> parts;
    const std::string end(1, close);
    while (!at.take(end)) {
        parts.push_back(type(at));
        if (parts.back()->size > most_bytes || parts.size() > most_bytes) at.fail("a type is too large");
        if (!at.take(",") && at.peek() != close) at.fail("a type has no end");
    }
    return structure(std::move(parts), packed);
}

const Type* Module::named(const std::string& name) {
    if (const auto known = named_.find(name); known != named_.end()) return known->second;
    const auto text = definitions_.find(name);
    if (text == definitions_.end()) return named_[name] = add({});
    named_[name] = nullptr;  // while it is read; a pointer to itself needs no size
    Cursor at(text->second);
    const Type* const found = type(at);
    return named_[name] = found;
}

const Type* Module::simple_type(Cursor& at) {
    const char c = at.peek();
    if (c == '%') {
        at.expect("%");
        const std::string name = at.name();
        const Type* const found = named(name);
        if (found == nullptr) return add({});
        return found;
    }
    if (at.take("{")) return structure_of(at, '}', false);
    if (c == '[' || c == '<') {
        at.expect(std::string_view(&c, 1));
        if (c == '<' && at.take("{")) {
            const Type* const packed = structure_of(at, '}', true);
            at.expect(">");
            return packed;
        }
        if (at.take("vscale")) at.fail("a vector without a fixed length is not followed");
        const std::int64_t count = at.integer();
        at.expect("x");
        const Type* const part = type(at);
        at.expect(c == '[' ? "]" : ">");
        const std::size_t most = c == '<' ? most_lanes : most_bytes / std::max<std::size_t>(part->size, 1);
        if (count < 0 || static_cast<std::size_t>(count) > most) at.fail("a type is too large");
        Type made{.kind = Type::Kind::sequence, .is_vector = c == '<', .count = static_cast<std::size_t>(count)};
        made.parts = {part};
        made.size = part->size * made.count;
        made.align = part->align;
        if (made.is_vector) {
            for (made.align = 1; made.align < made.size;) made.align *= 2;
            made.size = made.align;
        }
        return add(std::move(made));
    }
    const std::string_view word = at.word();
    if (word == "float" || word == "double") {
        const int bits = word == "float" ? 32 : 64;
        const auto size = static_cast<std::size_t>(bits) / 8;
        for (const Type& t : types_)
            if (t.kind == Type::Kind::number && t.bits == bits) return &t;
        return add({.kind = Type::Kind::number, .size = size, .align = size, .bits = bits});
    }
    if (word == "ptr") {
        if (at.take("addrspace")) at.group();
        return pointer_;
    }
    if (word == "void") return add({.kind = Type::Kind::nothing});
    if (word.size() > 1 && word[0] == 'i' && std::isdigit(static_cast<unsigned char>(word[1])) != 0) {
        int bits = 0;
        const auto [end, error] = std::from_chars(word.data() + 1, word.data() + word.size(), bits);
        if (error != std::errc() || end != word.data() + word.size() || bits < 1 || bits > 4096)
            at.fail("a type is unknown");
        return integer_type(bits);
    }
    constexpr std::array others{"half",  "bfloat", "fp128",    "x86_fp80", "ppc_fp128", "label",
                                "token", "opaque", "metadata", "x86_mmx",  "x86_amx"};
    if (std::ranges::find(others, word) == others.end()) at.fail("a type is unknown");
    return add({.size = word == "half" || word == "bfloat" ? 2UL : 16UL, .align = 2});
}

const Type* Module::type(Cursor& at) {
    if (depth_ > 60) at.fail("types are nested too deeply");
    ++depth_;
    const Type* found = simple_type(at);
    for (;;) {
        if (at.take("*")) found = pointer_;
        else if (at.take("addrspace")) at.group();
        else if (at.peek() == '(' && found->kind != Type::Kind::structure) at.group(), found = add({});
        else break;
    }
    --depth_;
    return found;
}

const Type* Module::skip_attributes(Cursor& at) {
    const Type* by_value = nullptr;
    for (;;) {
        Cursor ahead = at;
        if (std::isalpha(static_cast<unsigned char>(ahead.peek())) == 0) return by_value;
        const std::string_view word = ahead.word();
        if (is_value_word(word)) return by_value;
        at = ahead;
        if (word == "align" && at.peek() != '(') at.integer();
        else if (at.peek() == '(') {
            const std::string_view inside = at.group();
            if (word == "byval") {
                Cursor of(inside);
                by_value = type(of);
            }
        }
    }
}

const IrFunction* Module::function(const std::string& name) const {
    const auto found = functions.find(name);
    return found == functions.end() ? nullptr : &found->second;
}

std::string_view Module::metadata(int number) const {
    const auto found = metadata_.find(number);
    return found == metadata_.end() ? std::string_view() : found->second;
}

int Module::line_of(std::string_view part) {
    if (line_ends_.empty())
        for (std::size_t k = 0; k < text_.size(); ++k)
            if (text_[k] == '\n') line_ends_.push_back(text_.data() + k);
    return static_cast<int>(std::ranges::lower_bound(line_ends_, part.data()) - line_ends_.begin()) + 1;
}

/// `@name = private constant [3 x float] [...], align 4`
void Module::read_global(Cursor& at) {
    at.expect("@");
    const std::string name = at.name();
    if (!at.take("=")) return;
    for (;;) {
        Cursor ahead = at;
        const std::string_view word = ahead.word();
        if (word.empty() || word == "alias" || word == "ifunc") return;
        at = ahead;
        if (word == "global" || word == "constant") {
            const Type* const type = this->type(at);
            at.skip_blanks();
            globals[name] = {type, at.peek() == ',' ? std::string_view() : at.rest(), word == "constant"};
            return;
        }
        if (at.peek() == '(') at.group();
    }
}

/// `define ATTRIBUTES TYPE @name(PARAMETERS) ATTRIBUTES !dbg !4 {`
IrFunction* Module::read_header(Cursor& at) {
    IrFunction made;
    std::string_view returned;
    for (;;) {
        Cursor ahead = at;
        if (ahead.at_end()) at.fail("a function has no name");
        const char next = ahead.peek();
        if (next == '@') break;
        const std::string_view here = ahead.rest();
        if (next != '(' && next != '*') returned = here;  // the last of these is the returned type
        if (ahead.take("%")) ahead.name();
        else if (next == '(' || next == '{' || next == '<' || next == '[') ahead.group();
        else if (const std::string_view word = ahead.word(); word.empty()) ahead.take(here.substr(0, 1));
        else if (word.ends_with("cc")) made.convention = word;
        at = ahead;
    }
    made.returned_text = returned.substr(0, returned.size() - at.rest().size());
    at.expect("@");
    made.name = at.name();
    Cursor inside(at.group());
    int unnamed = 0;
    while (!inside.at_end()) {
        if (inside.take("...")) break;
        inside.skip_blanks();
        const std::string_view all = inside.rest();
        IrParameter p{.name = {}, .type = type(inside)};
        p.type_text = all.substr(0, all.size() - inside.rest().size());
        p.by_value = skip_attributes(inside);
        p.text = all.substr(0, all.size() - inside.rest().size());
        if (inside.take("%")) p.name = inside.name();
        else p.name = std::to_string(unnamed);
        if (!p.name.empty() && std::ranges::all_of(p.name, [](char c) { return c >= '0' && c <= '9'; })) ++unnamed;
        made.parameters.push_back(std::move(p));
        if (!inside.take(",")) break;
    }
    const std::string_view rest = at.rest();
    if (const std::size_t dbg = rest.find("!dbg !"); dbg != std::string_view::npos)
        made.subprogram = reference(rest.substr(dbg + 5));
    // The first block has the next free number if it has no name.
    made.blocks.push_back({std::to_string(unnamed), {}});
    return &(functions[made.name] = std::move(made));
}

Module::Module(std::string text) : text_(std::move(text)) {
    pointer_ = add({.kind = Type::Kind::pointer, .size = 8, .align = 8, .bits = 64});
    const std::string_view all = text_;
    if (all.find('\0') != std::string_view::npos)
        throw InputError("the LLVM IR is not a text; write .bc after the name of a file of bitcode");
    IrFunction* inside = nullptr;
    std::vector<std::string_view> headers;
    // Named types come first: functions may use those that stand below.
    const auto each_line = [&](const auto& act) {
        for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end + 1) {
            end = std::min(all.find('\n', begin), all.size());
            act(begin, end);
        }
    };
    each_line([&](std::size_t begin, std::size_t& end) {
        const std::string_view line = all.substr(begin, end - begin);
        if (!line.starts_with('%')) return;
        Cursor at(line);
        at.expect("%");
        const std::string name = at.name();
        if (at.take("=") && at.take("type")) definitions_[name] = at.rest();
    });
    each_line([&](std::size_t begin, std::size_t& end) {
        std::string_view line = all.substr(begin, end - begin);
        Cursor at(line);
        if (inside == nullptr) {
            if (line.starts_with("define ")) {
                at.expect("define");
                inside = read_header(at);
            } else if (line.starts_with('@')) {
                read_global(at);
            } else if (line.starts_with('!')) {
                at.expect("!");
                Cursor number = at;
                const std::string_view digits = number.word();
                int n = -1;
                const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), n);
                if (error == std::errc() && stop == digits.data() + digits.size() && number.take("="))
                    metadata_[n] = number.rest();
            }
            return;
        }
        if (line.starts_with('}')) {
            inside = nullptr;
            return;
        }
        if (at.at_end() || at.peek() == ';') return;
        if (line[0] != ' ' && line[0] != '\t') {  // NAME:
            const std::string name = at.name();
            if (!at.take(":")) at.fail("a block has no name");
            if (inside->blocks.size() == 1 && inside->blocks[0].lines.empty()) inside->blocks[0].name = name;
            else inside->blocks.push_back({name, {}});
            return;
        }
        // An instruction goes on in the next lines while a list is open, and before these words.
        const auto goes_on = [&] {
            if (line.find("switch ") != std::string_view::npos && line.find('[') != std::string_view::npos &&
                line.find("\n  ]") == std::string_view::npos && !line.ends_with(']') &&
                line.find("], !") == std::string_view::npos)
                return true;
            if (end + 1 >= all.size()) return false;
            Cursor next(all.substr(end + 1, std::min(all.find('\n', end + 1), all.size()) - end - 1));
            return next.take("to label") || next.take("catch ") || next.take("filter ") || next.take("cleanup") ||
                   next.take("unwind label");
        };
        while (end < all.size() && goes_on()) {
            end = std::min(all.find('\n', end + 1), all.size());
            line = all.substr(begin, end - begin);
        }
        inside->blocks.back().lines.push_back(line);
    });
    if (inside != nullptr) throw InputError("the LLVM IR cannot be read: it ends inside " + inside->name);
}

std::string field(std::string_view metadata, std::string_view name) {
    const std::string key = std::string(name) + ": ";
    for (std::size_t at = metadata.find(key); at != std::string_view::npos; at = metadata.find(key, at + 1)) {
        if (at == 0 || (metadata[at - 1] != ' ' && metadata[at - 1] != '(')) continue;
        std::string_view value = metadata.substr(at + key.size());
        if (value.starts_with('"')) {
            const std::size_t end = value.find('"', 1);
            return std::string(value.substr(1, end == std::string_view::npos ? end : end - 1));
        }
        return std::string(value.substr(0, value.find_first_of(",)")));
    }
    return {};
}

int reference(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    if (!text.starts_with('!')) return -1;
    int n = -1;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), n);
    return error == std::errc() ? n : -1;
}

std::vector<int> references(std::string_view metadata) {
    std::vector<int> found;
    const std::size_t open = metadata.find('{');
    if (open == std::string_view::npos) return found;
    std::string_view rest = metadata.substr(open + 1);
    while (!rest.empty() && rest.front() != '}') {
        found.push_back(reference(rest));
        const std::size_t comma = rest.find(',');
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    if (found.size() == 1 && found[0] == -1 && metadata.find("null") == std::string_view::npos) found.clear();
    return found;
}

}  // namespace lostbits::intersect::function
