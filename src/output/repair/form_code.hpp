// Writes a tape as code with the names of the source: C++, to paste into a function or add to the catalogue, or a GLSL
// function for `--shader`.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"
#include "number/tape.hpp"

namespace lostbits::output::repair {

using intersect::table::Intersector;

/// The statements of `intersect`, one per line. T is the number of the form and W the wider one; `wide(x)` and
/// `narrow(x)` convert between them. The last statement is the return. Operations have the names that the source gives
/// them. The lines of a tape and of the same tape with wider operations differ only in conversions and types.
/// `reference` is a tape of the same form, in which equal operations have the same names.
std::vector<std::string> statements(const Tape& tape, const Intersector& form, const Tape* reference = nullptr);

/// Texts and properties of a form's file.
struct FormTexts {
    std::string name;  ///< `shape.form`
    std::string title, source;
    std::vector<std::string> head;  ///< lines of the comment at the top
    bool two_words = false;         ///< W is two numbers of T, and not the next wider number
    bool binary32_only = false;     ///< the code uses a wider number that other formats do not have
};

/// Comment at the top of a C++ or GLSL file: each line after `//`.
std::string head_comment(const FormTexts& texts);

/// Name of the struct of a form: `HalfBMended` for `half_b_mended`.
std::string type_name(const std::string& form);

/// A header that holds the form, for the catalogue or for a library of lostbits_form.hpp. For a form under a matrix,
/// `intersect` also takes the matrix, twelve numbers as they are stored, row by row. No list of forms accepts such a
/// form.
std::string form_header(const Tape& tape, const Intersector& form_row, const FormTexts& texts);

/// A GLSL file that holds the function `texts.name`. It uses only floats, and doubles if operations are wider in them.
/// The operations of two floats as one number, and of an fma, are written out, because drivers round their own versions
/// in different ways. Throws InputError for a form of doubles, and for operations that GLSL does not have.
std::string shader_code(const Tape& tape, const Intersector& form, const FormTexts& texts);

/// Lines that differ, as in a diff: `- old`, `+ new`, in the order of the new text.
std::vector<std::string> changed_lines(const std::vector<std::string>& before, const std::vector<std::string>& after);

}  // namespace lostbits::output::repair
