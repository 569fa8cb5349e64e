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
struct Known {
    std::mutex mutex;
    std::vector<const UserFunction*> all;
};
Known& known() {
    static Known functions;
    return functions;
}

}  // namespace

UserFunction::UserFunction() {
    const std::lock_guard alone(known().mutex);
    known().all.push_back(this);
}

UserFunction::~UserFunction() {
    const std::lock_guard alone(known().mutex);
    std::erase(known().all, this);
}

void register_forms(std::unique_ptr<UserFunction> function) {
    static std::deque<std::unique_ptr<UserFunction>> kept;
    kept.push_back(std::move(function));
    table::register_rows({kept.back()->row});
}

const UserFunction* function_of(const Info& form) {
    const std::lock_guard alone(known().mutex);
    for (const UserFunction* const f : known().all)
        if (f->answers != nullptr && &f->answers->info == &form) return f;
    return nullptr;
}

namespace {

/// The function behind a form, and the place of an operation; null for others.
const UserFunction* behind(const Info& form, const Format& format, NodeId node, int& place) {
    const UserFunction* const f = function_of(form);
    if (f == nullptr) return nullptr;
    const std::vector<NodeId> nodes = f->written->nodes_on_tape(format);
    const auto found = std::ranges::find(nodes, node);
    if (found == nodes.end()) return nullptr;
    place = f->place_of_operation[static_cast<std::size_t>(found - nodes.begin())];
    return place < 0 ? nullptr : f;
}

std::string words_of(const SourcePlace& p) {
    return p.file + ":" + std::to_string(p.line) + (p.column > 0 ? ":" + std::to_string(p.column) : "");
}

}  // namespace

std::string place_words(const Info& form, const Format& format, NodeId node) {
    int place = -1;
    const UserFunction* const f = behind(form, format, node, place);
    return f == nullptr ? "" : words_of(f->places[static_cast<std::size_t>(place)]);
}

std::string quoted_line(const Info& form, const Format& format, NodeId node) {
    int place = -1;
    const UserFunction* const f = behind(form, format, node, place);
    if (f == nullptr) return "";
    const SourcePlace& p = f->places[static_cast<std::size_t>(place)];
    std::string text = words_of(p);
    for (int caller = p.caller; caller >= 0; caller = f->places[static_cast<std::size_t>(caller)].caller) {
        const SourcePlace& c = f->places[static_cast<std::size_t>(caller)];
        if (c.line == 0 || c.file != p.file) continue;
        text += ", called at " + std::to_string(c.line) + ":" + std::to_string(c.column);
    }
    text += "\n";
    std::istringstream own(f->source);
    std::ifstream other(p.file);  // the source of LLVM IR, or a header
    std::istream& lines = p.file == f->path ? static_cast<std::istream&>(own) : other;
    std::string line;
    for (int k = 0; k < p.line; ++k) line.clear(), std::getline(lines, line);
    if (line.empty() || static_cast<std::size_t>(p.column) > line.size()) return text;
    const std::string number = std::to_string(p.line);
    text += " " + number + " | " + line + "\n";
    if (p.column < 1) return text;  // only the line is known
    const auto at = static_cast<std::size_t>(p.column - 1);
    const auto [begin, end] = source_text::SourceTokens(line).expression_at(at);
    std::string marks;
    for (std::size_t k = 0; k < end; ++k) {
        if ((static_cast<unsigned char>(line[k]) & 0xC0U) == 0x80U) continue;  // inside of a character in UTF-8
        marks += k == at ? '^' : k >= begin ? '~' : line[k] == '\t' ? '\t' : ' ';
    }
    return text + " " + std::string(number.size(), ' ') + " | " + marks + "\n";
}

}  // namespace lostbits::intersect::function
