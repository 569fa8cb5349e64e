// Files of a consistency run, which asks a form the same question in two ways at every pixel of a scene.
#pragma once

#include <string>
#include <vector>

#include "measure/consistency/consistency.hpp"
#include "output/study/study_files.hpp"

namespace lostbits::output::consistency {

using measure::consistency::FormChecks;

/// Result of a check for a form in a format.
struct CheckRow {
    const measure::consistency::Check* check;
    const measure::evaluate::TestedForm* row;
    const measure::consistency::CheckSummary* summary;
};

/// A presentation, see output/study/study_files.hpp. One sheet shows all checks: checks across, forms and formats down.
/// `<form>.<format>.<check>.png` is one of its cells. `<form>.<format>.csv` has one row per pixel.
struct ConsistencyPresentation {
    using Study = measure::consistency::ConsistencyStudy;
    using Band = Study::Band;
    using SummaryRow = CheckRow;
    static constexpr const char* summary_title = "One row per check, form and format";
    static constexpr const char* pixel_title = "One row per pixel";

    static table::Table<CheckRow> make_summary_table();
    static std::vector<CheckRow> make_summary_rows(const Study& study, const std::vector<FormChecks>& rows);
    static std::string file_stem(const Study& study, std::size_t form_index);
    static std::size_t pixels(const Band& band) { return band.checks.front().results.size(); }
    static std::vector<pixel::DrawnColumn<Band>> columns(const Study& study);
    static pixel::SheetFile sheet(const Study& study, const std::filesystem::path& file);
    static std::vector<study::Note> notes(const Study& study, const std::vector<FormChecks>& rows);
    static table::Table<study::PixelInBand<Band>> make_pixel_table(const Study& study);
};

}  // namespace lostbits::output::consistency
