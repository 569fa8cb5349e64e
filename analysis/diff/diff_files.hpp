// Two files or two folders of files, compared each its own way.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "output/diff/difference.hpp"

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

}  // namespace lostbits::analysis::diff
