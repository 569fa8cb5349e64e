// A tape as code: the C++ of a form, which a person changes in a function and the catalogue takes, or a function of
// GLSL that `--shader` takes; with the source's names.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"
#include "number/tape.hpp"

namespace lostbits::output::mend {

/// The statements of `intersect`, a line each, over T, the number of the form, and W, the wider one, with `wide(x)` and
/// `narrow(x)` for the ways between; the last is the return. Operations have the source's names where it names them.
/// Nothing but conversions and types differs between the lines of a tape and of the same with wider operations.
/// `like`: a tape of the same form; what it computes, too, has the name that it has there.
std::vector<std::string> statements(const Tape& tape, const intersect::table::Intersector& form,
                                    const Tape* like = nullptr);

/// What is to be said in a form's file.
struct FormWords {
    std::string name;  ///< `shape.form`
    std::string title, source;
    std::vector<std::string> head;  ///< lines of a comment at the beginning
    bool two_words = false;         ///< W is two numbers of T, not the next wider one
    bool binary32_only = false;     ///< it goes to a wider number that other formats have not
};

/// The head of a file of C++ or GLSL: each line behind `//`.
std::string head_comment(const FormWords& words);

/// `half_b_mended` as `HalfBMended`.
std::string type_name(const std::string& form);

/// A header that holds the form, for the catalogue or for a library of lostbits_form.hpp. Under a matrix `intersect`
/// takes that as well, twelve numbers as they are stored, row by row: no list of forms takes it.
std::string form_header(const Tape& tape, const intersect::table::Intersector& like, const FormWords& words);

/// A file of GLSL that holds the function `words.name`. Floats alone, and doubles where operations are wider in them;
/// of two floats as one number, and of an fma, the operations are written out, since drivers' own round as they like.
/// InputError for a form of doubles and for operations that GLSL has not.
std::string shader_code(const Tape& tape, const intersect::table::Intersector& like, const FormWords& words);

/// Lines that differ, as a diff has them: `- old`, `+ new`, in the order of the new text.
std::vector<std::string> changed_lines(const std::vector<std::string>& before, const std::vector<std::string>& after);

}  // namespace lostbits::output::mend
