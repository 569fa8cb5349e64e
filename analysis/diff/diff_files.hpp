// Compares two files or folders of files, each kind of file in its own way, and two folders of results or two forms in
// one folder: rows, outcomes, largest changes.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "output/diff/difference.hpp"
#include "output/diff/row_changes.hpp"

namespace lostbits::analysis::diff {

/// The way to compare a file, by the extension of its name.
enum class FileKind { csv, exr, png, bytes };
[[nodiscard]] FileKind kind_of(const std::filesystem::path& path);
/// True for a PNG, an SVG or a PDF.
[[nodiscard]] bool is_picture(const std::filesystem::path& path);

/// The result for a file, or for a pair of files below two folders. `only_folder` names the folder of a file that the
/// other folder does not have; empty: both have it.
struct FileResult {
    std::string file;
    output::diff::Comparison comparison;
    std::string only_folder;
    [[nodiscard]] bool is_same() const { return only_folder.empty() && comparison.is_same(); }
};

/// Compares two files of one kind. Pictures with the same bytes are not decoded, so the image module need not be
/// loaded; an EXR is decoded all the same if options name channels, since their names must be checked.
[[nodiscard]] output::diff::Comparison compare_files(const std::filesystem::path& a, const std::filesystem::path& b,
                                                     FileKind kind, const output::diff::CompareOptions& options);

/// A file below two folders, or below one of them.
struct FilePair {
    std::filesystem::path file;  ///< relative to the folders
    bool is_in_a = false, is_in_b = false;
};
/// All files below either folder, in order. Throws NothingSelected if both folders are empty.
[[nodiscard]] std::vector<FilePair> list_file_pairs(const std::filesystem::path& a, const std::filesystem::path& b);
/// Compares one pair of files.
[[nodiscard]] FileResult compare_pair(const FilePair& pair, const std::filesystem::path& a,
                                      const std::filesystem::path& b, const output::diff::CompareOptions& options);

/// Every file below a folder, as a path relative to it. Links are followed; empty folders are ignored.
[[nodiscard]] std::set<std::filesystem::path> files_below(const std::filesystem::path& folder);

/// True if both paths are folders, false if both are files. Throws InputError if one is missing, or if only one is a
/// folder.
[[nodiscard]] bool are_folders(const std::string& a, const std::string& b);

/// Compares two files of one kind, or every file below two folders.
[[nodiscard]] std::vector<FileResult> compare_all(const std::string& a, const std::string& b,
                                                  const output::diff::CompareOptions& options);

/// Throws InputError for a tolerance or an ignored column that names no column: it would have no effect.
void require_known_columns(const output::diff::CompareOptions& options, const std::set<std::string>& names);

/// Prints the largest differences of each column, then a line per difference. With `verbose` also files without
/// differences, and columns that agree within a tolerance.
void print(const FileResult& result, bool verbose);

/// The two sides of a comparison of maps: folders, with an optional form on each side.
struct MapSides {
    std::filesystem::path a, b;
    std::string form_a, form_b;        ///< empty: each form is compared with itself
    std::vector<std::string> formats;  ///< formats to draw; empty: all
    [[nodiscard]] bool compares_two_forms() const { return !form_a.empty(); }
};

struct MapDifference {
    output::diff::RowChanges rows;
    std::vector<FileResult> other_files;     ///< files that are not tables with a row per form
    std::uint64_t tables = 0, pictures = 0;  ///< tables that were compared, pictures that were left out
    [[nodiscard]] bool is_same() const;
};

/// Compares every file below the folders, pictures only if `compares_pictures`. Throws NothingSelected if there is
/// nothing to compare.
[[nodiscard]] MapDifference compare_maps(const MapSides& sides, const output::diff::CompareOptions& options,
                                         bool compares_pictures);

/// Prints the last line of a comparison: in how many rows the second side is better, worse and the same.
void print_verdict(const output::diff::RowVerdict& verdict, const std::string& second);

/// Prints the differences, the verdict last. Prints a few lines of each kind; with `verbose` all lines, and the
/// differences of other files.
void print(const MapDifference& difference, const MapSides& sides, bool verbose);

/// Draws the difference in `out` for each form and format of each map that has pixels on both sides. Returns the paths.
/// Throws InputError if no map has pixels on both sides.
std::vector<std::filesystem::path> draw_map_differences(const MapSides& sides, const std::filesystem::path& out,
                                                        intersect::process::StopToken stop);

}  // namespace lostbits::analysis::diff
