// What the commands that write a folder of results have in common.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "commands.hpp"
#include "measure/truth/truth_columns.hpp"

namespace lostbits::analysis {

/// InputError where -o names no folder.
void require_folder(const std::string& out);

/// EnvironmentError where this file could not be written. A folder that cannot be written ends the run before the first
/// ray, not after the tenth scene.
void probe(const std::filesystem::path& file);

/// Moves a bar on, and ends the run where someone interrupted it.
[[nodiscard]] std::function<void(std::uint64_t)> advancing(output::file::Progress& progress);

/// `before` and `after` around each of the values: ` -f f32 -f f64`.
[[nodiscard]] std::string each(const char* before, const std::vector<std::string>& values, const char* after = "");

/// The end of a run in which the truth of so many rays was not proved: says so on stderr.
[[nodiscard]] Exit end_with_unproved(std::uint64_t rays);

/// A line on stdout: how many truths each stage settled.
void print_stages(const measure::truth::StageCounts& stages);

}  // namespace lostbits::analysis
