// Formulas from outside: libraries compiled with lostbits_form.hpp, whose forms come in every arithmetic, as those of
// the catalogue do.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "intersect/doors/contract.hpp"
#include "intersect/doors/formula.hpp"

namespace lostbits::intersect::doors {

/// The formulas of a library, which is loaded and stays so; none where it exports no `lostbits_formulas`. InputError
/// where it was compiled with other headers than this program, or says what makes no sense of a form.
std::vector<Formula> load_formulas(const std::filesystem::path& library);

/// The t of the formula that `form` is the C interface of, as a form of the first root; nothing where near is t.
std::optional<ForeignForm> first_of(const std::vector<Formula>& formulas, const ForeignForm& form);

/// The formula under a name that begins so, see `prefix_of_plugin`.
void rename(Formula& formula, const std::string& prefix);

/// As rows of the table, and of the packs. InputError for a name that is taken.
void enroll_formulas(const std::vector<Formula>& formulas);

}  // namespace lostbits::intersect::doors
