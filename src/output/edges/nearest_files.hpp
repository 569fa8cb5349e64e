// The files of a search along the edges of a mesh: worst.csv, with the nearest rays as commands that explain them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/edges/nearest.hpp"

namespace lostbits::output::edges {

struct NearestFiles {
    const measure::edges::EdgeRequest& request;
    const std::vector<measure::edges::EdgeFinding>& found;  ///< one a row
    std::string scene;                                      ///< as a command line names it

    /// A row for each form, format and outcome.
    void write(const std::filesystem::path& folder) const;
    /// What was found of row r: `triangle.woop in f32: crack 492544 edge lengths away, …`.
    [[nodiscard]] std::string sentence(std::size_t r) const;

private:
    [[nodiscard]] std::string explain(std::size_t r, const measure::edges::NearestRay& ray) const;
};

}  // namespace lostbits::output::edges
