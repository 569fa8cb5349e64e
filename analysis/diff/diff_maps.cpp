#include "analysis/diff/diff_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "number/error.hpp"
#include "output/diff/difference.hpp"
#include "output/file/escape.hpp"
#include "output/image/figure.hpp"
#include "text/count_with_noun.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::analysis::diff {

namespace fs = std::filesystem;
using output::diff::CompareOptions;
using output::diff::RowChanges;
using text::count_with_noun;

namespace {

constexpr std::size_t max_lines = 8;  // lines of each kind, so that all fit on one screen

/// `near-benign `: the folder of a table, as a prefix of the names of its rows.
std::string row_name_prefix(const fs::path& file) {
    const std::string folder = file.parent_path().string();
    const bool is_summary = file.filename() == "summary.csv" || folder.empty();
    std::string subject = is_summary ? folder : file.string();
    return subject.empty() ? "" : subject + " ";
}

/// Compares the rows of two forms in one table; nothing if the table does not have both.
std::optional<RowChanges> compare_two_forms(const fs::path& file, const MapSides& sides,
                                            const CompareOptions& options) {
    const auto table = output::file::read_csv(file);
    if (!output::diff::has_row_keys(table)) return {};
    const auto& forms = table.find("form")->cells;
    const auto has_form = [&](const std::string& form) { return std::ranges::find(forms, form) != forms.end(); };
    if (!has_form(sides.form_a) || !has_form(sides.form_b)) return {};
    return compare_rows(table, table, row_name_prefix(file.lexically_relative(sides.a)), options, {sides.form_a},
                        {sides.form_b});
}

/// Every form that the tables below a folder name.
std::vector<std::string> forms_below(const fs::path& folder) {
    std::set<std::string> forms;
    for (const fs::path& file : files_below(folder)) {
        if (kind_of(file) != FileKind::csv) continue;
        const auto table = output::file::read_csv(folder / file);
        if (!output::diff::has_row_keys(table)) continue;
        for (const std::string_view form : table.find("form")->cells) forms.emplace(form);
    }
    return {forms.begin(), forms.end()};
}

MapDifference compare_forms(const MapSides& sides, const CompareOptions& options) {
    MapDifference difference;
    for (const fs::path& file : files_below(sides.a)) {
        options.stop.check();
        if (kind_of(file) != FileKind::csv) continue;
        auto rows = compare_two_forms(sides.a / file, sides, options);
        if (!rows) continue;
        ++difference.tables;
        difference.rows.add(std::move(*rows));
    }
    if (difference.tables > 0) return difference;

    // Says which of the two forms is missing.
    const auto forms = forms_below(sides.a);
    for (const std::string& form : {sides.form_a, sides.form_b}) {
        if (std::ranges::find(forms, form) == forms.end())
            throw InputError(fmt::format("-i {}: no table below {} has rows of that form; {}", form, sides.a.string(),
                                         forms.empty() ? "map it there first" : text::did_you_mean(form, forms)));
    }
    throw InputError(fmt::format("-i {} -i {}: no table below {} has rows of both; map both in one run", sides.form_a,
                                 sides.form_b, sides.a.string()));
}

void print_lines(const std::string& head, const std::vector<std::string>& lines, bool shows_all) {
    if (lines.empty()) return;
    fmt::print("{}\n", head);
    const std::size_t shown = shows_all ? lines.size() : std::min(max_lines, lines.size());
    for (std::size_t i = 0; i < shown; ++i) fmt::print("  {}\n", output::file::terminal_line(lines[i]));
    if (shown < lines.size()) fmt::print("  and {} more; -v shows all\n", lines.size() - shown);
}

/// The base names of the files of pixels, such as `sphere.press.f32`, of each form and format on both sides.
std::vector<std::pair<std::string, std::string>> pixel_file_names(const MapSides& sides,
                                                                  const output::file::CsvTable& table) {
    std::vector<std::pair<std::string, std::string>> names;
    const auto &forms = table.find("form")->cells, &formats = table.find("format")->cells;
    for (std::size_t r = 0; r < table.rows(); ++r) {
        const std::string form(forms[r]), format(formats[r]);
        if (!sides.formats.empty() && std::ranges::find(sides.formats, format) == sides.formats.end()) continue;
        if (sides.compares_two_forms() && form != sides.form_a) continue;
        names.emplace_back(form + "." + format, (sides.compares_two_forms() ? sides.form_b : form) + "." + format);
    }
    return names;
}

}  // namespace

bool MapDifference::is_same() const { return rows.is_same() && std::ranges::all_of(other_files, &FileResult::is_same); }

MapDifference compare_maps(const MapSides& sides, const CompareOptions& options, bool compares_pictures) {
    if (sides.compares_two_forms()) return compare_forms(sides, options);

    MapDifference difference;
    for (const FilePair& pair : list_file_pairs(sides.a, sides.b)) {
        options.stop.check();
        const fs::path& file = pair.file;
        const FileKind kind = kind_of(file);
        if (is_picture(file) && !compares_pictures) {
            ++difference.pictures;
            continue;
        }
        // Tables with a row per form are compared row by row, all other files as files.
        if (pair.is_in_a && pair.is_in_b && kind == FileKind::csv) {
            const auto a = output::file::read_csv(sides.a / file), b = output::file::read_csv(sides.b / file);
            if (output::diff::has_row_keys(a) && output::diff::has_row_keys(b)) {
                ++difference.tables;
                difference.rows.add(output::diff::compare_rows(a, b, row_name_prefix(file), options));
                continue;
            }
        }
        difference.other_files.push_back(compare_pair(pair, sides.a, sides.b, options));
    }

    if (difference.tables == 0 && difference.other_files.empty())
        throw NothingSelected(fmt::format("{} and {} contain nothing but pictures; --compare-pictures compares them",
                                          sides.a.string(), sides.b.string()));
    difference.rows.sort();
    return difference;
}

void print_verdict(const output::diff::RowVerdict& verdict, const std::string& second) {
    const std::string text = verdict.text(output::file::terminal_line(second));
    if (!text.empty()) fmt::print("{}\n", text);
}

void print(const MapDifference& difference, const MapSides& sides, bool verbose) {
    const std::string a = sides.compares_two_forms() ? sides.form_a : sides.a.string(),
                      b = sides.compares_two_forms() ? sides.form_b : sides.b.string();

    // Tables without such rows, such as those of judge without forms, are compared as files.
    if (difference.rows.compared_row_count + difference.rows.only_a.size() + difference.rows.only_b.size() > 0)
        fmt::print("{} to {}: {} compared, {} {} (in {})\n", a, b,
                   count_with_noun(difference.rows.compared_row_count, "row"), difference.rows.changed_row_count,
                   difference.rows.changed_row_count == 1 ? "differs" : "differ",
                   count_with_noun(difference.tables, "table"));
    print_lines(fmt::format("{} only in {}:", count_with_noun(difference.rows.only_a.size(), "row"), a),
                difference.rows.only_a, verbose);
    print_lines(fmt::format("{} only in {}:", count_with_noun(difference.rows.only_b.size(), "row"), b),
                difference.rows.only_b, verbose);

    std::vector<std::string> lines;
    for (const auto& o : difference.rows.outcomes) lines.push_back(o.row + ": " + o.text);
    print_lines(fmt::format("outcomes differ in {}:", count_with_noun(difference.rows.outcomes.size(), "row")), lines,
                verbose);
    lines.clear();
    for (const auto& c : difference.rows.cells)
        lines.push_back(fmt::format("{}: {} {} to {}", c.row, c.column, c.before, c.after));
    print_lines(fmt::format("largest changes, of {} that {}:", count_with_noun(difference.rows.cells.size(), "number"),
                            difference.rows.cells.size() == 1 ? "differs" : "differ"),
                lines, verbose);
    if (lines.empty() && difference.rows.outcomes.empty() && !difference.rows.changed_reference_columns.empty())
        fmt::print("the numbers are the same; the rows differ in columns that name a ray or a command: {}\n",
                   fmt::join(difference.rows.changed_reference_columns, ", "));
    print_lines("columns:", difference.rows.one_sided_columns, verbose);

    for (const FileResult& result : difference.other_files) {
        if (verbose || !result.only_folder.empty()) {
            if (verbose || !result.is_same()) diff::print(result, verbose);
        } else if (!result.is_same()) {
            fmt::print("{}: {}; -v shows {}\n", output::file::terminal_line(result.file),
                       count_with_noun(result.comparison.count, "difference"),
                       result.comparison.count == 1 ? "it" : "them");
        }
    }
    print_verdict(difference.rows.verdict, b);
}

std::vector<fs::path> draw_map_differences(const MapSides& sides, const fs::path& out,
                                           intersect::process::StopToken stop) {
    std::vector<fs::path> pictures;
    for (const fs::path& file : files_below(sides.a)) {
        if (file.filename() != "summary.csv") continue;
        const auto table = output::file::read_csv(sides.a / file);
        if (!output::diff::has_row_keys(table)) continue;
        const fs::path map = file.parent_path();
        for (const auto& [first, second] : pixel_file_names(sides, table)) {
            stop.check();
            const auto a = output::diff::read_pixels(sides.a / map, first);
            const auto b = a ? output::diff::read_pixels(sides.b / map, second) : std::nullopt;
            if (!a || !b) continue;

            // One form has the folders as the names of its sides, two forms their own names.
            const bool is_one_form = first == second;
            const fs::path picture = out / map / ((is_one_form ? first : first + "-to-" + second) + ".png");
            output::diff::draw_difference(
                picture, *a, *b,
                {(map.empty() ? "" : map.string() + ": ") + (is_one_form ? first : first + " and " + second),
                 is_one_form ? sides.a.string() : first, is_one_form ? sides.b.string() : second});
            std::ranges::copy(output::image::figure_paths(picture), std::back_inserter(pictures));
        }
    }
    if (pictures.empty())
        throw InputError(
            fmt::format("--draw {}: no map below {} has the pixels of a form on both sides; make the maps with "
                        "--pixels csv or --exr",
                        out.string(), sides.a.string()));
    return pictures;
}

}  // namespace lostbits::analysis::diff
