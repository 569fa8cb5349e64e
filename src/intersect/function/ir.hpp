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
    std::size_t size = 0, align = 1;        ///< in bytes
    int bits = 0;                           ///< bits of an integer or a number
    bool is_vector = false;                 ///< true for a sequence such as <4 x float>
    std::vector<const Type*> parts = {};    ///< parts of a structure; the item of a sequence
    std::vector<std::size_t> offsets = {};  ///< offset of each part of a structure
    std::size_t count = 0;                  ///< number of items of a sequence

    /// Part k of a structure or of a sequence, and its offset; null if there is no part k.
    [[nodiscard]] const Type* part(std::size_t k, std::size_t& offset) const;
};

/// A place in the source, and the place of the call that led to it.
struct SourcePlace {
    std::string file;
    int line = 0, column = 0;
    int caller = -1;  ///< index of the place of the call; -1 in the outermost function
};

struct Block {
    std::string name;
    std::vector<std::string_view> lines;  ///< one instruction each
};

struct IrParameter {
    std::string name;
    const Type* type;
    const Type* by_value = nullptr;              ///< the structure, if the caller passes a pointer to a copy of it
    std::string_view type_text = {}, text = {};  ///< the type as written, without and with its attributes
};

struct IrFunction {
    std::string name;
    std::vector<IrParameter> parameters;
    std::vector<Block> blocks;
    int subprogram = -1;                                   ///< index of the metadata node of its debug information
    std::string_view returned_text = {}, convention = {};  ///< as written; an empty convention is that of C
};

struct Global {
    const Type* type;
    std::string_view value;  ///< empty for a global that is defined elsewhere
    bool is_constant;
};

/// A text that is read from left to right. Every failure throws an InputError that quotes the line.
class Cursor {
public:
    explicit Cursor(std::string_view text) : rest_(text), line_(text) {}

    void skip_blanks();
    [[nodiscard]] bool at_end() { return skip_blanks(), rest_.empty(); }
    [[nodiscard]] char peek() { return skip_blanks(), rest_.empty() ? '\0' : rest_.front(); }
    /// Takes the text, and returns true, if the rest begins with it. A text that ends in a word character must end a
    /// whole word.
    bool take(std::string_view text);
    void expect(std::string_view text);
    /// Takes a word of letters, digits and . _ - $; empty if the next character is another one.
    std::string_view take_word();
    /// Takes the name after % @ or !, with or without quotation marks.
    std::string take_name();
    std::int64_t take_integer();
    /// Takes a pair of brackets with all between them, and returns the text inside the brackets.
    std::string_view take_group();
    [[nodiscard]] std::string_view rest() const { return rest_; }
    [[noreturn]] void fail(const std::string& problem) const;

private:
    std::string_view rest_, line_;
};

/// A module of LLVM IR, which keeps its text. Throws InputError for text that is not LLVM IR.
class Module {
public:
    explicit Module(std::string text);
    Module(const Module&) = delete;
    Module& operator=(const Module&) = delete;

    const Type* read_type(Cursor& cursor);
    /// Skips the attributes of a parameter or an argument. Returns the type of the attribute `byval`; null without it.
    const Type* skip_attributes(Cursor& cursor);
    const Type* integer_type(int bits);
    const Type* pointer_type() const { return pointer_; }

    [[nodiscard]] const IrFunction* find_function(const std::string& name) const;
    /// Text of the metadata with this index; empty if the file has no metadata with this index.
    [[nodiscard]] std::string_view metadata(int index) const;
    [[nodiscard]] const std::string& text() const { return text_; }
    /// Line number of a part of the text, from 1.
    [[nodiscard]] int line_of(std::string_view part);

    std::map<std::string, IrFunction> functions;
    std::map<std::string, Global> globals;

private:
    /// The members of a packed structure follow one another without padding.
    enum class Packing { aligned, packed };

    const Type* add_type(Type type) { return &types_.emplace_back(std::move(type)); }
    const Type* make_structure(std::vector<const Type*> parts, Packing packing);
    const Type* read_structure(Cursor& cursor, char close, Packing packing);
    const Type* number_type(int bits);
    const Type* read_simple_type(Cursor& cursor);
    const Type* read_array(Cursor& cursor);
    const Type* read_vector_or_packed_structure(Cursor& cursor);
    const Type* find_named_type(const std::string& name);
    void read_global(Cursor& cursor);
    IrFunction* read_header(Cursor& cursor);
    int read_parameters(IrFunction& function, Cursor& inside);
    IrFunction* read_outer_line(std::string_view line);
    void read_metadata(Cursor& cursor);

    std::string text_;
    std::vector<const char*> line_ends_;  // filled by `line_of`
    std::deque<Type> types_;
    const Type* pointer_;
    std::map<std::string, std::string_view> definitions_;  // the text of each named type
    std::map<std::string, const Type*> named_;
    std::map<int, std::string_view> metadata_;
    int depth_ = 0;
};

/// Returns the value of a field of a metadata text, such as `12` of `line: 12` or `x` of `name: "x"`. Empty if the text
/// has no such field.
std::string metadata_field(std::string_view metadata, std::string_view name);
/// Returns the index in a reference to metadata, such as 12 of `!12`; -1 for any other text.
int metadata_index(std::string_view text);
/// Returns the indices in a list of references, `!{!1, !2, null}`; -1 for null.
std::vector<int> metadata_indices(std::string_view metadata);

}  // namespace lostbits::intersect::function
