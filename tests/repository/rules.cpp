#include "repository/rules.hpp"

#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace lostbits::test {
namespace {

std::size_t line_of(const std::string& text, std::size_t position) {
    return 1 + static_cast<std::size_t>(
                   std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(position), '\n'));
}

void find_all(const SourceFile& file, const std::string& code, const std::regex& pattern, const std::string& what,
              Offences& offences) {
    for (auto m = std::sregex_iterator(code.begin(), code.end(), pattern); m != std::sregex_iterator(); ++m)
        offences.push_back(at(file, line_of(code, static_cast<std::size_t>(m->position())), what + ": " + m->str()));
}

bool in_shape_folder(const SourceFile& file) {
    static const std::regex path(R"(src/(shapes/\w+/forms|intersect/sdf)/\w+\.hpp)");
    return std::regex_match(file.path, path);
}

std::string first_match(const std::string& text, const char* pattern) {
    std::smatch m;
    return std::regex_search(text, m, std::regex(pattern)) ? m[1].str() : std::string();
}

}  // namespace

std::string code_of(const std::string& text) {
    std::string code = text;
    enum { plain, line_comment, block_comment, string, character } state = plain;
    for (std::size_t i = 0; i < code.size(); ++i) {
        const char c = text[i], next = i + 1 < text.size() ? text[i + 1] : '\0';
        if (state == plain) {
            if (c == '/' && next == '/') state = line_comment;
            else if (c == '/' && next == '*') state = block_comment;
            else if (c == '"') state = string;
            else if (c == '\'' && (i == 0 || !std::isalnum(static_cast<unsigned char>(text[i - 1]))))
                state = character;  // not 1'000
            if (state == line_comment || state == block_comment) code[i] = ' ';
            continue;
        }
        if (c == '\n') {
            if (state != block_comment) state = plain;
            continue;
        }
        if (state == block_comment && c == '/' && text[i - 1] == '*') state = plain;
        else if ((state == string || state == character) && c == '\\') code[i++] = ' ';
        else if ((state == string && c == '"') || (state == character && c == '\'')) {
            state = plain;
            continue;
        }
        code[i] = ' ';
    }
    return code;
}

std::vector<Include> includes_of(const std::string& text) {
    static const std::regex directive(R"re(^\s*#\s*include\s*([<"])([^>"]+)[>"])re");
    std::vector<Include> all;
    std::istringstream lines(text);
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (std::smatch m; std::regex_search(line, m, directive)) all.push_back({number, m[1].str()[0], m[2].str()});
    }
    return all;
}

std::string at(const SourceFile& file, std::size_t line, const std::string& what) {
    return file.path + ":" + std::to_string(line) + ": " + what;
}

bool is_form(const SourceFile& file) {
    return in_shape_folder(file) && file.text.find("static constexpr Info info") != std::string::npos;
}

Offences form_includes(const SourceFile& file) {
    Offences offences;
    if (!in_shape_folder(file)) return offences;
    for (const Include& include : includes_of(file.text)) {
        static const std::set<std::string> allowed{"number", "geometry", "shapes", "intersect"};
        if (!allowed.contains(include.name.substr(0, include.name.find('/'))))
            offences.push_back(at(file, include.line, "a form includes " + include.name));
    }
    return offences;
}

Offences formula_rules(const SourceFile& file) {
    Offences offences;
    if (!in_shape_folder(file)) return offences;
    const std::string code = code_of(file.text);
    static const std::regex libm(R"((\bstd::|(^|[^:\w])::)(sqrt|cbrt|hypot|fma|f?abs|f?min|f?max|)"
                                 R"(copysign|signbit|pow|exp|log|sin|cos|tan|floor|ceil|nextafter)\w*\b)");
    static const std::regex decimal(
        R"((\b\d+\.\d*|\.\d+)([eE][-+]?\d+)?[fFlL]?|\b\d+[eE][-+]?\d+|\b0[xX][0-9a-fA-F.]*[pP][-+]?\d+)");
    static const std::regex branch(R"(\b(if|while|switch)\s*\((?!\s*!?\s*any_of\b))");
    static const std::regex ternary(R"(\?)");
    static const std::regex builtin(R"(\b(float|double)\b)");
    static const std::regex epsilon(R"(\b(numeric_limits|FLT_EPSILON|DBL_EPSILON)\b)");
    find_all(file, code, libm, "libm by name", offences);
    find_all(file, code, decimal, "a decimal literal", offences);
    find_all(file, code, branch, "a branch that is not on any_of", offences);
    find_all(file, code, ternary, "a ternary", offences);
    find_all(file, code, builtin, "a type that is not T", offences);
    find_all(file, code, epsilon, "an epsilon", offences);
    return offences;
}

Offences locale_rules(const SourceFile& file) {
    static const std::regex reader(R"(\b(stod|stof|stold|strtod|strtof|strtold|atof|setlocale)\s*\()");
    Offences offences;
    find_all(file, code_of(file.text), reader, "reads a number as the locale says; use std::from_chars", offences);
    return offences;
}

Offences catalogue_agrees(const std::vector<SourceFile>& files, const SourceFile& catalogue) {
    Offences offences;
    const std::string code = code_of(catalogue.text);
    std::map<std::string, int> included, listed;
    for (const Include& include : includes_of(catalogue.text)) ++included[include.name];
    static const std::regex entry(R"(\b(\w+)::([A-Z]\w+)\b)");
    for (auto m = std::sregex_iterator(code.begin(), code.end(), entry); m != std::sregex_iterator(); ++m)
        ++listed[m->str()];

    for (const SourceFile& file : files) {
        if (!is_form(file)) continue;
        const std::string shape = first_match(file.path, R"(src/\w+/(\w+)/)");
        const std::string stem =
            file.path.substr(file.path.rfind('/') + 1, file.path.size() - file.path.rfind('/') - 5);
        const std::string header = file.path.substr(4);
        if (included[header] != 1)
            offences.push_back(file.path + ": included " + std::to_string(included[header]) +
                               " times by the catalogue");
        const std::string type =
            shape + "::" + first_match(file.text, R"(struct (\w+) [^{;]*\{\s*static constexpr Info info)");
        if (listed[type] != 1)
            offences.push_back(file.path + ": " + type + " listed " + std::to_string(listed[type]) +
                               " times in the catalogue");
        const std::string name = first_match(file.text, R"re(\.name = "([^"]*)")re");
        if (name != shape + "." + stem) offences.push_back(file.path + ": is named " + name);
        included.erase(header);
        listed.erase(type);
    }
    for (const auto& [name, times] : included)
        if (times && in_shape_folder({"src/" + name, ""}) && !name.ends_with("/forms/forms.hpp"))
            offences.push_back(catalogue.path + ": includes " + name + ", which is no form");
    for (const auto& [type, times] : listed)
        if (times && !type.ends_with("Forms"))
            offences.push_back(catalogue.path + ": lists " + type + ", which has no file");
    return offences;
}

Offences file_length(const SourceFile& file) {
    Offences offences;
    const auto lines = std::count(file.text.begin(), file.text.end(), '\n');
    if (lines > 350) offences.push_back(file.path + ": " + std::to_string(lines) + " lines");
    std::istringstream text(file.text);
    std::size_t number = 0;
    for (std::string line; std::getline(text, line);) {
        ++number;
        // Characters, not bytes: a continuation byte of UTF-8 begins with 10.
        const auto width = std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; });
        if (width > 120) offences.push_back(at(file, number, std::to_string(width) + " characters"));
    }
    return offences;
}

}  // namespace lostbits::test
