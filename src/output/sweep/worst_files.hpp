// The files of searches: worst.csv with commands that explain its rays, and rays as cases that can be run again.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "measure/edges/nearest.hpp"
#include "measure/sweep/worst.hpp"

namespace lostbits::output::sweep {

/// What stands in front of the first case of a file of cases.
std::string head_of_cases(const std::string& title, const std::string& source);

/// A `[[case]]`: the first ray of a group, with its end where it has one, and all solids of the group; every number in
/// hexadecimal.
std::string case_text(const std::string& name, const scene::rays::RayGroup& one);

/// worst.csv, and hard.toml, a sweep of cases, one per row.
void write_worst(const std::filesystem::path& folder, const measure::sweep::WorstRequest& request,
                 const std::vector<std::optional<measure::sweep::WorstFound>>& found);

/// A search along the edges of a mesh.
struct NearestFiles {
    const measure::edges::EdgeRequest& request;
    const std::vector<measure::edges::EdgeFinding>& found;  ///< one a row
    std::string scene;                                      ///< as a command line names it

    /// worst.csv: a row for each form, format and outcome.
    void write(const std::filesystem::path& folder) const;
    /// What was found of row r: `triangle.woop in f32: crack 492544 edge lengths away, …`.
    [[nodiscard]] std::string sentence(std::size_t r) const;
};

}  // namespace lostbits::output::sweep
