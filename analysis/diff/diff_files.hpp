// What changed between two files or folders of files, compared each its own way, and between two folders of results or
// two forms of one: rows, outcomes, largest changes.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "output/diff/difference.hpp"
#include "output/diff/row_changes.hpp"

namespace lostbits::analysis::diff {

/// How a file is compared, which its name says.
enum class FileKind { csv, exr, png, bytes };
[[nodiscard]] FileKind kind_of(const std::filesystem::path& path);

/// A file or, below folders, a pair of files, and what came out; `only` names the folder of a file without a partner.
struct Result {
    std::string file;
    output::diff::Comparison comparison;
    std::string only;
    [[nodiscard]] bool same() const { return only.empty() && comparison.same(); }
};

/// Two files of one kind. Pictures with the same bytes hold the same pixels, which spares loading the image module;
/// the channels of an EXR have to be known, though, where options name some.
[[nodiscard]] output::diff::Comparison compare_files(const std::filesystem::path& a, const std::filesystem::path& b,
                                                     FileKind kind, const output::diff::CompareOptions& options);

/// A file below two folders, or below one of them.
struct FilePair {
    std::filesystem::path file;  ///< relative to the folders
    bool in_a = false, in_b = false;
};
/// All of them, in order. NothingSelected where there are none.
[[nodiscard]] std::vector<FilePair> pairs_below(const std::filesystem::path& a, const std::filesystem::path& b);
/// What came out of one.
[[nodiscard]] Result compare_pair(const FilePair& pair, const std::filesystem::path& a, const std::filesystem::path& b,
                                  const output::diff::CompareOptions& options);

/// Every file below a folder, by path relative to it. Links are followed; folders without files leave no trace.
[[nodiscard]] std::set<std::filesystem::path> files_below(const std::filesystem::path& folder);

/// Whether these are two folders; InputError where something is missing, or one is a file and one a folder.
[[nodiscard]] bool are_folders(const std::string& a, const std::string& b);

/// Two files of one kind, or every file below two folders.
[[nodiscard]] std::vector<Result> compare_all(const std::string& a, const std::string& b,
                                              const output::diff::CompareOptions& options);

/// InputError for a tolerance or an ignored column that names nothing: it would loosen or skip nothing, silently.
void refuse_unknown_columns(const output::diff::CompareOptions& options, const std::set<std::string>& names);

/// What differs most first, then a line per difference; `verbose` shows files and columns that agree, too, where they
/// are not identical.
void print(const Result& result, bool verbose);

/// Two sides of maps: folders, and perhaps a form on each side.
struct MapSides {
    std::filesystem::path a, b;
    std::string form_a, form_b;        ///< empty: every form with itself
    std::vector<std::string> formats;  ///< of what is drawn or held against each other; all if empty
    [[nodiscard]] bool are_forms() const { return !form_a.empty(); }
};

struct MapDifference {
    output::diff::RowChanges rows;
    std::vector<Result> others;              ///< files that are not tables of forms
    std::uint64_t tables = 0, pictures = 0;  ///< compared; left out
    [[nodiscard]] bool same() const;
};

/// Every file below; `pictures`: those too. NothingSelected where nothing is left to compare.
[[nodiscard]] MapDifference compare_maps(const MapSides& sides, const output::diff::CompareOptions& options,
                                         bool pictures);

/// The line that a difference ends with: in how many rows the second side is better, worse and the same.
void print_verdict(const output::diff::RowVerdict& verdict, const std::string& second);

/// The verdict comes last. `most` lines of each kind; `verbose`: all of them, and the differences of other files.
void print(const MapDifference& difference, const MapSides& sides, bool verbose);

/// A picture in `out` for each form and format of each map whose pixels both sides hold; their paths. InputError where
/// there is none.
std::vector<std::filesystem::path> draw_maps(const MapSides& sides, const std::filesystem::path& out,
                                             intersect::process::StopToken stop);

}  // namespace lostbits::analysis::diff
