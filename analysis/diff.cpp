#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <set>

#include "analysis/diff/diff_files.hpp"
#include "analysis/selection/options.hpp"
#include "commands.hpp"
#include "number/error.hpp"
#include "output/file/result_folder.hpp"
#include "scene/toml/counted.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::analysis {

namespace fs = std::filesystem;

using diff::MapSides;
using diff::Result;
using output::diff::CompareOptions;

namespace {

/// The options that change measured values, and not only which rows there are or how they are shown.
const std::vector<std::string>& measurement_options() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> names{"--bits",      "--wrong",    "--at",          "--single",   "--bulk",   "--size",
                                       "--set",       "--variant",  "--steps",       "--seeds",    "--scene",  "--miss",
                                       "--direction", "--touching", "--at-origin",   "--inside",   "--facing", "--skip",
                                       "--quick",     "--stage",    "--repetitions", "--open-ends"};
        for (const ShapeRow& shape_row : shape_rows) names.push_back("--" + std::string(shape_row.name));
        return names;
    }();
    return all;
}

using Settings = std::map<std::string, std::set<std::string>>;

/// The values of each measurement option in a command.
Settings settings_of(const std::string& command) {
    Settings settings;
    const auto words = selection::split_shell_words(command);
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (std::ranges::find(measurement_options(), words[i]) == measurement_options().end()) continue;
        if (words[i] == "--quick" || words[i] == "--single" || words[i] == "--bulk" || i + 1 == words.size())
            settings[words[i]].insert("");
        else if (words[i] != "--set") settings[words[i]].insert(words[i + 1]);
        else
            std::ranges::copy(shell::assignments_in(words[i + 1]),
                              std::inserter(settings[words[i]], settings[words[i]].end()));
    }
    return settings;
}

/// ` 8x8`; empty for a flag.
std::string value_text(const std::string& value) { return value.empty() ? "" : " " + value; }

std::vector<std::string> only_in(const std::set<std::string>& left, const std::set<std::string>& right) {
    std::vector<std::string> values;
    std::ranges::set_difference(left, right, std::back_inserter(values));
    return values;
}

/// A line for each option that changes measured values (the size of a picture, numbers of a scene, draws) and differs
/// in the commands that made two folders: `--set sphere[0].radius=1.0001 only in after`. Empty if a folder does not
/// record its command.
std::vector<std::string> option_differences(const fs::path& a, const fs::path& b) {
    const auto run_a = output::file::ResultFolder::last_run_in(a), run_b = output::file::ResultFolder::last_run_in(b);
    if (!run_a || !run_b) return {};
    Settings settings_a = settings_of(run_a->command), settings_b = settings_of(run_b->command);
    std::vector<std::string> lines;
    for (const std::string& name : measurement_options()) {
        const std::string option(name);
        const auto only_a = only_in(settings_a[option], settings_b[option]),
                   only_b = only_in(settings_b[option], settings_a[option]);
        if (only_a.size() == 1 && only_b.size() == 1) {
            lines.push_back(fmt::format("{}{} in {},{} in {}", option, value_text(only_a.front()), a.string(),
                                        value_text(only_b.front()), b.string()));
            continue;
        }
        for (const std::string& value : only_a)
            lines.push_back(fmt::format("{}{} only in {}", option, value_text(value), a.string()));
        for (const std::string& value : only_b)
            lines.push_back(fmt::format("{}{} only in {}", option, value_text(value), b.string()));
    }
    return lines;
}

/// Returns the differences of the two folders and of every pair of folders below them, see `option_differences`.
std::vector<std::string> option_differences_below(const fs::path& a, const fs::path& b) {
    std::vector<std::string> lines = option_differences(a, b);
    std::set<fs::path> folders;
    std::error_code ignored;
    for (auto entry = fs::recursive_directory_iterator(a, ignored); entry != fs::end(entry); entry.increment(ignored)) {
        if (entry->is_directory(ignored)) folders.insert(entry->path().lexically_relative(a));
    }
    for (const fs::path& folder : folders)
        std::ranges::move(option_differences(a / folder, b / folder), std::back_inserter(lines));
    return lines;
}

void print_option_differences(const std::vector<std::string>& lines) {
    if (lines.empty()) return;
    fmt::print("made with other options, which may explain all differences:\n");
    for (const std::string& line : lines) fmt::print("  {}\n", line);
}

struct DiffOptions {
    std::string a, b, draw;
    std::vector<std::string> tolerances, ignored, forms, formats;
    bool strict = false, pictures = false;
};

std::set<std::string> names_of(const std::vector<Result>& results) {
    std::set<std::string> names;
    for (const Result& r : results) names.insert(r.comparison.names.begin(), r.comparison.names.end());
    return names;
}

/// The folder of a file, as the user wrote it; `.` for a file name without a folder.
fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

/// Compares every file of every kind, one after another, as for two commits that should change no result.
Exit run_strictly(const DiffOptions& o, const CompareOptions& options, const Common& common) {
    // Reads all files before it prints anything, so that bad input does not leave half an answer.
    const auto results = diff::compare_all(o.a, o.b, options);
    diff::refuse_unknown_columns(options, names_of(results));
    const bool is_same = std::ranges::all_of(results, &Result::same);
    const bool compares_files = fs::is_regular_file(o.a) && fs::is_regular_file(o.b);
    if (compares_files) print_option_differences(option_differences(folder_of(o.a), folder_of(o.b)));
    for (const Result& r : results) {
        if (!r.same() || common.verbose) diff::print(r, common.verbose);
    }
    if (is_same && !common.quiet) fmt::print("same\n");
    if (!is_same && compares_files && !o.strict && diff::kind_of(o.a) == diff::FileKind::csv &&
        diff::kind_of(o.b) == diff::FileKind::csv) {
        const auto a = output::file::read_csv(o.a), b = output::file::read_csv(o.b);
        if (output::diff::has_row_keys(a) && output::diff::has_row_keys(b))
            diff::print_verdict(output::diff::compare_rows(a, b, "", options).verdict, o.b);
    }
    return is_same ? Exit::done : Exit::answer_is_no;
}

Exit run_on_maps(const DiffOptions& o, const MapSides& sides, const CompareOptions& options, const Common& common) {
    const diff::MapDifference found = diff::compare_maps(sides, options, o.pictures);
    auto names = names_of(found.others);
    names.insert(found.rows.names.begin(), found.rows.names.end());
    diff::refuse_unknown_columns(options, names);
    std::unique_ptr<output::file::ResultFolder> result_folder;
    if (!o.draw.empty()) result_folder = take_folder(o.draw, common, o.a + (o.b.empty() ? "" : " " + o.b));
    const auto pictures = o.draw.empty() ? std::vector<fs::path>{} : diff::draw_maps(sides, o.draw, common.stop);
    complete_folder(result_folder);
    if (!sides.are_forms()) print_option_differences(option_differences_below(o.a, o.b));
    if (!found.same() || common.verbose) diff::print(found, sides, common.verbose);
    if (found.same() && !common.quiet) fmt::print("same\n");
    for (const auto& picture : pictures) {
        if (!common.quiet) fmt::print("{}\n", picture.string());
    }
    if (found.pictures > 0 && !common.quiet)
        fmt::print(stderr, "lostbits: {} {} not compared; --compare-pictures compares {}\n", found.pictures,
                   found.pictures == 1 ? "picture is" : "pictures are", found.pictures == 1 ? "it" : "them");
    return found.same() ? Exit::done : Exit::answer_is_no;
}

/// Prints on stderr which of the compared folders have incomplete results.
void print_incomplete(const DiffOptions& o) {
    std::set<fs::path> folders;
    for (const fs::path side : {o.a, o.b}) {
        if (side.empty()) continue;
        std::error_code ignored;
        const bool is_folder = fs::is_directory(side, ignored);
        folders.insert(is_folder ? side : folder_of(side));
        if (!is_folder) continue;
        for (auto entry = fs::recursive_directory_iterator(side, ignored); entry != fs::end(entry);
             entry.increment(ignored)) {
            if (entry->is_directory(ignored)) folders.insert(entry->path());
        }
    }
    for (const auto& folder : folders) {
        const std::string message = output::file::ResultFolder::unfinished_in(folder);
        if (!message.empty()) fmt::print(stderr, "lostbits: {}\n", message);
    }
}

MapSides sides_of(const DiffOptions& o) {
    if (o.forms.empty()) return {o.a, o.b, {}, {}, o.formats};
    if (o.forms.size() != 2)
        throw InputError(
            fmt::format("-i names {}, but diff compares two; name two, as in -i sphere.press -i sphere.unified",
                        scene::toml::count_with_noun(o.forms.size(), "form")));
    if (!o.b.empty())
        throw InputError("-i compares two forms within one folder, but two folders are given; leave out " + o.b +
                         ", or leave out -i to compare the two folders");
    if (o.strict)
        throw InputError("--strict: compares files, but two forms are rows of the same file; leave out --strict");
    return {o.a, o.a, o.forms[0], o.forms[1], o.formats};
}

Exit run(const DiffOptions& o, const Common& common) {
    CompareOptions options;
    options.stop = common.stop;
    for (const std::string& text : o.tolerances) options.tolerances.push_back(output::diff::parse_tolerance(text));
    options.ignored = o.ignored;
    if (common.verbose) options.max_listed = UINT64_MAX;
    const MapSides sides = sides_of(o);
    if (o.b.empty() && !sides.are_forms())
        throw InputError("diff: B is missing, the file or folder to compare with; or compare two forms of " + o.a +
                         ": -i FORM -i FORM");
    const bool folders = diff::are_folders(o.a, o.b.empty() ? o.a : o.b);
    if (!folders && sides.are_forms())
        throw InputError(o.a + ": is a file; to compare two forms, name the folder of a map");
    if (!o.draw.empty() && o.strict)
        throw InputError("--draw: --strict compares files and draws no maps; leave out --draw, or leave out --strict");
    if (!o.draw.empty() && !folders)
        throw InputError(
            "--draw draws maps, which are folders, but files are compared; leave out --draw, or name two folders");
    if (!o.formats.empty() && o.draw.empty())
        throw InputError(
            "-f selects the formats that --draw draws, but --draw is missing; add --draw FOLDER, or leave out -f");
    print_incomplete(o);
    return folders && !o.strict ? run_on_maps(o, sides, options, common) : run_strictly(o, options, common);
}

}  // namespace

void add_diff(const shell::Command& program, const Common& common) {
    auto command =
        program.add_command("diff", "Show where two folders of maps, two forms of one folder, or two files differ");
    const auto o = std::make_shared<DiffOptions>();
    command.add("A", o->a, "A file or a folder").required();
    command.add("B", o->b, "The file or folder to compare A with; not with -i");
    command.add(
        "--allow", o->tolerances,
        "COLUMN=ABS[,REL]: numbers of a column may differ by ABS, or by REL times the larger one (docs/diff.md)");
    command.add("--ignore", o->ignored, "Do not compare these columns and channels, by name or glob");
    command.add("--strict", o->strict, "Compare every file to the last bit, pictures included");
    command.add("--compare-pictures", o->pictures, "Also compare pictures");
    command.add_list("-i,--form", o->forms, "Compare two forms of the maps in A; replaces B");
    command.add_list("-f,--format", o->formats, "Formats that --draw draws (default: all)");
    command.add("--draw", o->draw, "Folder for pictures of the difference; both maps need their pixels, as CSV or EXR");
    command.runs([o, &common] { return run(*o, common); });
}

}  // namespace lostbits::analysis
