// Compares EXR and PNG pictures (see `compare`).
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "output/diff/ledger.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::diff {

using image::ExrChannel;
using image::ExrImage;

namespace {

void compare_attributes(const ExrImage& a, const ExrImage& b, Ledger& ledger) {
    std::map<std::string, std::pair<std::optional<std::string>, std::optional<std::string>>> value_pairs;
    for (const auto& [name, value] : a.attributes) value_pairs[name].first = value;
    for (const auto& [name, value] : b.attributes) value_pairs[name].second = value;
    const auto quoted_text = [](const std::optional<std::string>& value) {
        return value ? escape_and_quote(*value) : std::string("(absent)");
    };

    for (const auto& entry : value_pairs) {
        const auto& [first_value, second_value] = entry.second;
        const bool is_about_run = entry.first == "lostbits:command" || entry.first == "lostbits:program" ||
                                  entry.first == "lostbits:compiler";
        if (is_about_run || first_value == second_value) continue;
        const std::string message =
            fmt::format("attribute {}: {} != {}", entry.first, quoted_text(first_value), quoted_text(second_value));
        ledger.add(0, [&message] { return message; });
    }
}

template <class Sample>
void compare_samples(const std::string& name, const std::vector<Sample>& a, const std::vector<Sample>& b,
                     std::size_t width, Ledger& ledger) {
    std::optional<std::pair<double, double>> tolerance;
    if (const Tolerance* t = tolerance_of(name, ledger.options))
        tolerance.emplace(t->absolute.to_double(), t->relative.to_double());
    ColumnDifference& column = ledger.result.columns.emplace_back();
    column.name = name;

    for (std::size_t i = 0; i < a.size(); ++i) {
        PairVerdict verdict;
        if constexpr (std::is_same_v<Sample, float>) verdict = judge_samples(a[i], b[i], tolerance);
        else verdict.differs = a[i] != b[i];
        const auto position = [&] { return fmt::format("{},{}", i % width, i / width); };
        if (!record_verdict(column, verdict, position)) continue;
        ledger.add(0, [&] {
            if constexpr (std::is_same_v<Sample, float>)
                return fmt::format("{} at {}: {} != {}{}", name, position(), file::decimal(a[i]), file::decimal(b[i]),
                                   distances_text(verdict));
            else return fmt::format("{} at {}: {} != {}", name, position(), a[i], b[i]);
        });
    }
}

/// Records different sizes. Returns true if the sizes are the same; only then can pixels be compared.
bool check_sizes(const auto& a, const auto& b, Ledger& ledger) {
    if (a.width == b.width && a.height == b.height) return true;
    ledger.add(0, [&] { return fmt::format("size: {}x{} != {}x{}", a.width, a.height, b.width, b.height); });
    return false;
}

/// Compares the channels of one name. Their samples are compared only if they have the same type and the pictures have
/// the same size.
void compare_channels(const ExrChannel& a, const ExrChannel& b, std::optional<std::size_t> common_width,
                      Ledger& ledger) {
    if (a.samples.index() != b.samples.index()) {
        const auto type = [](const ExrChannel& c) { return c.samples.index() == 0 ? "f32" : "u32"; };
        ledger.add(0, [&] { return fmt::format("channel {}: type {} != {}", a.name, type(a), type(b)); });
    } else if (common_width) {
        std::visit(
            [&]<class S>(const std::vector<S>& samples) {
                compare_samples(a.name, samples, std::get<std::vector<S>>(b.samples), *common_width, ledger);
            },
            a.samples);
    }
}

}  // namespace

Comparison compare(const ExrImage& a, const ExrImage& b, const CompareOptions& options) {
    Ledger ledger{options, {}};
    compare_attributes(a, b, ledger);
    const std::optional<std::size_t> common_width =
        check_sizes(a, b, ledger) ? std::optional(static_cast<std::size_t>(a.width)) : std::nullopt;

    // The channels of the first picture, and their partners in the second.
    for (const ExrChannel& channel : a.channels) {
        ledger.result.names.push_back(channel.name);
        if (is_ignored(ledger.options, channel.name)) continue;
        if (const ExrChannel* const second_channel = b.find(channel.name))
            compare_channels(channel, *second_channel, common_width, ledger);
        else ledger.add(0, [&] { return fmt::format("channel {} is missing in the second", channel.name); });
    }

    for (const ExrChannel& channel : b.channels) {
        if (a.find(channel.name) != nullptr) continue;
        ledger.result.names.push_back(channel.name);
        if (!is_ignored(ledger.options, channel.name))
            ledger.add(0, [&] { return fmt::format("channel {} is added in the second", channel.name); });
    }
    return ledger.result;
}

namespace {

/// Adds the result of comparing the two parts called `name`.
void add_part(const std::string& name, Comparison part, Ledger& ledger) {
    Comparison& result = ledger.result;
    const std::string prefix = name.empty() ? "" : name + ": ";
    for (Difference& d : part.differences) {
        if (result.differences.size() < ledger.options.max_listed)
            result.differences.push_back({d.line, prefix + d.text});
    }
    result.count += part.count;
    for (ColumnDifference& column : part.columns) {
        column.name = prefix + column.name;
        result.columns.push_back(std::move(column));
    }
    for (std::string& channel : part.names) {
        if (std::ranges::find(result.names, channel) == result.names.end()) result.names.push_back(std::move(channel));
    }
}

}  // namespace

Comparison compare_exr(const std::filesystem::path& a, const std::filesystem::path& b, const CompareOptions& options) {
    Ledger ledger{options, {}};
    const std::vector<std::string> first_parts = image::image_backend().exr_parts(a),
                                   second_parts = image::image_backend().exr_parts(b);
    const bool has_several_parts = first_parts.size() > 1 || second_parts.size() > 1;

    std::size_t next_index = 0;  // one past the index of the last matched part of the second file
    for (std::size_t p = 0; p < first_parts.size(); ++p) {
        const auto match = std::ranges::find(second_parts, first_parts[p]);
        if (has_several_parts && match == second_parts.end()) {
            ledger.add(0, [&] { return fmt::format("part {} is missing in the second", first_parts[p]); });
            continue;
        }
        const std::size_t second_index = has_several_parts ? static_cast<std::size_t>(match - second_parts.begin()) : 0;
        if (second_index < next_index)
            ledger.add(0, [&] { return fmt::format("part {} is moved in the second", first_parts[p]); });
        next_index = std::max(next_index, second_index + 1);

        // The first file is read first, so that an error names the first bad file.
        const ExrImage first_image = image::image_backend().read_exr(a, p);
        add_part(has_several_parts ? first_parts[p] : "",
                 compare(first_image, image::image_backend().read_exr(b, second_index), options), ledger);
    }

    for (const std::string& name : second_parts) {
        if (has_several_parts && std::ranges::find(first_parts, name) == first_parts.end())
            ledger.add(0, [&] { return fmt::format("part {} is added in the second", name); });
    }
    return ledger.result;
}

Comparison compare(const image::PngImage& a, const image::PngImage& b, const CompareOptions& options) {
    Ledger ledger{options, {}};
    if (!check_sizes(a, b, ledger)) return ledger.result;
    ColumnDifference& column = ledger.result.columns.emplace_back();
    column.name = "pixel";

    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const image::Rgb8 p = a.pixels[i], q = b.pixels[i];
        if (p == q) continue;

        const int largest_step = std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
        const auto width = static_cast<std::size_t>(a.width);
        const auto position = [&] { return fmt::format("{},{}", i % width, i / width); };
        record_verdict(column,
                       {.differs = true,
                        .has_distances = true,
                        .absolute = static_cast<double>(largest_step),
                        .relative = largest_step / 255.0},
                       position);
        ledger.add(0, [&] {
            return fmt::format("pixel at {}: {},{},{} != {},{},{}", position(), p.r, p.g, p.b, q.r, q.g, q.b);
        });
    }
    return ledger.result;
}

}  // namespace lostbits::output::diff
