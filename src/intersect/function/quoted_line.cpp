// The lines of users' files, quoted as compilers quote them.
#include <algorithm>
#include <deque>
#include <fstream>
#include <mutex>
#include <sstream>

#include "intersect/function/function.hpp"
#include "intersect/source_text/source_tokens.hpp"

namespace lostbits::intersect::function {
namespace {

/// All functions that exist, to find the file of a form's operation.
struct ExistingFunctions {
    std::mutex mutex;
    std::vector<const UserFunction*> all;
};
ExistingFunctions& existing_functions() {
    static ExistingFunctions functions;
    return functions;
}

}  // namespace

UserFunction::UserFunction() {
    const std::lock_guard lock(existing_functions().mutex);
    existing_functions().all.push_back(this);
}

UserFunction::~UserFunction() {
    const std::lock_guard lock(existing_functions().mutex);
    std::erase(existing_functions().all, this);
}

void register_forms(std::unique_ptr<UserFunction> function) {
    static std::deque<std::unique_ptr<UserFunction>> registered_functions;
    registered_functions.push_back(std::move(function));
    table::register_intersectors({registered_functions.back()->intersector});
}

const UserFunction* function_of(const Info& form) {
    const std::lock_guard lock(existing_functions().mutex);
    for (const UserFunction* const f : existing_functions().all)
        if (f->answers != nullptr && &f->answers->info == &form) return f;
    return nullptr;
}

namespace {

/// Finds the function behind a form and the index of the place of an operation. Null for other forms and for operations
/// without a place.
const UserFunction* function_with_place(const Info& form, const Format& format, NodeId node, int& place_index) {
    const UserFunction* const f = function_of(form);
    if (f == nullptr) return nullptr;
    const std::vector<NodeId> nodes = f->written->find_nodes_on_tape(format);
    const auto node_entry = std::ranges::find(nodes, node);
    if (node_entry == nodes.end()) return nullptr;
    place_index = f->place_of_operation[node_entry - nodes.begin()];
    return place_index < 0 ? nullptr : f;
}

/// Returns the positions of the calls in the same file that lead to a place.
std::string call_chain(const UserFunction& function, const SourcePlace& place) {
    std::string text;
    for (int caller = place.caller; caller >= 0; caller = function.places[caller].caller) {
        const SourcePlace& c = function.places[caller];
        // In Rust, the wrapper that calls the user's function is compiled in the same file, below the user's text.
        const bool is_below = c.file == function.path && c.line > std::ranges::count(function.source, '\n') + 1;
        if (c.line == 0 || c.file != place.file || is_below) continue;
        text += ", called at " + std::to_string(c.line) + ":" + std::to_string(c.column);
    }
    return text;
}

/// Reads the line of a place from the user's text, or from the file of the place: the source of LLVM IR, or a header.
std::string read_line(const UserFunction& function, const SourcePlace& place) {
    std::istringstream own_source(function.source);
    std::ifstream other_file(place.file);
    std::istream& lines = place.file == function.path ? static_cast<std::istream&>(own_source) : other_file;
    std::string line;
    for (int k = 0; k < place.line; ++k) {
        line.clear();
        std::getline(lines, line);
    }
    return line;
}

/// Marks the expression at a byte of a line: blanks, then ~ below the expression and ^ below the byte.
std::string marks_below(const std::string& line, std::size_t marked_byte) {
    const auto [begin, end] = source_text::SourceTokens(line).find_expression_at(marked_byte);
    std::string marks;
    for (std::size_t k = 0; k < end; ++k) {
        if ((static_cast<unsigned char>(line[k]) & 0xC0U) == 0x80U) continue;  // a later byte of a UTF-8 character
        marks += k == marked_byte ? '^' : k >= begin ? '~' : line[k] == '\t' ? '\t' : ' ';
    }
    return marks;
}

std::string text_of_place(const SourcePlace& place) {
    return place.file + ":" + std::to_string(place.line) + (place.column > 0 ? ":" + std::to_string(place.column) : "");
}

}  // namespace

std::string place_text(const Info& form, const Format& format, NodeId node) {
    int place_index = -1;
    const UserFunction* const f = function_with_place(form, format, node, place_index);
    return f == nullptr ? "" : text_of_place(f->places[place_index]);
}

std::string quote_line(const Info& form, const Format& format, NodeId node) {
    int place_index = -1;
    const UserFunction* const f = function_with_place(form, format, node, place_index);
    if (f == nullptr) return "";
    const SourcePlace& p = f->places[place_index];
    const std::string header = text_of_place(p) + call_chain(*f, p) + "\n";

    const std::string line = read_line(*f, p);
    if (line.empty() || static_cast<std::size_t>(p.column) > line.size()) return header;
    const std::string line_number = std::to_string(p.line);
    const std::string quoted = header + " " + line_number + " | " + line + "\n";
    if (p.column < 1) return quoted;  // the column is unknown
    return quoted + " " + std::string(line_number.size(), ' ') + " | " +
           marks_below(line, static_cast<std::size_t>(p.column - 1)) + "\n";
}

}  // namespace lostbits::intersect::function
