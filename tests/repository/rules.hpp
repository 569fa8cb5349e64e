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

/// number < geometry < intersect < scene < measure < output < analysis: nothing includes anything to its right, and our
/// own headers are named from src/ (the program's own, in analysis/, by their bare name).
Offences include_directions(const SourceFile& file);

/// True for src/intersect/<shape>/<form>.hpp that declares an `Info`: a form, as opposed to a helper of forms.
bool is_form(const SourceFile& file);

/// A file of a shape's folder stands on number/, geometry/ and intersect/ only.
Offences form_includes(const SourceFile& file);

/// No libm by name, no decimal literal, no `if` on a mask, no ternary, no double by the back door.
Offences formula_rules(const SourceFile& file);

/// Every form is included once and listed once in the catalogue, and the catalogue holds nothing else.
Offences catalogue_agrees(const std::vector<SourceFile>& files, const SourceFile& catalogue);

/// A file that needs more than 350 lines is two files.
Offences file_length(const SourceFile& file);

}  // namespace lostbits::test
