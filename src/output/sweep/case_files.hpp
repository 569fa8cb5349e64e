// The files of named cases: cases.csv, matrix.png (or one a convention) and datapackage.json.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/sweep/cases.hpp"
#include "output/file/csv.hpp"
#include "output/image/colour.hpp"

namespace lostbits::output::sweep {

/// Of a case that a form has right.
inline constexpr image::Rgb8 case_right_colour{226, 238, 226};

/// What the verdict `right` means: `every decision is right, and no answer loses more than 1 bits beyond …`.
[[nodiscard]] std::string right_means(const scene::sweep::CaseFile& file);

/// Opened before the work, named when it is whole.
class CaseFiles {
public:
    /// `named` is what names the file to `lostbits explain`.
    CaseFiles(const measure::sweep::CaseRequest& request, const std::filesystem::path& folder, std::string named);
    void finish(const std::vector<std::vector<measure::map::MapSummary>>& cases);

private:
    const measure::sweep::CaseRequest& request_;
    std::filesystem::path folder_;
    std::string named_;
    file::CsvWriter csv_;
};

/// The matrix of forms (columns, by format) and cases (rows) alone, of the rows judged by one convention.
void write_case_matrix(const std::filesystem::path& path, const measure::sweep::CaseRequest& request,
                       const std::vector<std::vector<measure::map::MapSummary>>& cases,
                       std::optional<intersect::Touching> judged = {});

}  // namespace lostbits::output::sweep
