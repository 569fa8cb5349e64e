// The files of named cases: cases.csv, matrix.png (or one a convention) and datapackage.json.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/sweep/cases.hpp"
#include "output/image/colour.hpp"
#include "output/file/csv.hpp"

namespace lostbits::output {

/// Of a case that a form has right.
inline constexpr Rgb8 case_right_colour{226, 238, 226};

/// Opened before the work, named when it is whole.
class CaseFiles {
public:
    CaseFiles(const CaseRequest& request, const std::filesystem::path& folder);
    void finish(const std::vector<std::vector<MapSummary>>& cases);

private:
    const CaseRequest& request_;
    std::filesystem::path folder_;
    CsvWriter csv_;
};

/// The matrix of forms (columns, by format) and cases (rows) alone, of the rows judged by one convention.
void write_case_matrix(const std::filesystem::path& path, const CaseRequest& request, const std::vector<std::vector<MapSummary>>& cases,
                       std::optional<Touching> judged = {});

}  // namespace lostbits::output
