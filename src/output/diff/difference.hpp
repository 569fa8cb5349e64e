// Compares two tables or two pictures, and measures their differences. No tolerance covers NaN, infinities and missing
// values. Also draws the difference of two maps of the same pixels as one picture: where a form loses more bits, where
// it loses fewer, and where decisions changed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "output/file/read_csv.hpp"
#include "output/image/colour.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::diff {

/// Largest distance at which two finite numbers of a column or channel still agree: |a − b| ≤ absolute, or |a − b| ≤
/// relative · max(|a|, |b|). Both tolerances are at least 0. Neither number is the reference. With a tolerance, even of
/// 0, −0 equals 0.
struct Tolerance {
    std::string column;                  ///< a name or a glob (fnmatch)
    file::CellValue absolute, relative;  ///< numbers
};

/// Reads `COLUMN=ABS` or `COLUMN=ABS,REL`. Throws InputError.
[[nodiscard]] Tolerance parse_tolerance(const std::string& text);

/// True if `pattern`, a name or a glob, matches the column or channel of that name.
[[nodiscard]] bool names_column(const std::string& pattern, const std::string& name);

struct CompareOptions {
    std::vector<Tolerance> tolerances;  ///< of several that match a column, the last one counts
    std::vector<std::string> ignored;   ///< names or globs of columns and channels to leave out
    std::uint64_t max_listed = 20;      ///< largest number of differences that are listed; the others are only counted
    intersect::process::StopToken stop = {};
};

/// One difference, as a line of text.
struct Difference {
    std::size_t line = 0;  ///< line in the first file; 0 if the files have no lines
    std::string text;
};

/// The largest value and its position; no position if nothing was measured.
struct LargestDifference {
    double value = 0;
    std::string position;
};

/// Differences of one column or channel.
struct ColumnDifference {
    std::string name;
    std::uint64_t count = 0;  ///< number of cells or samples that differ
    /// Number of differing pairs with a NaN, an infinity, a missing value or a text; pairs of two texts do not count.
    std::uint64_t not_finite_count = 0;
    LargestDifference absolute;  ///< largest |a − b| over all pairs of unequal finite numbers, tolerated or not
    LargestDifference relative;  ///< largest |a − b| / max(|a|, |b|) over the same pairs
};

struct Comparison {
    std::vector<Difference> differences;         ///< in the file's order, at most `CompareOptions::max_listed`
    std::uint64_t count = 0;                     ///< number of all differences, listed or not
    std::uint64_t rows = 0, differing_rows = 0;  ///< for tables: rows compared, and rows with a difference
    /// Columns that both sides have and that were compared, in the order of the first side.
    std::vector<ColumnDifference> columns;
    std::vector<std::string> names;  ///< every column or channel of either side, ignored ones too

    [[nodiscard]] bool is_same() const { return count == 0; }
};

/// Compares two tables cell by cell: columns by name, and rows by their `id` if both tables have one for each row,
/// otherwise by position. Missing, added and moved columns are differences, and so are missing and added rows; what
/// both sides have is compared anyway. Numbers are compared by their exact values (`1e3` equals `1000`, `-0` differs
/// from `0`, every digit counts). In a column whose name ends in `_hex` they are compared as text, unless a tolerance
/// names the column. NaN equals NaN, empty equals empty, an infinity equals the one of its sign, and text equals the
/// same bytes; no tolerance makes a NaN, an empty cell, an infinity or a text equal to anything else. Differences of
/// two numbers and tolerances are evaluated without rounding.
[[nodiscard]] Comparison compare(const file::CsvTable& a, const file::CsvTable& b, const CompareOptions& options);

/// Compares sizes, channels by name, their types, and every sample. Samples are compared bit by bit unless a tolerance
/// names the channel, but any NaN equals any NaN. Differences of `f32` samples are evaluated in double. `u32` samples
/// are codes and halves of exact words, so no tolerance applies to them. String attributes are compared, except
/// `lostbits:command`, `:program` and `:compiler`, which record how a file was made and not its contents.
[[nodiscard]] Comparison compare(const image::ExrImage& a, const image::ExrImage& b, const CompareOptions& options);

/// Compares two EXR files part by part, by name. Missing, added and moved parts are differences. Parts are read one at
/// a time. If a file has several parts, each message begins with the part's name. `Comparison::names` then has the
/// channels of all parts, each once. Throws InputError.
[[nodiscard]] Comparison compare_exr(const std::filesystem::path& a, const std::filesystem::path& b,
                                     const CompareOptions& options);

/// Compares sizes and decoded pixels exactly; the only option that counts is `max_listed`. The only column is `pixel`.
/// Its largest difference is in 8-bit steps, and the relative one is a fraction of 255.
[[nodiscard]] Comparison compare(const image::PngImage& a, const image::PngImage& b, const CompareOptions& options);

/// Compares two files byte by byte. Reports at most one difference, the first, with its line.
[[nodiscard]] Comparison compare_bytes(std::string_view a, std::string_view b);

/// Pixels of one form and format of a map.
struct PixelField {
    int width = 0, height = 0;
    std::vector<std::uint8_t> outcomes;  ///< values of `Outcome`
    std::vector<double> lost_bits;       ///< NaN unless the outcome is an agreed hit
};

/// Reads `FORM.FORMAT.csv` in the folder of a map, or the part FORM.FORMAT of its EXR; nothing if neither exists.
/// Throws InputError if the file is not one that a map writes.
[[nodiscard]] std::optional<PixelField> read_pixels(const std::filesystem::path& folder, const std::string& row);

/// Ramp from blue, if the second map loses fewer bits, over white, if both lose the same, to orange, if it loses more.
[[nodiscard]] std::vector<image::Rgb8> difference_ramp();

/// Classes of pixels that have no difference of bits, because not both maps hit correctly. Their fixed colours are not
/// on the ramp.
enum class PixelClass : std::uint8_t { both_miss, both_wrong, wrong_now, right_now };
inline constexpr std::array<image::Rgb8, 4> pixel_class_colours{{
    {150, 150, 150},  // both_miss: darker than in a map, because this ramp is white in the middle
    {80, 80, 80},     // both_wrong
    {0, 0, 0},        // wrong_now
    {240, 228, 66},   // right_now: yellow
}};

struct DifferenceTexts {
    std::string title;                    ///< title of the picture
    std::string first_name, second_name;  ///< names of the two maps
};

/// Writes the picture of the differences of two maps. The ramp ends at the largest difference of bits, at least one
/// bit. Throws InputError if the sizes differ.
void draw_difference(const std::filesystem::path& path, const PixelField& a, const PixelField& b,
                     const DifferenceTexts& texts);

}  // namespace lostbits::output::diff
