#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <tuple>

#include "commands.hpp"
#include "number/error.hpp"
#include "output/diff/difference.hpp"
#include "scene/toml/did_you_mean.hpp"

namespace lostbits::analysis {

using output::diff::CompareOptions;

namespace {

namespace fs = std::filesystem;
using output::diff::Comparison;

struct DiffWords {
    std::string a, b;
    std::vector<std::string> tolerances, ignored;
};

/// How a file is compared, which its name says.
enum class FileKind { csv, exr, png, bytes };

FileKind kind_of(const fs::path& path) {
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return extension == ".csv"   ? FileKind::csv
           : extension == ".exr" ? FileKind::exr
           : extension == ".png" ? FileKind::png
                                 : FileKind::bytes;
}

const char* name_of(FileKind kind) {
    switch (kind) {
        case FileKind::csv: return "a CSV file";
        case FileKind::exr: return "an EXR file";
        case FileKind::png: return "a PNG file";
        case FileKind::bytes: break;
    }
    return "a file of another type";
}

/// Two files of one kind. Pictures with the same bytes hold the same pixels, which spares loading the image module;
/// the channels of an EXR have to be known, though, where options name some.
Comparison compare_files(const fs::path& a, const fs::path& b, FileKind kind, const CompareOptions& options) {
    // One after the other: the order of arguments is the compiler's, and the first bad file is the one to name.
    const auto both = [&](auto read) {
        const auto left = read(a);
        return output::diff::compare(left, read(b), options);
    };
    if (kind == FileKind::csv) return both(output::file::read_csv);
    const std::string left = output::file::read_file(a);
    Comparison bytes = output::diff::compare_bytes(left, output::file::read_file(b));
    const bool named = !options.tolerances.empty() || !options.ignored.empty();
    if (kind == FileKind::bytes || (bytes.same() && !(kind == FileKind::exr && named))) return bytes;
    auto& images = output::image::image_backend();
    if (kind == FileKind::exr) return output::diff::compare_exr(images, a, b, options);
    return both([&](const fs::path& path) { return images.read_png(path); });
}

/// A file or, below folders, a pair of files, and what came out; `only` names the folder of a file without a partner.
struct Result {
    std::string file;
    Comparison comparison;
    std::string only;
    [[nodiscard]] bool same() const { return only.empty() && comparison.same(); }
};

/// Every file below a folder, by path relative to it. Links are followed; folders without files leave no trace.
std::set<fs::path> files_below(const fs::path& folder) {
    std::set<fs::path> files;
    try {
        for (const auto& entry :
             fs::recursive_directory_iterator(folder, fs::directory_options::follow_directory_symlink)) {
            if (entry.is_directory()) continue;
            // A pipe or a socket would make the run wait for ever; a broken link has nothing to compare.
            if (!entry.is_regular_file())
                throw InputError(entry.path().string() + ": is not a regular file; move it out of the folder");
            files.insert(entry.path().lexically_relative(folder));
        }
    } catch (const fs::filesystem_error& error) {
        throw EnvironmentError(fmt::format("{}: cannot list the folder: {}; check permissions and links",
                                           error.path1().string(), error.code().message()));
    }
    return files;
}

std::vector<Result> compare_folders(const DiffWords& w, const CompareOptions& options) {
    const fs::path a = w.a, b = w.b;
    const auto left = files_below(a), right = files_below(b);
    auto all = left;
    all.insert(right.begin(), right.end());
    if (all.empty()) throw NothingSelected(fmt::format("{} and {} contain no files; check the paths", w.a, w.b));
    std::vector<Result> results;
    for (const fs::path& file : all) {
        stop_if_interrupted();
        const bool in_a = left.contains(file), in_b = right.contains(file);
        Result& result = results.emplace_back();
        result.file = ((in_a ? a : b) / file).string();
        if (in_a && in_b) result.comparison = compare_files(a / file, b / file, kind_of(file), options);
        else result.only = in_a ? w.a : w.b;
    }
    return results;
}

/// The two words of the command line: two folders, or two files of one kind.
std::vector<Result> compare_all(const DiffWords& w, const CompareOptions& options) {
    const auto status = [](const std::string& path) {
        std::error_code error;
        const auto s = fs::status(path, error);
        if (s.type() == fs::file_type::not_found) throw InputError(path + ": no such file or folder; check the path");
        if (error) throw EnvironmentError(path + ": cannot be read: " + error.message() + "; check the permissions");
        return s;
    };
    const auto a = status(w.a), b = status(w.b);
    if (fs::is_directory(a) && fs::is_directory(b)) return compare_folders(w, options);
    if (fs::is_directory(a) || fs::is_directory(b)) {
        const auto& [folder, file] = fs::is_directory(a) ? std::tie(w.a, w.b) : std::tie(w.b, w.a);
        throw InputError(
            fmt::format("{}: is a folder, but {} is a file; compare two folders or two files", folder, file));
    }
    // What comes through a pipe has no name that says its kind: it is taken for what the other one is.
    const FileKind left = kind_of(fs::is_regular_file(a) ? w.a : w.b),
                   right = kind_of(fs::is_regular_file(b) ? w.b : w.a);
    if (left != right)
        throw InputError(fmt::format("{}: is {}, but {} is {}; compare two files of the same kind", w.a, name_of(left),
                                     w.b, name_of(right)));
    return {{w.a, compare_files(w.a, w.b, left, options), ""}};
}

/// A name that no file knows would loosen or skip nothing, silently.
void refuse_unknown_columns(const CompareOptions& options, const std::vector<Result>& results) {
    std::set<std::string> names;
    for (const Result& r : results) names.insert(r.comparison.names.begin(), r.comparison.names.end());
    const auto check = [&](const char* option, const std::string& pattern) {
        if (std::ranges::any_of(names,
                                [&](const std::string& name) { return output::diff::names_column(pattern, name); }))
            return;
        const std::string hint = scene::toml::did_you_mean(pattern, {names.begin(), names.end()});
        throw InputError(fmt::format("{} {}: unknown column; {}", option, pattern,
                                     hint.empty() ? "no file here has columns or channels" : hint));
    };
    for (const auto& t : options.tolerances) check("--tolerance", t.column);
    for (const auto& pattern : options.ignored) check("--ignore", pattern);
}

void print_largest(const char* name, const output::diff::Largest& largest) {
    if (!largest.at.empty()) fmt::print(", largest {} {:.4g} at {}", name, largest.value, largest.at);
}

/// One line per difference, then a summary with a line per column; `verbose` shows files and columns that agree, too,
/// where they are not identical.
void print(const Result& r, bool verbose) {
    if (!r.only.empty()) return fmt::print("{}: only in {}\n", r.file, r.only);
    const Comparison& c = r.comparison;
    for (const auto& d : c.differences) {
        if (d.line > 0) fmt::print("{}:{}: {}\n", r.file, d.line, d.what);
        else fmt::print("{}: {}\n", r.file, d.what);
    }
    if (c.count > c.differences.size())
        fmt::print("{}: and {} more; -v shows all\n", r.file, c.count - c.differences.size());
    if (!c.same()) fmt::print("{}: {} {}\n", r.file, c.count, c.count == 1 ? "difference" : "differences");
    else if (verbose) fmt::print("{}: same\n", r.file);
    for (const auto& column : c.columns) {
        if (column.count == 0 && !(verbose && !column.absolute.at.empty())) continue;
        fmt::print("  {}: {} differ", column.name, column.count);
        if (column.kinds > 0) fmt::print(", {} of them in kind (NaN, infinite, empty or text)", column.kinds);
        print_largest("abs", column.absolute);
        print_largest("rel", column.relative);
        fmt::print("\n");
    }
}

Exit run(const DiffWords& w, const Common& common) {
    CompareOptions options;
    for (const std::string& text : w.tolerances) options.tolerances.push_back(output::diff::parse_tolerance(text));
    options.ignored = w.ignored;
    if (common.verbose) options.most = UINT64_MAX;
    // Nothing is printed before every file is read: bad input is not to look like half an answer.
    const auto results = compare_all(w, options);
    refuse_unknown_columns(options, results);
    const bool same = std::ranges::all_of(results, &Result::same);
    for (const Result& r : results) {
        if (!r.same() || common.verbose) print(r, common.verbose);
    }
    if (same && !common.quiet) fmt::print("same\n");
    return same ? Exit::done : Exit::answer_is_no;
}

}  // namespace

void add_diff(CLI::App& program, const Common& common, Command& chosen) {
    auto* command = program.add_subcommand(
        "diff",
        "Where two CSV files, two EXR files or two folders differ; NaN, infinite and missing values always count");
    const auto w = std::make_shared<DiffWords>();
    command->add_option("A", w->a, "A file or a folder")->required();
    command->add_option("B", w->b, "The file or folder to compare it with")->required();
    // One word each: A and B may follow.
    command
        ->add_option("--tolerance", w->tolerances,
                     "COLUMN=ABS[,REL]: how far apart numbers may be; columns and channels by name or glob, the last "
                     "match counts")
        ->allow_extra_args(false);
    command->add_option("--ignore", w->ignored, "COLUMN: leave out columns and channels, by name or glob")
        ->allow_extra_args(false);
    command->callback([w, &common, &chosen] { chosen = [w, &common] { return run(*w, common); }; });
}

}  // namespace lostbits::analysis
