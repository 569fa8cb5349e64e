// Finds what kind of thing a file or name is and which command takes it, so that `lostbits map mine-sweep.toml` can
// advise `lostbits sweep`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "analysis/shell/command_line.hpp"

namespace lostbits::analysis::selection {

enum class SubjectKind { scene, sweep, cases, search, claims, choices, rays, library, shader, results, picture };

/// Kind of a regular file, by its first bytes, or of a folder; nothing if it is unknown.
[[nodiscard]] std::optional<SubjectKind> find_file_kind(const std::filesystem::path& path);

/// Throws InputError for a subject that the given command does not take; the message names the command that does. A
/// subject that is neither a file of a known kind nor a name in the data folder is left to the command.
void require_argument_kinds(const shell::Command& command, const std::filesystem::path& data);

}  // namespace lostbits::analysis::selection
