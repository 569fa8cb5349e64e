// The tables of a map: summary.csv (a row per form and format) and the CSV of the pixels of one row.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "measure/map/groups.hpp"
#include "measure/map/summary_columns.hpp"
#include "output/file/csv.hpp"

namespace lostbits::output::map {

/// What comes after `lostbits explain` to name a ray of a summary: `near-benign --pixel 3,4`; empty where nothing does.
using NameOfRay = std::function<std::string(const measure::map::WorstRay&)>;

/// What is known of a row of the map, as the columns of `measure::map::summary_columns`, `worst_columns` and
/// `fault_columns`, the last two with the command that explains the ray. Empty where there is no sample.
class SummaryTable {
public:
    /// `meshes`: the rays are at meshes, and have the outcomes of those. `by`: the column whose values rays are grouped
    /// by, in front of the others; empty: none.
    SummaryTable(const std::vector<const measure::metric::Metric*>& metrics, const std::vector<Shape>& shapes,
                 bool meshes = false, std::string by = {});

    [[nodiscard]] std::vector<file::Column> columns() const;
    /// The cells of one row, from `form` on; the caller ends the row.
    void add(file::CsvWriter& csv, const measure::map::MapRow& row, const measure::map::MapSummary& summary,
             const NameOfRay& name_of_ray) const;
    /// Whole rows: of all rays, and then of each of the groups. `row` is the `r`th of the run.
    void add_all(file::CsvWriter& csv, std::size_t r, const measure::map::MapRow& row,
                 const measure::map::MapSummary& summary, const measure::map::Groups& groups,
                 const NameOfRay& name_of_ray) const;

private:
    std::string by_;
    std::vector<measure::map::SummaryColumn> columns_, fault_columns_;
};

std::vector<file::Column> pixel_columns(const measure::map::MapRequest& request);
void write_pixels(file::CsvWriter& csv, const measure::map::MapRequest& request, const measure::map::MapRow& row,
                  const measure::map::BandResult& result);

/// EnvironmentError where this machine does not let a process have the files of a map open at once: so many pictures of
/// each row, a table of its pixels where wanted, and what all rows have in common.
void require_open_files(const measure::map::MapRequest& request, std::size_t pictures, bool pixels_csv,
                        const std::filesystem::path& folder);

}  // namespace lostbits::output::map
