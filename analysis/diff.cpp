#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>

#include "analysis/diff/diff_files.hpp"
#include "analysis/diff/diff_maps.hpp"
#include "analysis/diff/made_by.hpp"
#include "commands.hpp"
#include "number/error.hpp"
#include "output/file/result_folder.hpp"

namespace lostbits::analysis {

using diff::MapSides;
using diff::Result;
using output::diff::CompareOptions;

namespace {

struct DiffWords {
    std::string a, b, draw;
    std::vector<std::string> tolerances, ignored, forms, formats;
    bool strict = false, pictures = false;
};

std::set<std::string> names_of(const std::vector<Result>& results) {
    std::set<std::string> names;
    for (const Result& r : results) names.insert(r.comparison.names.begin(), r.comparison.names.end());
    return names;
}

/// Where a file lies, as it was written.
std::filesystem::path folder_of(const std::filesystem::path& file) {
    return file.has_parent_path() ? file.parent_path() : ".";
}

/// Every file of every kind, one after another; what two commits that mean to change nothing are held to.
Exit run_strictly(const DiffWords& w, const CompareOptions& options, const Common& common) {
    // Nothing is printed before every file is read: bad input is not to look like half an answer.
    const auto results = diff::compare_all(w.a, w.b, options);
    diff::refuse_unknown_columns(options, names_of(results));
    const bool same = std::ranges::all_of(results, &Result::same);
    const bool files = std::filesystem::is_regular_file(w.a) && std::filesystem::is_regular_file(w.b);
    if (files) diff::print_made_differently(diff::made_differently(folder_of(w.a), folder_of(w.b)));
    for (const Result& r : results) {
        if (!r.same() || common.verbose) diff::print(r, common.verbose);
    }
    if (same && !common.quiet) fmt::print("same\n");
    if (!same && files && !w.strict && diff::kind_of(w.a) == diff::FileKind::csv &&
        diff::kind_of(w.b) == diff::FileKind::csv) {
        const auto a = output::file::read_csv(w.a), b = output::file::read_csv(w.b);
        if (output::diff::has_row_keys(a) && output::diff::has_row_keys(b))
            diff::print_verdict(output::diff::compare_rows(a, b, "", options).verdict, w.b);
    }
    return same ? Exit::done : Exit::answer_is_no;
}

Exit run_on_maps(const DiffWords& w, const MapSides& sides, const CompareOptions& options, const Common& common) {
    const diff::MapDifference found = diff::compare_maps(sides, options, w.pictures);
    auto names = names_of(found.others);
    names.insert(found.rows.names.begin(), found.rows.names.end());
    diff::refuse_unknown_columns(options, names);
    std::unique_ptr<output::file::ResultFolder> owner;
    if (!w.draw.empty()) owner = own_folder(w.draw, common, w.a + (w.b.empty() ? "" : " " + w.b));
    const auto pictures =
        w.draw.empty() ? std::vector<std::filesystem::path>{} : diff::draw_maps(sides, w.draw, common.stop);
    if (!sides.are_forms()) diff::print_made_differently(diff::made_differently_below(w.a, w.b));
    if (!found.same() || common.verbose) diff::print(found, sides, common.verbose);
    if (found.same() && !common.quiet) fmt::print("same\n");
    for (const auto& picture : pictures) {
        if (!common.quiet) fmt::print("{}\n", picture.string());
    }
    if (found.pictures > 0 && !common.quiet)
        fmt::print(stderr, "lostbits: {} {} not compared; --pictures compares {}\n", found.pictures,
                   found.pictures == 1 ? "picture is" : "pictures are", found.pictures == 1 ? "it" : "them");
    return found.same() ? Exit::done : Exit::answer_is_no;
}

/// What is compared may be half of a result.
void say_what_is_unfinished(const DiffWords& w) {
    std::set<std::filesystem::path> folders;
    for (const std::filesystem::path side : {w.a, w.b}) {
        if (side.empty()) continue;
        std::error_code ignored;
        const bool is_folder = std::filesystem::is_directory(side, ignored);
        folders.insert(is_folder ? side : folder_of(side));
        if (!is_folder) continue;
        for (auto at = std::filesystem::recursive_directory_iterator(side, ignored); at != std::filesystem::end(at);
             at.increment(ignored)) {
            if (at->is_directory(ignored)) folders.insert(at->path());
        }
    }
    for (const auto& folder : folders) {
        const std::string words = output::file::ResultFolder::unfinished_in(folder);
        if (!words.empty()) fmt::print(stderr, "lostbits: {}\n", words);
    }
}

MapSides sides_of(const DiffWords& w) {
    if (w.forms.empty()) return {w.a, w.b, {}, {}, w.formats};
    if (w.forms.size() != 2)
        throw InputError(fmt::format("-i: names {} form{}; name two of them, as in -i sphere.press -i sphere.unified",
                                     w.forms.size(), w.forms.size() == 1 ? "" : "s"));
    if (!w.b.empty())
        throw InputError("-i: compares two forms within one folder; leave out " + w.b +
                         ", or -i to compare two folders");
    if (w.strict) throw InputError("--strict: compares files, and two forms are rows of the same file; leave it out");
    return {w.a, w.a, w.forms[0], w.forms[1], w.formats};
}

Exit run(const DiffWords& w, const Common& common) {
    CompareOptions options;
    options.stop = common.stop;
    for (const std::string& text : w.tolerances) options.tolerances.push_back(output::diff::parse_tolerance(text));
    options.ignored = w.ignored;
    if (common.verbose) options.most = UINT64_MAX;
    const MapSides sides = sides_of(w);
    if (w.b.empty() && !sides.are_forms())
        throw InputError("diff: B is required, a file or folder to compare with; or name two forms of " + w.a +
                         ": -i FORM -i FORM");
    const bool folders = diff::are_folders(w.a, w.b.empty() ? w.a : w.b);
    if (!folders && sides.are_forms())
        throw InputError(w.a + ": is a file; two forms are compared within the folder of a map");
    if (!w.draw.empty() && (!folders || w.strict))
        throw InputError("--draw: needs two folders of maps, or two forms of one, without --strict; leave it out");
    if (!w.formats.empty() && w.draw.empty())
        throw InputError("-f: chooses what --draw draws; add --draw FOLDER, or leave out -f");
    say_what_is_unfinished(w);
    return folders && !w.strict ? run_on_maps(w, sides, options, common) : run_strictly(w, options, common);
}

}  // namespace

void add_diff(const shell::Command& program, const Common& common) {
    auto command = program.add_command(
        "diff",
        "Where two folders of maps, two forms of one, or two files differ; NaN, infinite and missing values always "
        "count");
    const auto w = std::make_shared<DiffWords>();
    command.add("A", w->a, "A file or a folder").required();
    command.add("B", w->b, "The file or folder to compare it with; none with two forms");
    command.add("--tolerance", w->tolerances,
                "COLUMN=ABS[,REL]: how far apart numbers may be; columns and channels by name or glob, the last "
                "match counts");
    command.add("--ignore", w->ignored, "COLUMN: leave out columns and channels, by name or glob");
    command.add("--strict", w->strict,
                "Every file, pictures too, row by row and line by line: for changes that mean to change nothing");
    command.add("--pictures", w->pictures, "Compare pictures too");
    command.add_list("-i,--intersector", w->forms, "Two forms of the maps in A, in place of B");
    command.add_list("-f,--format", w->formats, "Formats that --draw draws (default: all)");
    command.add("--draw", w->draw,
                "A folder for pictures of the difference, one a form and format; of maps made with --pixels "
                "csv or --exr");
    command.runs([w, &common] { return run(*w, common); });
}

}  // namespace lostbits::analysis
