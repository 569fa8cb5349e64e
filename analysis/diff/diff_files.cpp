#include "analysis/diff/diff_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "number/error.hpp"
#include "output/file/escape.hpp"
#include "text/count_with_noun.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::analysis::diff {

namespace fs = std::filesystem;
using output::diff::CompareOptions;
using output::diff::Comparison;
using output::file::terminal_line;
using text::count_with_noun;

namespace {

const char* name_of(FileKind kind) {
    switch (kind) {
        case FileKind::csv: return "a CSV file";
        case FileKind::exr: return "an EXR file";
        case FileKind::png: return "a PNG file";
        case FileKind::bytes: break;
    }
    return "a file of another type";
}

/// The extension with its dot, in lower case.
std::string extension_of(const fs::path& path) {
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return extension;
}

void print_largest(const char* name, const output::diff::LargestDifference& largest) {
    if (!largest.position.empty())
        fmt::print(", largest {} {:.4g} at {}", name, largest.value, terminal_line(largest.position));
}

}  // namespace

FileKind kind_of(const fs::path& path) {
    const std::string extension = extension_of(path);
    return extension == ".csv"   ? FileKind::csv
           : extension == ".exr" ? FileKind::exr
           : extension == ".png" ? FileKind::png
                                 : FileKind::bytes;
}

bool is_picture(const fs::path& path) {
    const std::string extension = extension_of(path);
    return extension == ".png" || extension == ".svg" || extension == ".pdf";
}

Comparison compare_files(const fs::path& a, const fs::path& b, FileKind kind, const CompareOptions& options) {
    // Reads one file after the other, so that the error names the first bad file: compilers evaluate arguments in any
    // order.
    const auto read_and_compare = [&](auto read) {
        const auto left = read(a);
        return output::diff::compare(left, read(b), options);
    };
    if (kind == FileKind::csv) return read_and_compare(output::file::read_csv);
    const std::string bytes_a = output::file::read_file(a);
    Comparison byte_comparison = output::diff::compare_bytes(bytes_a, output::file::read_file(b));
    const bool has_named_columns = !options.tolerances.empty() || !options.ignored.empty();
    if (kind == FileKind::bytes || (byte_comparison.is_same() && !(kind == FileKind::exr && has_named_columns)))
        return byte_comparison;
    if (kind == FileKind::exr) return output::diff::compare_exr(a, b, options);
    return read_and_compare([&](const fs::path& path) { return output::image::image_backend().read_png(path); });
}

std::set<fs::path> files_below(const fs::path& folder) {
    std::set<fs::path> files;
    try {
        for (const auto& entry :
             fs::recursive_directory_iterator(folder, fs::directory_options::follow_directory_symlink)) {
            if (entry.is_directory()) continue;
            // Reading a pipe or a socket would wait for ever; a broken link has no content.
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

bool are_folders(const std::string& a, const std::string& b) {
    const auto is_folder = [](const std::string& path) {
        std::error_code error;
        const auto status = fs::status(path, error);
        if (status.type() == fs::file_type::not_found)
            throw InputError(path + ": no such file or folder; check the path");
        if (error == std::errc::too_many_symbolic_link_levels || error == std::errc::filename_too_long)
            throw InputError(path + ": cannot be followed: " + error.message() + "; check the path");
        if (error) throw EnvironmentError(path + ": cannot be read: " + error.message() + "; check the permissions");
        return fs::is_directory(status);
    };
    const bool is_a_folder = is_folder(a), is_b_folder = is_folder(b);
    if (is_a_folder == is_b_folder) return is_a_folder;
    const auto& [folder, file] = is_a_folder ? std::tie(a, b) : std::tie(b, a);
    throw InputError(fmt::format("{}: is a folder, but {} is a file; compare two folders or two files", folder, file));
}

std::vector<FilePair> list_file_pairs(const fs::path& a, const fs::path& b) {
    const auto files_a = files_below(a), files_b = files_below(b);
    std::vector<FilePair> all;
    for (const fs::path& file : files_a) all.push_back({file, true, files_b.contains(file)});
    for (const fs::path& file : files_b)
        if (!files_a.contains(file)) all.push_back({file, false, true});
    if (all.empty())
        throw NothingSelected(fmt::format("{} and {} contain no files; check the paths", a.string(), b.string()));
    std::ranges::sort(all, {}, &FilePair::file);
    return all;
}

FileResult compare_pair(const FilePair& pair, const fs::path& a, const fs::path& b, const CompareOptions& options) {
    const auto& [file, is_in_a, is_in_b] = pair;
    const fs::path& folder = is_in_a ? a : b;
    if (!is_in_a || !is_in_b) return {(folder / file).string(), {}, folder.string()};
    return {(a / file).string(), compare_files(a / file, b / file, kind_of(file), options), ""};
}

std::vector<FileResult> compare_all(const std::string& a, const std::string& b, const CompareOptions& options) {
    if (are_folders(a, b)) {
        std::vector<FileResult> results;
        for (const FilePair& pair : list_file_pairs(a, b)) {
            options.stop.check();
            results.push_back(compare_pair(pair, a, b, options));
        }
        return results;
    }
    // The name of a pipe does not tell its kind: it gets the kind of the other file.
    const FileKind kind_a = kind_of(fs::is_regular_file(a) ? a : b), kind_b = kind_of(fs::is_regular_file(b) ? b : a);
    if (kind_a != kind_b)
        throw InputError(fmt::format("{}: is {}, but {} is {}; compare two files of the same kind", a, name_of(kind_a),
                                     b, name_of(kind_b)));
    return {{a, compare_files(a, b, kind_a, options), ""}};
}

void require_known_columns(const CompareOptions& options, const std::set<std::string>& names) {
    const auto check = [&](const char* option, const std::string& pattern) {
        if (std::ranges::any_of(names,
                                [&](const std::string& name) { return output::diff::names_column(pattern, name); }))
            return;
        const std::string hint = text::did_you_mean(pattern, {names.begin(), names.end()});
        throw InputError(fmt::format("{} {}: unknown column; {}", option, pattern,
                                     hint.empty() ? "no file here has columns or channels" : hint));
    };
    for (const auto& t : options.tolerances) check("--allow", t.column);
    for (const auto& pattern : options.ignored) check("--ignore", pattern);
}

void print(const FileResult& result, bool verbose) {
    const std::string file = terminal_line(result.file);
    if (!result.only_folder.empty()) return fmt::print("{}: only in {}\n", file, terminal_line(result.only_folder));
    const Comparison& comparison = result.comparison;
    if (comparison.is_same()) {
        if (verbose) fmt::print("{}: same\n", file);
    } else {
        fmt::print("{}: {}", file, count_with_noun(comparison.count, "difference"));
        if (comparison.differing_rows > 0)
            fmt::print(", in {} of {}", comparison.differing_rows, count_with_noun(comparison.rows, "row"));
        fmt::print("\n");
    }

    // The columns with their largest differences, then single differences.
    for (const auto& column : comparison.columns) {
        if (column.count == 0 && !(verbose && !column.absolute.position.empty())) continue;
        fmt::print("  {}: {} differ", terminal_line(column.name), column.count);
        if (column.not_finite_count > 0)
            fmt::print(", {} of them in kind (NaN, infinite, empty or text)", column.not_finite_count);
        print_largest("abs", column.absolute);
        print_largest("rel", column.relative);
        fmt::print("\n");
    }
    for (const auto& d : comparison.differences) {
        if (d.line > 0) fmt::print("{}:{}: {}\n", file, d.line, terminal_line(d.text));
        else fmt::print("{}: {}\n", file, terminal_line(d.text));
    }
    if (comparison.count > comparison.differences.size())
        fmt::print("{}: and {} more; -v shows all\n", file, comparison.count - comparison.differences.size());
}

}  // namespace lostbits::analysis::diff
