// What --size, --set and --steps mean to a sweep, by its kind; and what an interrupt leaves of it.
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

/// As on the command line; what was not given is empty.
struct SweepWords {
    std::string size, steps;
    std::vector<std::string> set = {}, formats = {}, metrics = {};
    std::string against = {}, pictures = "sheets";
    std::optional<int> seeds = {};

    /// ` (--steps 5, --set views=8)`: what the title of a changed sweep ends in.
    [[nodiscard]] std::string in_title() const;
};

/// InputError for what is no size, no numbers of steps, no assignment.
scene::sweep::SweepChanges read_changes(const SweepWords& words);

/// The files that decide what a sweep measures; its scenes are looked up in `data`.
[[nodiscard]] std::vector<std::filesystem::path> files_of(const std::filesystem::path& path,
                                                          scene::sweep::SweepKind kind, const SweepWords& words,
                                                          const std::filesystem::path& data,
                                                          intersect::process::StopToken stop);

/// InputError where a word means nothing to a sweep of that kind, with why and what to do instead.
void check_changes(const SweepWords& words, scene::sweep::SweepKind kind, const std::string& name);

/// The error of an interrupted sweep: where it stopped, and which files there are.
[[nodiscard]] std::string interrupted_text(scene::sweep::SweepKind kind, const std::string& name);

}  // namespace lostbits::analysis::selection
