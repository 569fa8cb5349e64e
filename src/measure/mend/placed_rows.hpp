// Mended forms that take the matrix of their solid: what is compiled of them, and the rows that it becomes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/mend/price.hpp"

namespace lostbits::measure::mend {

/// Whether they were made of forms that are asked through the space of a solid; all of them are alike.
bool are_placed(const std::vector<Written>& forms);

/// The source that includes `mended0.hpp`, `mended1.hpp`, … and exports the kernels of each.
std::string placed_source_of(const std::vector<Written>& forms);

/// A row for each, of the format of the form that it was made of. In the registers of the run, as rows of a space are.
std::vector<intersect::doors::Formula> placed_rows(const std::filesystem::path& library,
                                                   const std::vector<Written>& forms);

}  // namespace lostbits::measure::mend
