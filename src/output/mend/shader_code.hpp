// A tape as a function of GLSL that `--shader` takes, with the source's names.
#pragma once

#include <string>

#include "output/mend/form_code.hpp"

namespace lostbits::output::mend {

/// A file that holds the function. Floats alone, and doubles where operations are wider in them; of two floats as one
/// number, and of an fma, the operations are written out, since drivers' own round as they like. `words.name` is what
/// it is called. InputError for a form of doubles and for operations that GLSL has not.
std::string shader_code(const Tape& tape, const intersect::table::Intersector& like, const FormWords& words);

}  // namespace lostbits::output::mend
