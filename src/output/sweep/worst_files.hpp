// The files of a search: worst.csv, and hard.toml with the rays as cases that can be run again.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "measure/sweep/worst.hpp"

namespace lostbits::output::sweep {

/// Writes both; `hard.toml` is a sweep of cases, one per row, its numbers in hexadecimal.
void write_worst(const std::filesystem::path& folder, const measure::sweep::WorstRequest& request,
                 const std::vector<std::optional<measure::sweep::WorstFound>>& found);

}  // namespace lostbits::output::sweep
