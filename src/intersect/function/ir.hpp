// LLVM IR as text: the lines of each function, its types, and its debug information. The text differs little between
// versions of LLVM (typed and opaque pointers), while bitcode of a newer version cannot be read by an older library.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lostbits::intersect::function {

struct Type {
    enum class Kind { nothing, integer, number, pointer, sequence, structure, other };
    Kind kind = Kind::other;
    std::size_t size = 0, align = 1;      ///< in bytes
    int bits = 0;                         ///< bits of an integer or a number
    bool is_vector = false;               ///< true for a sequence such as <4 x float>
    std::vector<const Type*> parts = {};  ///< parts of a structure; the item of a sequence
    std::vector<std::size_t> at = {};     ///< offset of each part of a structure
    std::size_t count = 0;                ///< number of items of a sequence

    /// Part k of a structure or of a sequence, and its offset; null behind the last one.
    [[nodiscard]] const Type* part(std::size_t k, std::size_t& offset) const;
};

/// A place of the source, and the call that led there.
struct SourcePlace {
    std::string file;
    int line = 0, column = 0;
    int caller = -1;  ///< index of the place of the call; -1 in the function itself
};

struct Block {
    std::string name;
    std::vector<std::string_view> lines;  ///< one instruction each
};

struct IrParameter {
    std::string name;
    const Type* type;
    const Type* by_value = nullptr;              ///< the structure that the caller passes by a pointer to a copy
    std::string_view type_text = {}, text = {};  ///< the type as written; the same with its attributes
};

struct IrFunction {
    std::string name;
    std::vector<IrParameter> parameters;
    std::vector<Block> blocks;
    int subprogram = -1;                                   ///< its debug information
    std::string_view returned_text = {}, convention = {};  ///< as written; an empty convention is C's
};

struct Global {
    const Type* type;
    std::string_view value;  ///< empty if it is declared elsewhere
    bool is_constant;
};

/// A text that is read from left to right. Every failure is an InputError with the line.
class Cursor {
public:
    explicit Cursor(std::string_view text) : rest_(text), line_(text) {}

    void skip_blanks();
    [[nodiscard]] bool at_end() { return skip_blanks(), rest_.empty(); }
    [[nodiscard]] char peek() { return skip_blanks(), rest_.empty() ? '\0' : rest_.front(); }
    /// Takes the text if it stands here, as a whole word if it ends as one.
    bool take(std::string_view text);
    void expect(std::string_view text);
    /// Takes a word of letters, digits and . _ - $; empty if there is none.
    std::string_view word();
    /// Takes the name after % @ or !, with or without quotation marks.
    std::string name();
    std::int64_t integer();
    /// Skips a group in brackets, which stands here, and returns its inside.
    std::string_view group();
    [[nodiscard]] std::string_view rest() const { return rest_; }
    [[noreturn]] void fail(const std::string& what) const;

private:
    std::string_view rest_, line_;
};

/// A module, which keeps its text. Throws InputError for a text that is not LLVM IR.
class Module {
public:
    explicit Module(std::string text);
    Module(const Module&) = delete;
    Module& operator=(const Module&) = delete;

    const Type* type(Cursor& at);
    /// Skips the attributes of a parameter or an argument; returns the type of `byval`.
    const Type* skip_attributes(Cursor& at);
    const Type* integer_type(int bits);
    const Type* pointer_type() const { return pointer_; }

    [[nodiscard]] const IrFunction* function(const std::string& name) const;
    /// Text of the metadata of this number; empty if there is none.
    [[nodiscard]] std::string_view metadata(int number) const;
    [[nodiscard]] const std::string& text() const { return text_; }
    /// Line number of a part of the text, from 1.
    [[nodiscard]] int line_of(std::string_view part);

    std::map<std::string, IrFunction> functions;
    std::map<std::string, Global> globals;

private:
    const Type* add(Type type) { return &types_.emplace_back(std::move(type)); }
    const Type* structure(std::vector<const Type*> parts, bool packed);
    const Type* structure_of(Cursor& at, char close, bool packed);
    const Type* simple_type(Cursor& at);
    const Type* named(const std::string& name);
    void read_line(std::string_view line);
    void read_global(Cursor& at);
    IrFunction* read_header(Cursor& at);

    std::string text_;
    std::vector<const char*> line_ends_;  // filled by `line_of`
    std::deque<Type> types_;
    const Type* pointer_;
    std::map<std::string, std::string_view> definitions_;  // the text of each named type
    std::map<std::string, const Type*> named_;
    std::map<int, std::string_view> metadata_;
    int depth_ = 0;
};

/// A field of a metadata text, `line: 12` or `name: "x"` without the quotation marks; empty if it has none.
std::string field(std::string_view metadata, std::string_view name);
/// The number of a reference to metadata, `!12`; -1 for anything else.
int reference(std::string_view text);
/// The references in a list, `!{!1, !2, null}`; -1 for null.
std::vector<int> references(std::string_view metadata);

}  // namespace lostbits::intersect::function
