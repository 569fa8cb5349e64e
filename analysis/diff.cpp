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
#include "shapes/primitive.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::analysis {

namespace fs = std::filesystem;

using diff::FileResult;
using diff::MapSides;
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

/// Parses the values of each measurement option in a command.
Settings parse_settings(const std::string& command) {
    Settings settings;
    const auto words = selection::split_shell_words(command);
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (std::ranges::find(measurement_options(), words[i]) == measurement_options().end()) continue;
        if (words[i] == "--quick" || words[i] == "--single" || words[i] == "--bulk" || i + 1 == words.size())
            settings[words[i]].insert("");
        else if (words[i] != "--set") settings[words[i]].insert(words[i + 1]);
        else
            std::ranges::copy(shell::split_assignments(words[i + 1]),
                              std::inserter(settings[words[i]], settings[words[i]].end()));
    }
    return settings;
}

/// ` 8x8`; empty for a flag.
std::string value_text(const std::string& value) { return value.empty() ? "" : " " + value; }

std::vector<std::string> values_only_in(const std::set<std::string>& left, const std::set<std::string>& right) {
    std::vector<std::string> values;
    std::ranges::set_difference(left, right, std::back_inserter(values));
    return values;
}

/// A line for each option that changes measured values (the size of a picture, numbers of a scene, draws) and differs
/// in the commands that made two folders: `--set sphere[0].radius=1.0001 only in after`. Empty if a folder does not
/// record its command.
std::vector<std::string> option_differences(const fs::path& a, const fs::path& b) {
    const auto run_a = output::file::ResultFolder::last_run(a), run_b = output::file::ResultFolder::last_run(b);
    if (!run_a || !run_b) return {};
    Settings settings_a = parse_settings(run_a->command), settings_b = parse_settings(run_b->command);
    std::vector<std::string> lines;
    for (const std::string& name : measurement_options()) {
        const std::string option(name);
        const auto only_a = values_only_in(settings_a[option], settings_b[option]),
                   only_b = values_only_in(settings_b[option], settings_a[option]);
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
    bool strict = false, compares_pictures = false;
};

std::set<std::string> compared_columns(const std::vector<FileResult>& results) {
    std::set<std::string> names;
    for (const FileResult& result : results)
        names.insert(result.comparison.names.begin(), result.comparison.names.end());
    return names;
}

/// The folder of a file, as the user wrote it; `.` for a file name without a folder.
fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

/// Compares every file of every kind, one after another, as for two commits that should change no result.
ExitStatus run_strictly(const DiffOptions& options, const CompareOptions& compare_options,
                        const CommonOptions& common) {
    // Reads all files before it prints anything, so that bad input does not leave half an answer.
    const auto results = diff::compare_all(options.a, options.b, compare_options);
    diff::require_known_columns(compare_options, compared_columns(results));

    const bool is_same = std::ranges::all_of(results, &FileResult::is_same);
    const bool compares_files = fs::is_regular_file(options.a) && fs::is_regular_file(options.b);
    if (compares_files) print_option_differences(option_differences(folder_of(options.a), folder_of(options.b)));
    for (const FileResult& result : results) {
        if (!result.is_same() || common.verbose) diff::print(result, common.verbose);
    }
    if (is_same && !common.quiet) fmt::print("same\n");

    // Two tables of results also get a verdict.
    if (!is_same && compares_files && !options.strict && diff::kind_of(options.a) == diff::FileKind::csv &&
        diff::kind_of(options.b) == diff::FileKind::csv) {
        const auto a = output::file::read_csv(options.a), b = output::file::read_csv(options.b);
        if (output::diff::has_row_keys(a) && output::diff::has_row_keys(b))
            diff::print_verdict(output::diff::compare_rows(a, b, "", compare_options).verdict, options.b);
    }
    return is_same ? ExitStatus::done : ExitStatus::answer_is_no;
}

ExitStatus run_on_maps(const DiffOptions& options, const MapSides& sides, const CompareOptions& compare_options,
                       const CommonOptions& common) {
    const diff::MapDifference difference = diff::compare_maps(sides, compare_options, options.compares_pictures);
    auto names = compared_columns(difference.other_files);
    names.insert(difference.rows.column_names.begin(), difference.rows.column_names.end());
    diff::require_known_columns(compare_options, names);

    // Draws before anything is printed: a map without pixels is an error.
    std::unique_ptr<output::file::ResultFolder> result_folder;
    if (!options.draw.empty())
        result_folder = lock_folder(options.draw, common, options.a + (options.b.empty() ? "" : " " + options.b));
    const auto pictures =
        options.draw.empty() ? std::vector<fs::path>{} : diff::draw_map_differences(sides, options.draw, common.stop);
    complete_folder(result_folder);

    if (!sides.compares_two_forms()) print_option_differences(option_differences_below(options.a, options.b));
    if (!difference.is_same() || common.verbose) diff::print(difference, sides, common.verbose);
    if (difference.is_same() && !common.quiet) fmt::print("same\n");
    for (const auto& picture : pictures) {
        if (!common.quiet) fmt::print("{}\n", picture.string());
    }
    if (difference.pictures > 0 && !common.quiet)
        fmt::print(stderr, "lostbits: {} {} not compared; --compare-pictures compares {}\n", difference.pictures,
                   difference.pictures == 1 ? "picture is" : "pictures are", difference.pictures == 1 ? "it" : "them");
    return difference.is_same() ? ExitStatus::done : ExitStatus::answer_is_no;
}

/// Prints on stderr which of the compared folders have incomplete results.
void print_incomplete(const DiffOptions& options) {
    std::set<fs::path> folders;
    for (const fs::path side : {options.a, options.b}) {
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
        const std::string message = output::file::ResultFolder::unfinished_sentence(folder);
        if (!message.empty()) fmt::print(stderr, "lostbits: {}\n", message);
    }
}

MapSides parse_sides(const DiffOptions& options) {
    if (options.forms.empty()) return {options.a, options.b, {}, {}, options.formats};
    if (options.forms.size() != 2)
        throw InputError(
            fmt::format("-i: names {}, but diff compares two; name two, as in -i sphere.press -i sphere.unified",
                        text::count_with_noun(options.forms.size(), "form")));
    if (!options.b.empty())
        throw InputError("-i: compares two forms within one folder, but two folders are given; leave out " + options.b +
                         ", or leave out -i to compare the two folders");
    if (options.strict)
        throw InputError("--strict: compares files, but two forms are rows of the same file; leave out --strict");
    return {options.a, options.a, options.forms[0], options.forms[1], options.formats};
}

bool compares_folders(const DiffOptions& options) {
    return diff::are_folders(options.a, options.b.empty() ? options.a : options.b);
}

/// Throws InputError for options that do not go together, or not with what is compared.
void require_compatible_options(const DiffOptions& options, const MapSides& sides) {
    if (options.b.empty() && !sides.compares_two_forms())
        throw InputError("diff: B is missing, the file or folder to compare with; or compare two forms of " +
                         options.a + ": -i FORM -i FORM");
    const bool are_folders = compares_folders(options);
    if (!are_folders && sides.compares_two_forms())
        throw InputError(options.a + ": is a file; to compare two forms, name the folder of a map");
    if (!options.draw.empty() && options.strict)
        throw InputError("--draw: --strict compares files and draws no maps; leave out --draw, or leave out --strict");
    if (!options.draw.empty() && !are_folders)
        throw InputError(
            "--draw: draws maps, which are folders, but files are compared; leave out --draw, or name two folders");
    if (!options.formats.empty() && options.draw.empty())
        throw InputError(
            "-f: selects the formats that --draw draws, but --draw is missing; add --draw FOLDER, or leave out -f");
}

ExitStatus run(const DiffOptions& options, const CommonOptions& common) {
    CompareOptions compare_options;
    compare_options.stop = common.stop;
    for (const std::string& text : options.tolerances)
        compare_options.tolerances.push_back(output::diff::parse_tolerance(text));
    compare_options.ignored = options.ignored;
    if (common.verbose) compare_options.max_listed = UINT64_MAX;
    const MapSides sides = parse_sides(options);
    require_compatible_options(options, sides);
    print_incomplete(options);
    const bool compares_maps = !options.strict && compares_folders(options);
    return compares_maps ? run_on_maps(options, sides, compare_options, common)
                         : run_strictly(options, compare_options, common);
}

}  // namespace

void add_diff(const shell::Command& program, const CommonOptions& common) {
    auto command =
        program.add_command("diff", "Show where two folders of maps, two forms of one folder, or two files differ");
    const auto options = std::make_shared<DiffOptions>();
    command.add("A", options->a, "A file or a folder").required();
    command.add("B", options->b, "The file or folder to compare A with; not with -i");
    command.add("--allow", options->tolerances,
                "Let the numbers of a column differ by ABS, or by REL times the larger one (docs/diff.md)");
    command.add("--ignore", options->ignored, "Do not compare these columns and channels, by name or glob");
    command.add("--strict", options->strict, "Compare every file to the last bit, pictures included");
    command.add("--compare-pictures", options->compares_pictures, "Also compare pictures");
    command.add_list("-i,--form", options->forms, "Compare two forms of the maps in A; replaces B");
    command.add_list("-f,--format", options->formats, "Formats that --draw draws (default: all)");
    command.add("--draw", options->draw,
                "Folder for pictures of the difference; both maps need their pixels, as CSV or EXR");
    command.set_action([options, &common] { return run(*options, common); });
}

}  // namespace lostbits::analysis
