// The kind of a file or a name, and the command that takes it: an answer to `lostbits map mine-sweep.toml`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "analysis/shell/command_line.hpp"

namespace lostbits::analysis::selection {

enum class SubjectKind { scene, sweep, cases, search, claims, choices, rays, library, shader, results, picture };

/// The kind of a regular file, by what it begins with, or of a folder; nothing where it is not known.
[[nodiscard]] std::optional<SubjectKind> kind_of_file(const std::filesystem::path& path);

/// InputError for a subject that the command which was given does not take and another takes: it names that one.
/// What is neither a file of a known kind nor a name in the data folder is left to the command.
void refuse_other_kinds(const shell::Command& program, const std::filesystem::path& data);

}  // namespace lostbits::analysis::selection
