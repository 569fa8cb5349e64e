// The lines of users' files, quoted as compilers quote them.
#include <algorithm>
#include <cctype>
#include <deque>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string_view>

#include "intersect/function/function.hpp"

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

namespace {

/// The function behind a form, and the place of an operation; null for others.
const UserFunction* behind(const Info& form, const Format& format, NodeId node, int& place) {
    const std::lock_guard alone(known().mutex);
    for (const UserFunction* const f : known().all) {
        if (f->answers == nullptr || &f->answers->info != &form) continue;
        const std::vector<NodeId> nodes = f->written->nodes_on_tape(format);
        const auto found = std::ranges::find(nodes, node);
        if (found == nodes.end()) return nullptr;
        place = f->place_of_operation[static_cast<std::size_t>(found - nodes.begin())];
        return place < 0 ? nullptr : f;
    }
    return nullptr;
}

std::string words_of(const SourcePlace& p) {
    return p.file + ":" + std::to_string(p.line) + (p.column > 0 ? ":" + std::to_string(p.column) : "");
}

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; }

/// First and last character of the expression around the operator at `at`, as far as the line shows it.
std::pair<std::size_t, std::size_t> extent(const std::string& line, std::size_t at) {
    if (at >= line.size()) return {at, at};
    const auto strength = [](char c) { return c == '*' || c == '/' ? 2 : c == '+' || c == '-' ? 1 : 0; };
    const int own = strength(line[at]);
    std::size_t begin = at, end = at;
    if (own == 0) {  // a name: the call or the operand that begins here
        while (end + 1 < line.size() && is_word(line[end + 1])) ++end;
        if (end + 1 >= line.size() || line[end + 1] != '(') return {begin, end};
    } else {
        int depth = 0;
        for (std::size_t k = at; k-- > 0;) {
            const char c = line[k];
            if (c == ')' || c == ']') ++depth;
            if (c == '(' || c == '[') --depth;
            if (depth < 0 || (depth == 0 && (std::string_view(",;={}<>!&|?:").find(c) != std::string_view::npos ||
                                             (strength(c) > 0 && strength(c) < own))))
                break;
            if (depth == 0 && k >= 5 && line.compare(k - 5, 6, "return") == 0) break;
            if (c != ' ' && c != '\t') begin = k;
        }
    }
    int depth = 0;
    for (std::size_t k = end + 1; k < line.size(); ++k) {
        const char c = line[k];
        if (c == '(' || c == '[') ++depth;
        if (c == ')' || c == ']') --depth;
        const bool unary = c == '-' && line.find_last_not_of(' ', k - 1) == at;
        if (depth < 0 || (depth == 0 && !unary &&
                          (std::string_view(",;{}<>=!&|?:").find(c) != std::string_view::npos ||
                           (strength(c) > 0 && (strength(c) <= own || own == 0)))))
            break;
        if (c != ' ' && c != '\t') end = k;
        if (own == 0 && depth == 0) break;
    }
    return {begin, end};
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
    const auto [begin, end] = extent(line, at);
    std::string marks;
    for (std::size_t k = 0; k <= end; ++k) {
        if ((static_cast<unsigned char>(line[k]) & 0xC0U) == 0x80U) continue;  // inside of a character in UTF-8
        marks += k == at ? '^' : k >= begin ? '~' : line[k] == '\t' ? '\t' : ' ';
    }
    return text + " " + std::string(number.size(), ' ') + " | " + marks + "\n";
}

}  // namespace lostbits::intersect::function
