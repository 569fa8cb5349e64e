// The options that change a sweep, such as --size, --set and --steps, and which of them each kind of sweep takes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/sweep/case_file.hpp"
#include "scene/sweep/exhaustive_file.hpp"
#include "scene/sweep/search_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::analysis::selection {

/// The options of a sweep, as on the command line; those that were not given are empty.
struct SweepChangeOptions {
    std::string size, steps;
    std::vector<std::string> set = {}, formats = {}, metrics = {};
    std::string against = {}, pictures = "sheets";
    std::optional<int> seeds = {};

    /// ` (--steps 5, --set views=8)`: the end of the title of a changed sweep.
    [[nodiscard]] std::string title_suffix() const;
};

/// Parses the size, the steps and the assignments. Throws InputError for one that is malformed.
scene::sweep::SweepChanges read_changes(const SweepChangeOptions& options);

/// The files that a sweep is read from: its own and that of its scene, which is looked up in `data`.
[[nodiscard]] std::vector<std::filesystem::path> list_input_files(const std::filesystem::path& path,
                                                                  scene::sweep::SweepKind kind,
                                                                  const SweepChangeOptions& options,
                                                                  const std::filesystem::path& data,
                                                                  intersect::process::StopToken stop);

/// Throws InputError if a sweep of that kind does not take one of the options; says why and what to do instead.
void require_allowed_changes(const SweepChangeOptions& options, scene::sweep::SweepKind kind, const std::string& name);

/// The message of an interrupted sweep: where it stopped, and which results are kept.
[[nodiscard]] std::string interrupted_text(scene::sweep::SweepKind kind, const std::string& name);

}  // namespace lostbits::analysis::selection
