#include "output/diff/difference.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "number/error.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::diff {

using file::CellValue;
using file::CsvColumn;
using file::CsvTable;
using image::ExrChannel;
using image::ExrImage;

namespace {

using Kind = CellValue::Kind;

/// n · 10^exponent. Decimals and their differences and products are exact in it, so 0.4 and 0.3 are within 0.1.
struct Exact {
    boost::multiprecision::cpp_int n;
    int exponent = 0;

    explicit Exact(const CellValue& v) : n(v.digits.empty() ? "0" : v.digits), exponent(v.exponent) {
        if (v.negative) n = -n;
    }
    Exact(boost::multiprecision::cpp_int digits, int power) : n(std::move(digits)), exponent(power) {}

    [[nodiscard]] boost::multiprecision::cpp_int at(int power) const {
        return n *
               boost::multiprecision::pow(boost::multiprecision::cpp_int(10), static_cast<unsigned>(exponent - power));
    }
    [[nodiscard]] double approximate(int shift = 0) const {
        return std::strtod((n.str() + "e" + std::to_string(exponent - shift)).c_str(), nullptr);
    }
};

Exact distance(const Exact& a, const Exact& b) {
    const int power = std::min(a.exponent, b.exponent);
    return {abs(a.at(power) - b.at(power)), power};
}

bool at_most(const Exact& a, const Exact& b) {
    const int power = std::min(a.exponent, b.exponent);
    return a.at(power) <= b.at(power);
}

const Tolerance* tolerance_of(const std::string& name, const CompareOptions& options) {
    const auto found = std::find_if(options.tolerances.rbegin(), options.tolerances.rend(),
                                    [&](const Tolerance& t) { return names_column(t.column, name); });
    return found == options.tolerances.rend() ? nullptr : &*found;
}

bool ignores(const CompareOptions& options, const std::string& name) {
    return std::ranges::any_of(options.ignored,
                               [&](const std::string& pattern) { return names_column(pattern, name); });
}

/// What two cells or samples that are not the same have to do with each other.
struct Verdict {
    bool differs = false;
    bool kinds = false;     ///< they are not both finite numbers
    bool measured = false;  ///< they are, and these are their distances
    double absolute = 0, relative = 0;
};

Verdict judge_cells(std::string_view a, std::string_view b, const Tolerance* tolerance, bool as_text) {
    const CellValue x = file::read_cell(a), y = file::read_cell(b);
    if (x.kind != Kind::number || y.kind != Kind::number) {
        const bool both_text = x.kind == Kind::text && y.kind == Kind::text;
        return {.differs = !(x == y), .kinds = !both_text};
    }
    const Exact p(x), q(y), apart = distance(p, q);
    const Exact larger = at_most({abs(p.n), p.exponent}, {abs(q.n), q.exponent}) ? Exact(abs(q.n), q.exponent)
                                                                                 : Exact(abs(p.n), p.exponent);
    Verdict v{.measured = true, .absolute = apart.approximate()};
    if (larger.n != 0) {
        // Scaled to the larger, so that neither leaves the range of a double.
        const int magnitude = larger.exponent + static_cast<int>(larger.n.str().size());
        v.relative = apart.approximate(magnitude) / larger.approximate(magnitude);
    }
    if (tolerance == nullptr) {
        v.differs = as_text || !(x == y);
        return v;
    }
    const Exact relative(tolerance->relative);
    v.differs = !at_most(apart, Exact(tolerance->absolute)) &&
                !at_most(apart, {relative.n * larger.n, relative.exponent + larger.exponent});
    return v;
}

Verdict judge_samples(float a, float b, const std::optional<std::pair<double, double>>& tolerance) {
    if (std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (std::isnan(a) && std::isnan(b)))
        return {};
    if (!std::isfinite(a) || !std::isfinite(b)) return {.differs = true, .kinds = true};
    const double x = a, y = b, apart = std::fabs(x - y), larger = std::max(std::fabs(x), std::fabs(y));
    const bool tolerated = tolerance && (apart <= tolerance->first || apart <= tolerance->second * larger);
    return {.differs = !tolerated, .measured = true, .absolute = apart, .relative = larger == 0 ? 0 : apart / larger};
}

/// Text in a message: in quotes, and whatever would break the line or the terminal escaped.
std::string in_quotes(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '\n') out += "\\n";
        else if (c == '\r') out += "\\r";
        else if (static_cast<unsigned char>(c) < ' ' || c == 0x7F)
            out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
        else if (c == '"' || c == '\\') out += {'\\', c};
        else out += c;
    }
    return out + '"';
}

std::string shown(std::string_view cell) {
    const Kind kind = file::read_cell(cell).kind;
    return kind == Kind::missing ? "(empty)" : kind == Kind::text ? in_quotes(cell) : std::string(cell);
}

void add(Comparison& result, const CompareOptions& options, std::size_t line, const auto& make_text) {
    if (result.count++ < options.most) result.differences.push_back({line, make_text()});
}

/// Books a verdict under its column; says whether it is a difference.
bool book(ColumnDifference& column, const Verdict& v, const auto& make_place) {
    column.count += v.differs;
    column.kinds += v.differs && v.kinds;
    const auto raise = [&](Largest& largest, double value) {
        if (largest.at.empty() || value > largest.value) largest = {value, make_place()};
    };
    if (v.measured && (v.differs || v.absolute > 0)) {
        raise(column.absolute, v.absolute);
        raise(column.relative, v.relative);
    }
    return v.differs;
}

std::string distances(const Verdict& v) {
    return v.measured ? fmt::format(" (abs {:.4g}, rel {:.4g})", v.absolute, v.relative) : "";
}

/// For each of a list of distinct numbers, whether it is in one longest increasing subsequence: the others are the
/// fewest that have to move to put the list in order.
std::vector<bool> in_order(const std::vector<std::size_t>& list) {
    std::vector<std::size_t> length(list.size(), 1), before(list.size());
    std::size_t best = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
        before[i] = i;
        for (std::size_t j = 0; j < i; ++j) {
            if (list[j] < list[i] && length[j] + 1 > length[i]) length[i] = length[j] + 1, before[i] = j;
        }
        if (length[i] > length[best]) best = i;
    }
    std::vector<bool> in(list.size());
    for (std::size_t i = best; !list.empty() && !in[i]; i = before[i]) in[i] = true;
    return in;
}

/// A column of both tables.
struct Pair {
    const CsvColumn *a, *b;
    const Tolerance* tolerance;
    bool as_text;
};

/// Books what the headers differ in and returns the columns of both, in the first's order.
std::vector<Pair> match_headers(const CsvTable& a, const CsvTable& b, const CompareOptions& options,
                                Comparison& result) {
    std::vector<Pair> pairs;
    std::vector<std::size_t> places;
    for (const CsvColumn& column : a.columns) {
        result.names.push_back(column.name);
        if (ignores(options, column.name)) continue;
        const CsvColumn* other = b.find(column.name);
        if (other == nullptr) {
            add(result, options, 1, [&] { return fmt::format("column {} is missing in the second", column.name); });
            continue;
        }
        const Tolerance* tolerance = tolerance_of(column.name, options);
        pairs.push_back({&column, other, tolerance, tolerance == nullptr && column.name.ends_with("_hex")});
        places.push_back(static_cast<std::size_t>(other - b.columns.data()));
    }
    for (const CsvColumn& column : b.columns) {
        if (a.find(column.name) != nullptr) continue;
        result.names.push_back(column.name);
        if (!ignores(options, column.name))
            add(result, options, 1, [&] { return fmt::format("column {} is added in the second", column.name); });
    }
    const auto stays = in_order(places);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (stays[i]) continue;
        const auto place = pairs[i].a - a.columns.data() + 1;
        add(result, options, 1, [&] {
            return fmt::format("column {} moved from place {} to place {}", pairs[i].a->name, place, places[i] + 1);
        });
    }
    return pairs;
}

void compare_attributes(const ExrImage& a, const ExrImage& b, const CompareOptions& options, Comparison& result) {
    std::map<std::string, std::pair<std::optional<std::string>, std::optional<std::string>>> both;
    for (const auto& [name, value] : a.attributes) both[name].first = value;
    for (const auto& [name, value] : b.attributes) both[name].second = value;
    const auto text = [](const std::optional<std::string>& value) {
        return value ? in_quotes(*value) : std::string("(absent)");
    };
    for (const auto& entry : both) {
        const auto& [left, right] = entry.second;
        if (entry.first == "lostbits:command" || entry.first == "lostbits:compiler" || left == right) continue;
        const std::string what = fmt::format("attribute {}: {} != {}", entry.first, text(left), text(right));
        add(result, options, 0, [&what] { return what; });
    }
}

template <class Sample>
void compare_samples(const std::string& name, const std::vector<Sample>& a, const std::vector<Sample>& b,
                     std::size_t width, const CompareOptions& options, Comparison& result) {
    std::optional<std::pair<double, double>> within;
    if (const Tolerance* t = tolerance_of(name, options))
        within.emplace(t->absolute.approximate(), t->relative.approximate());
    ColumnDifference& column = result.columns.emplace_back();
    column.name = name;
    for (std::size_t i = 0; i < a.size(); ++i) {
        Verdict v;
        if constexpr (std::is_same_v<Sample, float>) v = judge_samples(a[i], b[i], within);
        else v.differs = a[i] != b[i];
        const auto place = [&] { return fmt::format("{},{}", i % width, i / width); };
        if (!book(column, v, place)) continue;
        add(result, options, 0, [&] {
            if constexpr (std::is_same_v<Sample, float>)
                return fmt::format("{} at {}: {} != {}{}", name, place(), file::decimal(a[i]), file::decimal(b[i]),
                                   distances(v));
            else return fmt::format("{} at {}: {} != {}", name, place(), a[i], b[i]);
        });
    }
}

/// Books another size; pixels of different sizes have nothing to be compared with.
bool same_size(const auto& a, const auto& b, const CompareOptions& options, Comparison& result) {
    if (a.width == b.width && a.height == b.height) return true;
    add(result, options, 0, [&] { return fmt::format("size: {}x{} != {}x{}", a.width, a.height, b.width, b.height); });
    return false;
}

}  // namespace

Tolerance parse_tolerance(const std::string& text) {
    const auto equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0) {
        throw InputError(fmt::format(
            "--tolerance {}: is not a tolerance; write COLUMN=ABS or COLUMN=ABS,REL, as in lost_bits=0.5", text));
    }
    const std::string numbers = text.substr(equals + 1);
    const auto comma = numbers.find(',');
    const auto read = [&text](const std::string& word) {
        const CellValue value = file::read_cell(word);
        if (value.kind == Kind::number && !value.negative) return value;
        throw InputError(fmt::format(
            "--tolerance {}: \"{}\" is not a finite number of at least 0; write one, or use --ignore for the column",
            text, word));
    };
    return {text.substr(0, equals), read(numbers.substr(0, comma)),
            comma == std::string::npos ? read("0") : read(numbers.substr(comma + 1))};
}

bool names_column(const std::string& pattern, const std::string& name) {
    return pattern == name || fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

Comparison compare(const CsvTable& a, const CsvTable& b, const CompareOptions& options) {
    Comparison result;
    const auto pairs = match_headers(a, b, options, result);
    const std::size_t rows = std::min(a.rows(), b.rows());
    for (const Pair& p : pairs) result.columns.emplace_back().name = p.a->name;
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < pairs.size(); ++c) {
            const std::string_view left = pairs[c].a->cells[r], right = pairs[c].b->cells[r];
            if (left == right) continue;
            const Verdict v = judge_cells(left, right, pairs[c].tolerance, pairs[c].as_text);
            if (!book(result.columns[c], v, [&] { return fmt::format("line {}", a.lines[r]); })) continue;
            add(result, options, a.lines[r], [&] {
                return fmt::format("{}: {} != {}{}", pairs[c].a->name, shown(left), shown(right), distances(v));
            });
        }
    }
    if (a.rows() != b.rows())
        add(result, options, 0,
            [&] { return fmt::format("rows: {} != {}; the first {} are compared", a.rows(), b.rows(), rows); });
    return result;
}

Comparison compare(const ExrImage& a, const ExrImage& b, const CompareOptions& options) {
    Comparison result;
    compare_attributes(a, b, options, result);
    const bool comparable = same_size(a, b, options, result);
    for (const ExrChannel& channel : a.channels) {
        result.names.push_back(channel.name);
        if (ignores(options, channel.name)) continue;
        const ExrChannel* other = b.find(channel.name);
        if (other == nullptr) {
            add(result, options, 0, [&] { return fmt::format("channel {} is missing in the second", channel.name); });
        } else if (channel.samples.index() != other->samples.index()) {
            const auto type = [](const ExrChannel& c) { return c.samples.index() == 0 ? "f32" : "u32"; };
            add(result, options, 0,
                [&] { return fmt::format("channel {}: type {} != {}", channel.name, type(channel), type(*other)); });
        } else if (comparable) {
            std::visit(
                [&]<class S>(const std::vector<S>& samples) {
                    compare_samples(channel.name, samples, std::get<std::vector<S>>(other->samples),
                                    static_cast<std::size_t>(a.width), options, result);
                },
                channel.samples);
        }
    }
    for (const ExrChannel& channel : b.channels) {
        if (a.find(channel.name) != nullptr) continue;
        result.names.push_back(channel.name);
        if (!ignores(options, channel.name))
            add(result, options, 0, [&] { return fmt::format("channel {} is added in the second", channel.name); });
    }
    return result;
}

Comparison compare(const image::PngImage& a, const image::PngImage& b, const CompareOptions& options) {
    Comparison result;
    if (!same_size(a, b, options, result)) return result;
    ColumnDifference& column = result.columns.emplace_back();
    column.name = "pixel";
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const image::Rgb8 p = a.pixels[i], q = b.pixels[i];
        if (p == q) continue;
        const int steps = std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
        const auto width = static_cast<std::size_t>(a.width);
        const auto place = [&] { return fmt::format("{},{}", i % width, i / width); };
        book(column,
             {.differs = true, .measured = true, .absolute = static_cast<double>(steps), .relative = steps / 255.0},
             place);
        add(result, options, 0,
            [&] { return fmt::format("pixel at {}: {},{},{} != {},{},{}", place(), p.r, p.g, p.b, q.r, q.g, q.b); });
    }
    return result;
}

Comparison compare_bytes(std::string_view a, std::string_view b) {
    Comparison result;
    if (a == b) return result;
    const auto at = std::ranges::mismatch(a, b).in1 - a.begin();
    const auto line = static_cast<std::size_t>(std::count(a.begin(), a.begin() + at, '\n')) + 1;
    add(result, {}, line,
        [&] { return fmt::format("bytes differ from byte {} on; {} != {} bytes in all", at, a.size(), b.size()); });
    return result;
}

}  // namespace lostbits::output::diff
