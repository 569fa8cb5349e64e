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

/// `form` is a formula as it answers through the C interface. Returns a form whose root is the t of that formula. Empty
/// if the formula yields only t, so that the near of `form` is already t.
std::optional<ForeignForm> find_first_root_form(const std::vector<Formula>& formulas, const ForeignForm& form);

/// Puts a prefix in front of the formula's name; see `prefix_of_plugin`.
void add_prefix(Formula& formula, const std::string& prefix);

/// Adds the formulas as rows of the table and of the packs. Throws InputError for a name that is taken.
void register_formulas(const std::vector<Formula>& formulas);

}  // namespace lostbits::intersect::external
