// External formulas: libraries compiled with lostbits_form.hpp, whose forms come in every arithmetic, as those of the
// catalogue do.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "intersect/external/contract.hpp"
#include "intersect/external/formula.hpp"

namespace lostbits::intersect::external {

/// Loads a library, which stays loaded, and returns its formulas; none if it exports no `lostbits_formulas`. InputError
/// if it was compiled with other headers than this program, or states an invalid contract.
std::vector<Formula> load_formulas(const std::filesystem::path& library);

/// The t of the formula behind the C interface `form`, as a form of the first root; nothing if near is t.
std::optional<ForeignForm> first_of(const std::vector<Formula>& formulas, const ForeignForm& form);

/// Puts a prefix in front of the formula's name, see `prefix_of_plugin`.
void rename(Formula& formula, const std::string& prefix);

/// Adds them as rows of the table and of the packs. InputError for a name that is taken.
void register_formulas(const std::vector<Formula>& formulas);

}  // namespace lostbits::intersect::external
