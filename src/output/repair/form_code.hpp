// Writes a tape as code with the names of the source: C++, to paste into a function or add to the catalogue, or a GLSL
// function for `--shader`.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"
#include "number/tape.hpp"

namespace lostbits::output::repair {

using intersect::table::Intersector;

/// Statements of the function `intersect`, one per line; the last one returns. T is the number type of the form and W
/// the wider one; `wide(x)` and `narrow(x)` convert between them. Operations have the names that the source gives them.
/// The lines of a tape and of the same tape with wider operations differ only in conversions and types. `reference` is
/// a tape of the same form: operations that are equal in both tapes get the names that they have there.
std::vector<std::string> statements(const Tape& tape, const Intersector& form, const Tape* reference = nullptr);

/// Texts and properties of the file of a form.
struct FormTexts {
    std::string name;  ///< `shape.form`
    std::string title, source;
    std::vector<std::string> head_lines;  ///< lines of the comment at the top
    bool uses_two_words = false;          ///< W is a pair of T numbers, and not the next wider number type
    bool is_binary32_only = false;        ///< the code needs a wider number type, which only binary32 has
};

/// Comment at the top of a C++ or GLSL file: each line after `//`.
std::string head_comment(const FormTexts& texts);

/// Name of the C++ struct of a form: `HalfBMended` for `half_b_mended`.
std::string type_name(const std::string& form);

/// Writes a C++ header with the form, for the catalogue or for a library of lostbits_form.hpp. If the form transforms
/// the ray by a matrix, `intersect` also takes the matrix: twelve numbers as they are stored, row by row. No list of
/// forms accepts such a form.
std::string form_header(const Tape& tape, const Intersector& form_row, const FormTexts& texts);

/// Writes a GLSL file with the function `texts.name`. It uses floats, and doubles only for operations that are wider in
/// double. Arithmetic on two floats as one number, and fma, are written out, because drivers round their own versions
/// in different ways. Throws InputError for a form in doubles, and for operations that GLSL does not have.
std::string shader_code(const Tape& tape, const Intersector& form, const FormTexts& texts);

/// Lists the lines that differ, as a diff does: `- old`, `+ new`, in the order of the new text.
std::vector<std::string> changed_lines(const std::vector<std::string>& before, const std::vector<std::string>& after);

}  // namespace lostbits::output::repair
