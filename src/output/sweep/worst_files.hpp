// Files of searches: worst.csv with commands that explain its rays, and the rays as cases that can be run again.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "measure/edges/edge_search.hpp"
#include "measure/sweep/worst.hpp"

namespace lostbits::output::sweep {

/// Text that begins a file of cases, before its first case.
std::string case_file_head(const std::string& title, const std::string& source);

/// A `[[case]]` with the first ray of a group, the ends of its range if it has any, and all primitives of the group.
/// Every number is hexadecimal.
std::string case_text(const std::string& name, const scene::rays::RayGroup& group);

/// Writes worst.csv, and hard.toml, a sweep of cases with one case per row.
void write_worst(const std::filesystem::path& folder, const measure::sweep::WorstRequest& request,
                 const std::vector<std::optional<measure::sweep::WorstResult>>& results);

/// Results of a search along the edges of a mesh.
struct NearestWriter {
    const measure::edges::EdgeRequest& request;
    const std::vector<measure::edges::EdgeResults>& findings;  ///< one per row of the request
    std::string scene_argument;                                ///< the scene as an argument of a command

    /// Writes worst.csv with a row for each form, format and outcome, and census.csv with a row for each form, format
    /// and target.
    void write(const std::filesystem::path& folder) const;
    /// Findings of row r of the request in words: `triangle.woop in f32: none of 15008 rays at edges, …; the search
    /// for the nearest found no crack among 32768 rays, …`.
    [[nodiscard]] std::string sentence(std::size_t r) const;
};

}  // namespace lostbits::output::sweep
