// Files of named cases: cases.csv, matrix.png (or one per convention) and datapackage.json.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/sweep/sweep.hpp"
#include "output/image/canvas.hpp"
#include "output/map/map_tables.hpp"

namespace lostbits::output::sweep {

using measure::evaluate::FormSummary;
using measure::sweep::CaseRequest;

/// Colour of a case that a form answers correctly.
inline constexpr image::Rgb8 case_right_colour{226, 238, 226};

/// Meaning of the verdict `right`: `every decision is right, and no answer loses more than 3 bits`.
[[nodiscard]] std::string right_meaning(const scene::sweep::CaseFile& file);
/// Meaning of the verdict `within_inputs`: `within 3 bits of what the inputs allow`.
[[nodiscard]] std::string within_meaning(const scene::sweep::CaseFile& file);
/// Meaning of the numbers in the cells of a matrix.
inline constexpr const char* cell_numbers_meaning =
    "24/48: 24 of the case's 48 rays; 22 b: bits that the worst ray loses; 22/21 b: those, and the bits that the "
    "inputs cost";

struct CaseRow {
    std::string name;
    measure::sweep::Verdict verdict;
    map::SummaryRow summary;
};

/// Files of named cases. They are opened before the work and get their final names when they are complete.
class CaseWriter {
public:
    /// `file_argument` names the file to `lostbits explain`.
    CaseWriter(const CaseRequest& request, const std::filesystem::path& folder, std::string file_argument);
    void finish(const std::vector<std::vector<FormSummary>>& cases);

private:
    const CaseRequest& request_;
    std::filesystem::path folder_;
    std::string file_argument_;
    table::TableFile<CaseRow> csv_;
};

/// The matrix of forms (columns, by format) and cases (rows) for the rows judged by one convention.
image::Canvas draw_case_matrix(const CaseRequest& request, const std::vector<std::vector<FormSummary>>& cases,
                               std::optional<intersect::Touching> touching = {});

}  // namespace lostbits::output::sweep
