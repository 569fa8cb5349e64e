// External formulas: libraries compiled with lostbits_form.hpp, whose forms exist in every arithmetic, as the forms of
// the catalogue do.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "intersect/external/contract.hpp"
#include "intersect/external/formula.hpp"

namespace lostbits::intersect::external {

/// Loads a library, which stays loaded, and returns its formulas; none if it exports no `lostbits_formulas`. Throws
/// InputError if the library was compiled with other headers than this program, or states an invalid contract.
std::vector<Formula> load_formulas(const std::filesystem::path& library);

/// The form that yields as its root the t of the formula that also answers through the C interface as `form`. Empty if
/// the formula yields only t, so that near is already t.
std::optional<ForeignForm> first_of(const std::vector<Formula>& formulas, const ForeignForm& form);

/// Puts a prefix in front of the formula's name; see `prefix_of_plugin`.
void rename(Formula& formula, const std::string& prefix);

/// Adds the formulas as rows of the table and of the packs. Throws InputError for a name that is taken.
void register_formulas(const std::vector<Formula>& formulas);

}  // namespace lostbits::intersect::external
