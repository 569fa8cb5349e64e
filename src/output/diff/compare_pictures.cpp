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
    std::map<std::string, std::pair<std::optional<std::string>, std::optional<std::string>>> both;
    for (const auto& [name, value] : a.attributes) both[name].first = value;
    for (const auto& [name, value] : b.attributes) both[name].second = value;
    const auto text = [](const std::optional<std::string>& value) {
        return value ? in_quotes(*value) : std::string("(absent)");
    };
    for (const auto& entry : both) {
        const auto& [left, right] = entry.second;
        const bool of_the_run = entry.first == "lostbits:command" || entry.first == "lostbits:program" ||
                                entry.first == "lostbits:compiler";
        if (of_the_run || left == right) continue;
        const std::string what = fmt::format("attribute {}: {} != {}", entry.first, text(left), text(right));
        ledger.add(0, [&what] { return what; });
    }
}

template <class Sample>
void compare_samples(const std::string& name, const std::vector<Sample>& a, const std::vector<Sample>& b,
                     std::size_t width, Ledger& ledger) {
    std::optional<std::pair<double, double>> within;
    if (const Tolerance* t = tolerance_of(name, ledger.options))
        within.emplace(t->absolute.approximate(), t->relative.approximate());
    ColumnDifference& column = ledger.result.columns.emplace_back();
    column.name = name;
    for (std::size_t i = 0; i < a.size(); ++i) {
        PairVerdict v;
        if constexpr (std::is_same_v<Sample, float>) v = judge_samples(a[i], b[i], within);
        else v.differs = a[i] != b[i];
        const auto place = [&] { return fmt::format("{},{}", i % width, i / width); };
        if (!record_verdict(column, v, place)) continue;
        ledger.add(0, [&] {
            if constexpr (std::is_same_v<Sample, float>)
                return fmt::format("{} at {}: {} != {}{}", name, place(), file::decimal(a[i]), file::decimal(b[i]),
                                   distances(v));
            else return fmt::format("{} at {}: {} != {}", name, place(), a[i], b[i]);
        });
    }
}

/// Records different sizes and returns false; pixels of different sizes cannot be compared.
bool same_size(const auto& a, const auto& b, Ledger& ledger) {
    if (a.width == b.width && a.height == b.height) return true;
    ledger.add(0, [&] { return fmt::format("size: {}x{} != {}x{}", a.width, a.height, b.width, b.height); });
    return false;
}

}  // namespace

Comparison compare(const ExrImage& a, const ExrImage& b, const CompareOptions& options) {
    Ledger ledger{options, {}};
    compare_attributes(a, b, ledger);
    const bool comparable = same_size(a, b, ledger);
    for (const ExrChannel& channel : a.channels) {
        ledger.result.names.push_back(channel.name);
        if (ignores(ledger.options, channel.name)) continue;
        const ExrChannel* other = b.find(channel.name);
        if (other == nullptr) {
            ledger.add(0, [&] { return fmt::format("channel {} is missing in the second", channel.name); });
        } else if (channel.samples.index() != other->samples.index()) {
            const auto type = [](const ExrChannel& c) { return c.samples.index() == 0 ? "f32" : "u32"; };
            ledger.add(
                0, [&] { return fmt::format("channel {}: type {} != {}", channel.name, type(channel), type(*other)); });
        } else if (comparable) {
            std::visit(
                [&]<class S>(const std::vector<S>& samples) {
                    compare_samples(channel.name, samples, std::get<std::vector<S>>(other->samples),
                                    static_cast<std::size_t>(a.width), ledger);
                },
                channel.samples);
        }
    }
    for (const ExrChannel& channel : b.channels) {
        if (a.find(channel.name) != nullptr) continue;
        ledger.result.names.push_back(channel.name);
        if (!ignores(ledger.options, channel.name))
            ledger.add(0, [&] { return fmt::format("channel {} is added in the second", channel.name); });
    }
    return ledger.result;
}

namespace {

/// Adds the result of comparing two parts of that name.
void add_part(const std::string& name, Comparison part, Ledger& ledger) {
    Comparison& all = ledger.result;
    const std::string before = name.empty() ? "" : name + ": ";
    for (Difference& d : part.differences) {
        if (all.differences.size() < ledger.options.most) all.differences.push_back({d.line, before + d.what});
    }
    all.count += part.count;
    for (ColumnDifference& column : part.columns) {
        column.name = before + column.name;
        all.columns.push_back(std::move(column));
    }
    for (std::string& channel : part.names) {
        if (std::ranges::find(all.names, channel) == all.names.end()) all.names.push_back(std::move(channel));
    }
}

}  // namespace

Comparison compare_exr(const std::filesystem::path& a, const std::filesystem::path& b, const CompareOptions& options) {
    Ledger ledger{options, {}};
    const std::vector<std::string> left = image::image_backend().exr_parts(a),
                                   right = image::image_backend().exr_parts(b);
    const bool several = left.size() > 1 || right.size() > 1;
    std::size_t after = 0;  // one past the index of the part of the second file that was matched last
    for (std::size_t p = 0; p < left.size(); ++p) {
        const auto found = std::ranges::find(right, left[p]);
        if (several && found == right.end()) {
            ledger.add(0, [&] { return fmt::format("part {} is missing in the second", left[p]); });
            continue;
        }
        const std::size_t q = several ? static_cast<std::size_t>(found - right.begin()) : 0;
        if (q < after) ledger.add(0, [&] { return fmt::format("part {} is moved in the second", left[p]); });
        after = std::max(after, q + 1);
        const ExrImage first =
            image::image_backend().read_exr(a, p);  // so that the first bad file is the one that is named
        add_part(several ? left[p] : "", compare(first, image::image_backend().read_exr(b, q), options), ledger);
    }
    for (const std::string& name : right) {
        if (several && std::ranges::find(left, name) == left.end())
            ledger.add(0, [&] { return fmt::format("part {} is added in the second", name); });
    }
    return ledger.result;
}

Comparison compare(const image::PngImage& a, const image::PngImage& b, const CompareOptions& options) {
    Ledger ledger{options, {}};
    if (!same_size(a, b, ledger)) return ledger.result;
    ColumnDifference& column = ledger.result.columns.emplace_back();
    column.name = "pixel";
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const image::Rgb8 p = a.pixels[i], q = b.pixels[i];
        if (p == q) continue;
        const int steps = std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
        const auto width = static_cast<std::size_t>(a.width);
        const auto place = [&] { return fmt::format("{},{}", i % width, i / width); };
        record_verdict(
            column,
            {.differs = true, .measured = true, .absolute = static_cast<double>(steps), .relative = steps / 255.0},
            place);
        ledger.add(
            0, [&] { return fmt::format("pixel at {}: {},{},{} != {},{},{}", place(), p.r, p.g, p.b, q.r, q.g, q.b); });
    }
    return ledger.result;
}

}  // namespace lostbits::output::diff
