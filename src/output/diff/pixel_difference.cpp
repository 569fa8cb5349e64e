// Reads the pixels of two maps and draws their difference.
#include "output/diff/difference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "measure/answer/outcome.hpp"
#include "number/error.hpp"
#include "output/file/read_csv.hpp"
#include "output/image/heatmap.hpp"

namespace lostbits::output::diff {

using image::Rgb8;
using measure::answer::Outcome;
using measure::answer::outcome_names;

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& reason) {
    throw InputError(fmt::format("{}: {}; make the map again with --pixels csv", path.string(), reason));
}

PixelField read_table_pixels(const std::filesystem::path& path) {
    const file::CsvTable table = file::read_csv(path);
    const file::CsvColumn *const x = table.find("x"), *const y = table.find("y"),
                                 *const outcome = table.find("outcome"), *const lost = table.find("lost_bits");
    if (x == nullptr || y == nullptr || outcome == nullptr || lost == nullptr || table.rows() == 0)
        refuse(path, "it does not have the columns x, y, outcome and lost_bits of a map's pixels");
    const auto parsed_number = [](std::string_view cell) { return file::read_cell(cell).to_double(); };

    // The last row has the largest coordinates.
    PixelField field;
    field.width = static_cast<int>(parsed_number(x->cells.back())) + 1;
    field.height = static_cast<int>(parsed_number(y->cells.back())) + 1;
    if (static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height) != table.rows())
        refuse(path, "it does not hold every pixel of a picture, row by row");

    for (std::size_t r = 0; r < table.rows(); ++r) {
        const auto found = std::ranges::find(outcome_names, outcome->cells[r]);
        if (found == outcome_names.end()) refuse(path, "it has an unknown outcome");
        field.outcomes.push_back(static_cast<std::uint8_t>(found - outcome_names.begin()));
        // Rounded as in an EXR, so that both give the same picture.
        const double bits = lost->cells[r].empty() ? missing : parsed_number(lost->cells[r]);
        field.lost_bits.push_back(static_cast<double>(static_cast<float>(bits)));
    }
    return field;
}

PixelField read_part_pixels(const std::filesystem::path& path, const image::ExrImage& part) {
    const image::ExrChannel *const outcome = part.find("class.outcome"), *const lost = part.find("bits.lost");
    if (outcome == nullptr || lost == nullptr || outcome->samples.index() != 1 || lost->samples.index() != 0)
        refuse(path, "it does not have the channels class.outcome and bits.lost of a map");
    PixelField field{part.width, part.height, {}, {}};
    for (const std::uint32_t code : std::get<1>(outcome->samples)) {
        if (code >= outcome_names.size()) refuse(path, "it has an unknown outcome");
        field.outcomes.push_back(static_cast<std::uint8_t>(code));
    }
    for (const float bits : std::get<0>(lost->samples)) field.lost_bits.push_back(static_cast<double>(bits));
    return field;
}

/// Class of a pixel; nullopt if both outcomes are agreed hits, which have a difference of bits.
std::optional<PixelClass> pixel_class(std::uint8_t a, std::uint8_t b) {
    const auto hit_code = static_cast<std::uint8_t>(Outcome::agree_hit),
               miss_code = static_cast<std::uint8_t>(Outcome::agree_miss);
    const auto is_right = [&](std::uint8_t o) { return o == hit_code || o == miss_code; };
    if (a == hit_code && b == hit_code) return {};
    if (is_right(a) && is_right(b)) return PixelClass::both_miss;
    return is_right(a) ? PixelClass::wrong_now : is_right(b) ? PixelClass::right_now : PixelClass::both_wrong;
}

/// Numbers of pixels by what changed between two maps.
struct PixelCounts {
    std::array<std::uint64_t, pixel_class_colours.size()> by_class{};
    std::uint64_t both_hit = 0, more_lost = 0, fewer_lost = 0;  ///< pixels with a difference of bits
    double largest_difference = 1;                              ///< in bits, at least one
};

PixelCounts count_pixel_changes(const PixelField& a, const PixelField& b) {
    PixelCounts counts;
    for (std::size_t i = 0; i < a.lost_bits.size(); ++i) {
        if (const auto c = pixel_class(a.outcomes[i], b.outcomes[i])) {
            ++counts.by_class[static_cast<std::size_t>(*c)];
            continue;
        }
        const double difference = b.lost_bits[i] - a.lost_bits[i];
        ++counts.both_hit;
        counts.more_lost += difference > 0;
        counts.fewer_lost += difference < 0;
        counts.largest_difference = std::max(counts.largest_difference, std::fabs(difference));
    }
    return counts;
}

}  // namespace

std::optional<PixelField> read_pixels(const std::filesystem::path& folder, const std::string& row) {
    if (const auto table = folder / (row + ".csv"); std::filesystem::exists(table)) return read_table_pixels(table);
    const auto exr = folder / (std::filesystem::weakly_canonical(folder / ".").filename().string() + ".exr");
    if (!std::filesystem::exists(exr)) return {};
    const auto parts = image::image_backend().exr_parts(exr);
    const auto found = std::ranges::find(parts, row);
    if (found == parts.end()) return {};
    return read_part_pixels(exr, image::image_backend().read_exr(exr, static_cast<std::size_t>(found - parts.begin())));
}

std::vector<Rgb8> difference_ramp() {
    const std::array<Rgb8, 3> ends{{{20, 80, 180}, {250, 250, 250}, {200, 80, 0}}};
    std::vector<Rgb8> ramp;
    constexpr int half = 128;
    for (int i = -half; i <= half; ++i) {
        const Rgb8 end = i < 0 ? ends[0] : ends[2], middle = ends[1];
        const auto mix = [&](std::uint8_t m, std::uint8_t e) {
            return static_cast<std::uint8_t>((m * (half - std::abs(i)) + e * std::abs(i) + half / 2) / half);
        };
        ramp.push_back({mix(middle.r, end.r), mix(middle.g, end.g), mix(middle.b, end.b)});
    }
    return ramp;
}

void draw_difference(const std::filesystem::path& path, const PixelField& a, const PixelField& b,
                     const DifferenceTexts& texts) {
    if (a.width != b.width || a.height != b.height)
        throw InputError(fmt::format("{}: {}x{} pixels in {}, {}x{} in {}; make both maps with the same --size",
                                     texts.title, a.width, a.height, texts.first_name, b.width, b.height,
                                     texts.second_name));
    const PixelCounts counts = count_pixel_changes(a, b);

    // The legend lists only classes that occur.
    const std::array<std::string, 4> names{"both miss correctly", "wrong in both", "wrong only in " + texts.second_name,
                                           "right only in " + texts.second_name};
    std::vector<image::LegendEntry> widest_legend, legend;
    for (std::size_t c = 0; c < names.size(); ++c) {
        widest_legend.push_back({names[c], pixel_class_colours[c], std::to_string(a.lost_bits.size())});
        if (counts.by_class[c] > 0)
            legend.push_back({names[c], pixel_class_colours[c], std::to_string(counts.by_class[c])});
    }

    const image::ColourScale scale("difference", difference_ramp(), -counts.largest_difference,
                                   counts.largest_difference);
    image::HeatmapWriter picture(
        path, {.title = texts.title,
               .subtitle = {fmt::format("From {} to {}.", texts.first_name, texts.second_name),
                            fmt::format(
                                "Of {} pixels that both hit correctly, {} lose more bits (orange) and {} fewer (blue).",
                                counts.both_hit, counts.more_lost, counts.fewer_lost)},
               .width = a.width,
               .height = a.height,
               .scale = scale,
               .bar_label = "more bits lost",
               .legend = widest_legend});

    std::vector<Rgb8> row(static_cast<std::size_t>(a.width));
    for (std::size_t i = 0, x = 0; i < a.lost_bits.size(); ++i) {
        const auto c = pixel_class(a.outcomes[i], b.outcomes[i]);
        row[x] = c ? pixel_class_colours[static_cast<std::size_t>(*c)]
                   : scale.colour_of_value(b.lost_bits[i] - a.lost_bits[i]);
        if (++x < row.size()) continue;
        picture.write_rows(row);
        x = 0;
    }
    picture.finish(legend);
}

}  // namespace lostbits::output::diff
