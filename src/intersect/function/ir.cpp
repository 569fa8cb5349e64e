#include "intersect/function/ir.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

bool is_word_character(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-' || c == '$';
}

std::size_t round_up(std::size_t size, std::size_t align) { return (size + align - 1) / align * align; }

/// True for words that begin a value and must not be read as attributes of one.
bool is_value_word(std::string_view word) {
    constexpr std::array value_words{// Values
                                     "true", "false", "null", "undef", "poison", "zeroinitializer", "none", "splat",
                                     "c", "nan", "metadata", "asm", "dso_local_equivalent",
                                     // Operations on constants
                                     "getelementptr", "bitcast", "inttoptr", "ptrtoint", "addrspacecast", "add", "sub",
                                     "select", "icmp", "trunc", "zext", "sext"};
    return word.empty() || std::isdigit(static_cast<unsigned char>(word[0])) != 0 || word[0] == '-' ||
           std::ranges::find(value_words, word) != value_words.end();
}

constexpr std::size_t max_bytes = 1 << 20, max_lanes = 1024;  // limits of a type

/// Calls `action(begin, end)` with the offsets of each line. The action may move the end to that of a later line.
template <class Action>
void for_each_line(std::string_view text, const Action& action) {
    for (std::size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
        end = std::min(text.find('\n', begin), text.size());
        action(begin, end);
    }
}

/// True if the instruction `line`, which ends at `end`, continues on the next line: while the list of a switch is open,
/// and before the words tested here.
bool continues_on_next_line(std::string_view text, std::string_view line, std::size_t end) {
    if (line.find("switch ") != std::string_view::npos && line.find('[') != std::string_view::npos &&
        line.find("\n  ]") == std::string_view::npos && !line.ends_with(']') &&
        line.find("], !") == std::string_view::npos)
        return true;
    if (end + 1 >= text.size()) return false;
    Cursor next(text.substr(end + 1, std::min(text.find('\n', end + 1), text.size()) - end - 1));
    return next.take("to label") || next.take("catch ") || next.take("filter ") || next.take("cleanup") ||
           next.take("unwind label");
}

/// Reads `NAME:`, which begins a block.
void begin_block(IrFunction& function, Cursor& cursor) {
    const std::string name = cursor.take_name();
    if (!cursor.take(":")) cursor.fail("a block lacks a name");
    if (function.blocks.size() == 1 && function.blocks[0].lines.empty()) function.blocks[0].name = name;
    else function.blocks.push_back({name, {}});
}

}  // namespace

const Type* Type::part(std::size_t k, std::size_t& offset) const {
    if (kind == Kind::structure && k < parts.size()) {
        offset = offsets[k];
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
    if (is_word_character(text.back()) && rest_.size() > text.size() && is_word_character(rest_[text.size()]))
        return false;
    rest_.remove_prefix(text.size());
    return true;
}

void Cursor::expect(std::string_view text) {
    if (!take(text)) fail("\"" + std::string(text) + "\" is missing");
}

std::string_view Cursor::take_word() {
    skip_blanks();
    std::size_t n = 0;
    while (n < rest_.size() && is_word_character(rest_[n])) ++n;
    const std::string_view text = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return text;
}

std::string Cursor::take_name() {
    if (!rest_.starts_with('"')) return std::string(take_word());
    const std::size_t end = rest_.find('"', 1);
    if (end == std::string_view::npos) fail("a name has no end");
    const std::string_view text = rest_.substr(1, end - 1);
    rest_.remove_prefix(end + 1);
    return std::string(text);
}

std::int64_t Cursor::take_integer() {
    const std::string_view digits = take_word();
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size()) fail("a number is missing");
    return value;
}

std::string_view Cursor::take_group() {
    skip_blanks();
    int depth = 0;
    bool is_quoted = false;
    for (std::size_t i = 0; i < rest_.size(); ++i) {
        const char c = rest_[i];
        if (c == '"') is_quoted = !is_quoted;
        if (is_quoted) continue;

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

void Cursor::fail(const std::string& problem) const {
    const std::size_t position = line_.size() - rest_.size();
    throw InputError("the LLVM IR cannot be read: " + problem + " at character " + std::to_string(position + 1) +
                     " of \"" + std::string(line_.substr(0, 120)) + "\"");
}

const Type* Module::integer_type(int bits) {
    for (const Type& type : types_)
        if (type.kind == Type::Kind::integer && type.bits == bits) return &type;
    std::size_t size = 1;
    while (size * 8 < static_cast<std::size_t>(bits)) size *= 2;
    return add_type({.kind = Type::Kind::integer, .size = size, .align = std::min<std::size_t>(size, 8), .bits = bits});
}

const Type* Module::number_type(int bits) {
    for (const Type& type : types_)
        if (type.kind == Type::Kind::number && type.bits == bits) return &type;
    const auto size = static_cast<std::size_t>(bits) / 8;
    return add_type({.kind = Type::Kind::number, .size = size, .align = size, .bits = bits});
}

const Type* Module::make_structure(std::vector<const Type*> parts, Packing packing) {
    Type structure_type{.kind = Type::Kind::structure};
    for (const Type* part : parts) {
        const std::size_t align = packing == Packing::packed ? 1 : part->align;
        structure_type.offsets.push_back(round_up(structure_type.size, align));
        structure_type.size = structure_type.offsets.back() + part->size;
        structure_type.align = std::max(structure_type.align, align);
    }
    structure_type.size = round_up(structure_type.size, structure_type.align);
    structure_type.parts = std::move(parts);
    return add_type(std::move(structure_type));
}

const Type* Module::read_structure(Cursor& cursor, char close, Packing packing) {
    std::vector<const Type*> parts;
    const std::string end(1, close);
    while (!cursor.take(end)) {
        parts.push_back(read_type(cursor));
        if (parts.back()->size > max_bytes || parts.size() > max_bytes) cursor.fail("a type is too large");
        if (!cursor.take(",") && cursor.peek() != close) cursor.fail("a type has no end");
    }
    return make_structure(std::move(parts), packing);
}

const Type* Module::find_named_type(const std::string& name) {
    if (const auto known_type = named_.find(name); known_type != named_.end()) return known_type->second;
    const auto definition = definitions_.find(name);
    if (definition == definitions_.end()) return named_[name] = add_type({});
    named_[name] = nullptr;  // while its definition is read; a pointer to the type itself does not need its size
    Cursor cursor(definition->second);
    const Type* const definition_type = read_type(cursor);
    return named_[name] = definition_type;
}

const Type* Module::read_simple_type(Cursor& cursor) {
    // Types that begin with a sign.
    const char c = cursor.peek();
    if (c == '%') {
        cursor.expect("%");
        const Type* const named_type = find_named_type(cursor.take_name());
        return named_type == nullptr ? add_type({}) : named_type;
    }
    if (cursor.take("{")) return read_structure(cursor, '}', Packing::aligned);
    if (cursor.take("[")) return read_array(cursor);
    if (cursor.take("<")) return read_vector_or_packed_structure(cursor);

    // Types with a name that is a word.
    const std::string_view word = cursor.take_word();
    if (word == "float") return number_type(32);
    if (word == "double") return number_type(64);
    if (word == "ptr") {
        if (cursor.take("addrspace")) cursor.take_group();
        return pointer_;
    }
    if (word == "void") return add_type({.kind = Type::Kind::nothing});
    if (word.size() > 1 && word[0] == 'i' && std::isdigit(static_cast<unsigned char>(word[1])) != 0) {
        int bits = 0;
        const auto [end, error] = std::from_chars(word.data() + 1, word.data() + word.size(), bits);
        if (error != std::errc() || end != word.data() + word.size() || bits < 1 || bits > 4096)
            cursor.fail("a type is unknown");
        return integer_type(bits);
    }

    // Values of other known types are not followed.
    constexpr std::array unsupported_types{"half",  "bfloat", "fp128",    "x86_fp80", "ppc_fp128", "label",
                                           "token", "opaque", "metadata", "x86_mmx",  "x86_amx"};
    if (std::ranges::find(unsupported_types, word) == unsupported_types.end()) cursor.fail("a type is unknown");
    return add_type({.size = word == "half" || word == "bfloat" ? 2UL : 16UL, .align = 2});
}

/// Reads `3 x float]`.
const Type* Module::read_array(Cursor& cursor) {
    const std::int64_t count = cursor.take_integer();
    cursor.expect("x");
    const Type* const part = read_type(cursor);
    cursor.expect("]");
    const std::size_t max_count = max_bytes / std::max<std::size_t>(part->size, 1);
    if (count < 0 || static_cast<std::size_t>(count) > max_count) cursor.fail("a type is too large");

    Type array_type{.kind = Type::Kind::sequence, .count = static_cast<std::size_t>(count)};
    array_type.parts = {part};
    array_type.size = part->size * array_type.count;
    array_type.align = part->align;
    return add_type(std::move(array_type));
}

/// Reads `4 x float>` or `{ i8, float }>`.
const Type* Module::read_vector_or_packed_structure(Cursor& cursor) {
    if (cursor.take("{")) {
        const Type* const packed = read_structure(cursor, '}', Packing::packed);
        cursor.expect(">");
        return packed;
    }
    if (cursor.take("vscale")) cursor.fail("a vector without a fixed length is not followed");
    const std::int64_t count = cursor.take_integer();
    cursor.expect("x");
    const Type* const part = read_type(cursor);
    cursor.expect(">");
    if (count < 0 || static_cast<std::size_t>(count) > max_lanes) cursor.fail("a type is too large");

    // Size and alignment are the next power of two.
    Type vector_type{.kind = Type::Kind::sequence, .is_vector = true, .count = static_cast<std::size_t>(count)};
    vector_type.parts = {part};
    const std::size_t size = part->size * vector_type.count;
    for (vector_type.align = 1; vector_type.align < size;) vector_type.align *= 2;
    vector_type.size = vector_type.align;
    return add_type(std::move(vector_type));
}

const Type* Module::read_type(Cursor& cursor) {
    if (depth_ > 60) cursor.fail("types are nested too deeply");
    ++depth_;
    const Type* result = read_simple_type(cursor);

    // A star makes a pointer, and parameters make the type of a function.
    for (;;) {
        if (cursor.take("*")) {
            result = pointer_;
        } else if (cursor.take("addrspace")) {
            cursor.take_group();
        } else if (cursor.peek() == '(' && result->kind != Type::Kind::structure) {
            cursor.take_group();
            result = add_type({});
        } else {
            break;
        }
    }
    --depth_;
    return result;
}

const Type* Module::skip_attributes(Cursor& cursor) {
    const Type* by_value = nullptr;
    for (;;) {
        // An attribute is a word, but a value may also begin with a word.
        Cursor ahead = cursor;
        if (std::isalpha(static_cast<unsigned char>(ahead.peek())) == 0) return by_value;
        const std::string_view word = ahead.take_word();
        if (is_value_word(word)) return by_value;

        cursor = ahead;
        if (word == "align" && cursor.peek() != '(') cursor.take_integer();
        else if (cursor.peek() == '(') {
            const std::string_view inside = cursor.take_group();
            if (word == "byval") {
                Cursor byval_cursor(inside);
                by_value = read_type(byval_cursor);
            }
        }
    }
}

const IrFunction* Module::find_function(const std::string& name) const {
    const auto entry = functions.find(name);
    return entry == functions.end() ? nullptr : &entry->second;
}

std::string_view Module::metadata(int index) const {
    const auto entry = metadata_.find(index);
    return entry == metadata_.end() ? std::string_view() : entry->second;
}

int Module::line_of(std::string_view part) {
    if (line_ends_.empty())
        for (std::size_t k = 0; k < text_.size(); ++k)
            if (text_[k] == '\n') line_ends_.push_back(text_.data() + k);
    return static_cast<int>(std::ranges::lower_bound(line_ends_, part.data()) - line_ends_.begin()) + 1;
}

/// Reads `@name = private constant [3 x float] [...], align 4`.
void Module::read_global(Cursor& cursor) {
    cursor.expect("@");
    const std::string name = cursor.take_name();
    if (!cursor.take("=")) return;
    for (;;) {
        Cursor ahead = cursor;
        const std::string_view word = ahead.take_word();
        if (word.empty() || word == "alias" || word == "ifunc") return;
        cursor = ahead;
        if (word == "global" || word == "constant") {
            const Type* const type = read_type(cursor);
            cursor.skip_blanks();
            globals[name] = {type, cursor.peek() == ',' ? std::string_view() : cursor.rest(), word == "constant"};
            return;
        }
        if (cursor.peek() == '(') cursor.take_group();
    }
}

/// Reads `define ATTRIBUTES TYPE @name(PARAMETERS) ATTRIBUTES !dbg !4 {`.
IrFunction* Module::read_header(Cursor& cursor) {
    // Reads up to the name. The last text that begins with a type or a word is the returned type.
    IrFunction function_header;
    std::string_view returned_text;
    for (;;) {
        Cursor ahead = cursor;
        if (ahead.at_end()) cursor.fail("a function lacks a name");
        const char next = ahead.peek();
        if (next == '@') break;
        const std::string_view rest_of_line = ahead.rest();
        if (next != '(' && next != '*') returned_text = rest_of_line;
        if (ahead.take("%")) ahead.take_name();
        else if (next == '(' || next == '{' || next == '<' || next == '[') ahead.take_group();
        else if (const std::string_view word = ahead.take_word(); word.empty()) ahead.take(rest_of_line.substr(0, 1));
        else if (word.ends_with("cc")) function_header.convention = word;
        cursor = ahead;
    }
    function_header.returned_text = returned_text.substr(0, returned_text.size() - cursor.rest().size());
    cursor.expect("@");
    function_header.name = cursor.take_name();

    Cursor inside(cursor.take_group());
    const int unnamed = read_parameters(function_header, inside);
    const std::string_view rest = cursor.rest();
    if (const std::size_t dbg = rest.find("!dbg !"); dbg != std::string_view::npos)
        function_header.subprogram = metadata_index(rest.substr(dbg + 5));
    // The first block has the next free number if it has no name.
    function_header.blocks.push_back({std::to_string(unnamed), {}});
    return &(functions[function_header.name] = std::move(function_header));
}

/// Reads the parameters of a function, and returns the number of those without a name.
int Module::read_parameters(IrFunction& function, Cursor& inside) {
    int unnamed = 0;
    while (!inside.at_end()) {
        if (inside.take("...")) break;
        inside.skip_blanks();
        const std::string_view all_parameters = inside.rest();
        const auto text_up_to_cursor = [&] {
            return all_parameters.substr(0, all_parameters.size() - inside.rest().size());
        };
        IrParameter p{.name = {}, .type = read_type(inside)};
        p.type_text = text_up_to_cursor();
        p.by_value = skip_attributes(inside);
        p.text = text_up_to_cursor();

        if (inside.take("%")) p.name = inside.take_name();
        else p.name = std::to_string(unnamed);
        if (!p.name.empty() && std::ranges::all_of(p.name, [](char c) { return c >= '0' && c <= '9'; })) ++unnamed;
        function.parameters.push_back(std::move(p));
        if (!inside.take(",")) break;
    }
    return unnamed;
}

Module::Module(std::string text) : text_(std::move(text)) {
    pointer_ = add_type({.kind = Type::Kind::pointer, .size = 8, .align = 8, .bits = 64});
    const std::string_view whole_text = text_;
    if (whole_text.find('\0') != std::string_view::npos)
        throw InputError("the LLVM IR is not a text; write .bc after the name of a file of bitcode");

    // Named types come first, since functions may use types that are defined below them.
    for_each_line(whole_text, [&](std::size_t begin, std::size_t& end) {
        const std::string_view line = whole_text.substr(begin, end - begin);
        if (!line.starts_with('%')) return;
        Cursor cursor(line);
        cursor.expect("%");
        const std::string name = cursor.take_name();
        if (cursor.take("=") && cursor.take("type")) definitions_[name] = cursor.rest();
    });

    IrFunction* function_body = nullptr;
    for_each_line(whole_text, [&](std::size_t begin, std::size_t& end) {
        std::string_view line = whole_text.substr(begin, end - begin);
        Cursor cursor(line);
        if (function_body == nullptr) {
            function_body = read_outer_line(line);
            return;
        }
        if (line.starts_with('}')) {
            function_body = nullptr;
            return;
        }
        if (cursor.at_end() || cursor.peek() == ';') return;
        if (line[0] != ' ' && line[0] != '\t') return begin_block(*function_body, cursor);

        while (end < whole_text.size() && continues_on_next_line(whole_text, line, end)) {
            end = std::min(whole_text.find('\n', end + 1), whole_text.size());
            line = whole_text.substr(begin, end - begin);
        }
        function_body->blocks.back().lines.push_back(line);
    });
    if (function_body != nullptr) throw InputError("the LLVM IR cannot be read: it ends inside " + function_body->name);
}

/// Reads a line outside of functions. Returns the function that it begins; null if it begins none.
IrFunction* Module::read_outer_line(std::string_view line) {
    Cursor cursor(line);
    if (line.starts_with("define ")) {
        cursor.expect("define");
        return read_header(cursor);
    }
    if (line.starts_with('@')) read_global(cursor);
    if (line.starts_with('!')) read_metadata(cursor);
    return nullptr;
}

/// Reads `!12 = TEXT`. Metadata with a name instead of a number is not used.
void Module::read_metadata(Cursor& cursor) {
    cursor.expect("!");
    const std::string_view digits = cursor.take_word();
    int n = -1;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), n);
    if (error == std::errc() && end == digits.data() + digits.size() && cursor.take("=")) metadata_[n] = cursor.rest();
}

}  // namespace lostbits::intersect::function
