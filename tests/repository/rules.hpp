// The rules of the house as functions of a file's path and text, so that each can be shown to catch its offence.
#pragma once

#include <string>
#include <vector>

namespace lostbits::test {

struct SourceFile {
    std::string path;  ///< from the repository's root, with forward slashes
    std::string text;
};

using Offences = std::vector<std::string>;  ///< `path:line: what`

/// The text with comments and the contents of string literals replaced by spaces, lines kept.
std::string code_of(const std::string& text);

struct Include {
    std::size_t line;
    char bracket;
    std::string name;
};
std::vector<Include> includes_of(const std::string& text);

/// `path:line: what`
std::string at(const SourceFile& file, std::size_t line, const std::string& what);

/// True for src/intersect/<shape>/<form>.hpp that declares an `Info`: a form, as opposed to a helper of forms.
bool is_form(const SourceFile& file);

/// A file of a shape's folder stands on number/, geometry/ and intersect/ only.
Offences form_includes(const SourceFile& file);

/// No libm by name, no decimal literal, no `if` on a mask, no ternary, no double by the back door.
Offences formula_rules(const SourceFile& file);

/// No function whose decimal point is the locale's reads a number or writes one: a library that is loaded may set it.
Offences locale_rules(const SourceFile& file);

/// Every form is included once and listed once in the catalogue, and the catalogue holds nothing else.
Offences catalogue_agrees(const std::vector<SourceFile>& files, const SourceFile& catalogue);

/// A file that needs more than 350 lines is two files, and a line of more than 120 characters is two lines.
Offences file_length(const SourceFile& file);

}  // namespace lostbits::test
