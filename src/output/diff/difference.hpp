// Where two tables or two pictures differ, and by how much; NaN, infinities and missing values are never forgiven. And
// two maps of the same pixels as one picture: where a form loses more bits, where fewer, and whose decisions changed.
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

/// How far apart two finite numbers of a column or channel may be and still agree: |a − b| ≤ absolute, or
/// |a − b| ≤ relative · max(|a|, |b|). Both are at least 0, and neither side is the reference. Under a tolerance, be it
/// 0, −0 equals 0.
struct Tolerance {
    std::string column;                  ///< a name or a glob (fnmatch)
    file::CellValue absolute, relative;  ///< numbers
};

/// Reads `COLUMN=ABS` or `COLUMN=ABS,REL`. Throws InputError.
[[nodiscard]] Tolerance parse_tolerance(const std::string& text);

/// Whether `pattern`, a name or a glob, means the column or channel of that name.
[[nodiscard]] bool names_column(const std::string& pattern, const std::string& name);

struct CompareOptions {
    std::vector<Tolerance> tolerances;  ///< the last that matches a column counts
    std::vector<std::string> ignored;   ///< columns and channels, by name or glob, that are as good as not there
    std::uint64_t most = 20;            ///< differences that are written out; the others are counted
    intersect::process::StopToken stop = {};
};

/// One difference, as a line for people.
struct Difference {
    std::size_t line = 0;  ///< in the first file; 0 where lines mean nothing
    std::string what;
};

/// The largest of something and its place; no place where there was nothing to measure.
struct Largest {
    double value = 0;
    std::string at;
};

/// A column's or channel's share.
struct ColumnDifference {
    std::string name;
    std::uint64_t count = 0;  ///< cells or samples that differ
    std::uint64_t kinds =
        0;             ///< those of them where a number meets NaN, infinity, nothing or text, or two of these meet
    Largest absolute;  ///< |a − b| over all pairs of finite numbers that are not equal, tolerated or not
    Largest relative;  ///< |a − b| / max(|a|, |b|) over the same
};

struct Comparison {
    std::vector<Difference> differences;      ///< in the file's order, at most `CompareOptions::most`
    std::uint64_t count = 0;                  ///< all of them
    std::uint64_t rows = 0, rows_differ = 0;  ///< of tables: those that were compared, and those with a difference
    std::vector<ColumnDifference> columns;  ///< those that both sides have and that were compared, in the first's order
    std::vector<std::string> names;         ///< every column or channel of either side, ignored ones too

    [[nodiscard]] bool same() const { return count == 0; }
};

/// Compares cell by cell: columns by name, rows by position. Columns that are missing, added or moved are differences,
/// and so is another number of rows; what both sides have is compared all the same.
///
/// Numbers compare by their exact values (`1e3` equals `1000`, `-0` differs from `0`, no digit is too many), but as
/// text in a column whose name ends in `_hex`, unless a tolerance names it. NaN equals NaN, empty equals empty, an
/// infinity equals the one of its sign, text equals the same bytes; none of them equals anything else, whatever the
/// tolerance. Differences of two numbers and tolerances are evaluated without rounding.
[[nodiscard]] Comparison compare(const file::CsvTable& a, const file::CsvTable& b, const CompareOptions& options);

/// Compares sizes, channels by name, their types, and every sample: bit by bit where no tolerance names the channel,
/// but any NaN equals any NaN; `f32` differences are evaluated in double. `u32` samples are codes and halves of exact
/// words, so no tolerance applies to them. String attributes are compared, except `lostbits:command`, `:program` and
/// `:compiler`, which say how a file was made and not what is in it.
[[nodiscard]] Comparison compare(const image::ExrImage& a, const image::ExrImage& b, const CompareOptions& options);

/// Compares two EXR files part by part, by name: parts that are missing, added or moved are differences. Parts are read
/// one at a time. Of a file with several parts, what is said begins with the part's name; `names` has the channels of
/// all parts, each once. Throws InputError.
[[nodiscard]] Comparison compare_exr(const std::filesystem::path& a, const std::filesystem::path& b,
                                     const CompareOptions& options);

/// Compares sizes and decoded pixels, exactly; of the options only `most` counts. Its one column is `pixel`, and its
/// largest difference is in steps of 8 bits, the relative one as a fraction of 255.
[[nodiscard]] Comparison compare(const image::PngImage& a, const image::PngImage& b, const CompareOptions& options);

/// Compares byte by byte; at most one difference, the first, with its line.
[[nodiscard]] Comparison compare_bytes(std::string_view a, std::string_view b);

/// The pixels of one form and format of a map.
struct PixelField {
    int width = 0, height = 0;
    std::vector<std::uint8_t> outcome;  ///< as `Outcome`
    std::vector<double> lost;           ///< bits; NaN but for agreed hits
};

/// From `FORM.FORMAT.csv` in the folder of a map, or from the part of that name in its EXR; nothing where it has
/// neither. InputError where the file is not one that a map writes.
[[nodiscard]] std::optional<PixelField> read_pixels(const std::filesystem::path& folder, const std::string& row);

/// Blue where the second loses fewer bits, white where both lose the same, orange where it loses more.
[[nodiscard]] std::vector<image::Rgb8> difference_ramp();

/// What has no difference of bits: fixed colours, off the ramp.
enum class PixelClass : std::uint8_t { both_miss, both_wrong, wrong_now, right_now };
inline constexpr std::array<image::Rgb8, 4> pixel_class_colours{{
    {150, 150, 150},  // both_miss: darker than in a map, since this ramp is white in the middle
    {80, 80, 80},     // both_wrong
    {0, 0, 0},        // wrong_now
    {240, 228, 66},   // right_now: yellow
}};

struct DifferenceWords {
    std::string title, first, second;  ///< what the picture shows, and what the sides are called
};

/// Writes the picture. The ramp's ends are the largest difference, at least one bit. InputError where the two are not
/// of one size.
void draw_difference(const std::filesystem::path& path, const PixelField& a, const PixelField& b,
                     const DifferenceWords& words);

}  // namespace lostbits::output::diff
