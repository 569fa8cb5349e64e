// Comparison of two values, exactly and with tolerances, and the texts of the differences.
#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <optional>

#include "number/error.hpp"
#include "output/diff/ledger.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::diff {

using file::CellValue;

Tolerance parse_tolerance(const std::string& text) {
    const auto equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0) {
        throw InputError(fmt::format(
            "--allow {}: is not a tolerance; write COLUMN=ABS or COLUMN=ABS,REL, as in lost_bits=0.5", text));
    }
    const std::string numbers = text.substr(equals + 1);
    const auto comma = numbers.find(',');
    const auto parse_bound = [&text](const std::string& part) {
        const CellValue value = file::read_cell(part);
        if (value.kind == CellValue::Kind::number && !value.is_negative) return value;
        throw InputError(
            fmt::format("--allow {}: \"{}\" is not a finite number of at least 0; write such a number, or leave "
                        "the column out with --ignore",
                        text, part));
    };
    return {text.substr(0, equals), parse_bound(numbers.substr(0, comma)),
            comma == std::string::npos ? parse_bound("0") : parse_bound(numbers.substr(comma + 1))};
}

bool names_column(const std::string& pattern, const std::string& name) {
    return pattern == name || fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

Comparison compare_bytes(std::string_view a, std::string_view b) {
    Comparison result;
    if (a == b) return result;
    const auto offset = std::ranges::mismatch(a, b).in1 - a.begin();
    const auto line = static_cast<std::size_t>(std::count(a.begin(), a.begin() + offset, '\n')) + 1;
    result.count = 1;
    const std::string sizes = a.size() == b.size() ? "" : fmt::format("; {} != {} bytes in total", a.size(), b.size());
    result.differences.push_back({line, fmt::format("bytes differ from byte {} on{}", offset, sizes)});
    return result;
}

namespace {

using Kind = CellValue::Kind;

/// significand · 10^exponent. Decimals and their differences and products are exact in this form, so 0.4 and 0.3 are
/// within 0.1.
struct ExactDecimal {
    boost::multiprecision::cpp_int significand;
    int exponent = 0;

    explicit ExactDecimal(const CellValue& value)
        : significand(value.digits.empty() ? "0" : value.digits), exponent(value.exponent) {
        if (value.is_negative) significand = -significand;
    }
    ExactDecimal(boost::multiprecision::cpp_int digits, int power) : significand(std::move(digits)), exponent(power) {}

    [[nodiscard]] boost::multiprecision::cpp_int scaled_to(int power) const {
        return significand *
               boost::multiprecision::pow(boost::multiprecision::cpp_int(10), static_cast<unsigned>(exponent - power));
    }
    [[nodiscard]] double approximate(int shift = 0) const {
        const double absolute =
            file::nearest_double(boost::multiprecision::cpp_int(abs(significand)).str(), exponent - shift);
        return significand < 0 ? -absolute : absolute;
    }
};

ExactDecimal distance(const ExactDecimal& a, const ExactDecimal& b) {
    const int power = std::min(a.exponent, b.exponent);
    return {abs(a.scaled_to(power) - b.scaled_to(power)), power};
}

bool is_at_most(const ExactDecimal& a, const ExactDecimal& b) {
    const int power = std::min(a.exponent, b.exponent);
    return a.scaled_to(power) <= b.scaled_to(power);
}

/// m with 10^(m − 1) <= |v| < 10^m, for a number other than zero.
int magnitude(const CellValue& value) { return value.exponent + static_cast<int>(value.digits.size()); }

/// Judges two numbers of very different size: one is zero, or less than 10^-40 of the other. |a − b| is then the
/// larger number to 40 digits. Returns nothing for other numbers, and if the tolerance is close to the larger number:
/// those pairs need the exact computation, which for `1e9999` and `1e-9999` would take 20 000 digits.
std::optional<PairVerdict> judge_distant_magnitudes(const CellValue& x, const CellValue& y,
                                                    const Tolerance* tolerance) {
    constexpr int max_gap = 40;
    if (x.digits.empty() && y.digits.empty()) return {};
    const bool has_zero = x.digits.empty() || y.digits.empty();
    if (!has_zero && std::abs(magnitude(x) - magnitude(y)) <= max_gap) return {};

    // Without a tolerance the two differ.
    const CellValue& larger = y.digits.empty() || (!x.digits.empty() && magnitude(x) > magnitude(y)) ? x : y;
    PairVerdict verdict{
        .differs = true, .has_distances = true, .absolute = std::fabs(larger.to_double()), .relative = 1};
    if (tolerance == nullptr) return verdict;

    const CellValue& absolute = tolerance->absolute;
    const double relative = tolerance->relative.to_double();
    // With the magnitude m of the larger number, |a − b| lies between 10^(m − 2) and 10^(m + 1).
    const bool is_tolerance_below = absolute.digits.empty() || magnitude(absolute) <= magnitude(larger) - 2;
    const bool is_tolerance_above = !absolute.digits.empty() && magnitude(absolute) >= magnitude(larger) + 2;
    if (!is_tolerance_above && relative < 2 && !(is_tolerance_below && relative < 0.5)) return {};
    verdict.differs = is_tolerance_below && relative < 0.5;
    return verdict;
}

}  // namespace

PairVerdict judge_cells(std::string_view a, std::string_view b, const Tolerance* tolerance, bool as_text) {
    const CellValue x = file::read_cell(a), y = file::read_cell(b);
    if (x.kind != Kind::number || y.kind != Kind::number) {
        const bool both_text = x.kind == Kind::text && y.kind == Kind::text;
        return {.differs = !(x == y), .is_not_finite = !both_text};
    }
    if (const auto verdict = judge_distant_magnitudes(x, y, tolerance)) return *verdict;

    // The distance, and the number with the larger magnitude.
    const ExactDecimal exact_a(x), exact_b(y), difference = distance(exact_a, exact_b);
    const bool first_is_larger =
        is_at_most({abs(exact_b.significand), exact_b.exponent}, {abs(exact_a.significand), exact_a.exponent});
    const ExactDecimal larger = first_is_larger ? ExactDecimal(abs(exact_a.significand), exact_a.exponent)
                                                : ExactDecimal(abs(exact_b.significand), exact_b.exponent);

    PairVerdict verdict{.has_distances = true, .absolute = difference.approximate()};
    if (larger.significand != 0) {
        // Both are scaled to the larger number, so that neither leaves the range of a double.
        const int exponent = magnitude(first_is_larger ? x : y);
        verdict.relative = difference.approximate(exponent) / larger.approximate(exponent);
    }

    if (tolerance == nullptr) {
        verdict.differs = as_text || !(x == y);
        return verdict;
    }

    const ExactDecimal relative(tolerance->relative);
    verdict.differs =
        !is_at_most(difference, ExactDecimal(tolerance->absolute)) &&
        !is_at_most(difference, {relative.significand * larger.significand, relative.exponent + larger.exponent});
    return verdict;
}

double cell_number(std::string_view cell) {
    const CellValue value = file::read_cell(cell);
    return value.kind == Kind::number ? ExactDecimal(value).approximate() : std::nan("");
}

PairVerdict judge_samples(float a, float b, const std::optional<std::pair<double, double>>& tolerance) {
    if (std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (std::isnan(a) && std::isnan(b)))
        return {};
    if (!std::isfinite(a) || !std::isfinite(b)) return {.differs = true, .is_not_finite = true};
    const double x = a, y = b, difference = std::fabs(x - y), larger = std::max(std::fabs(x), std::fabs(y));
    const bool is_tolerated = tolerance && (difference <= tolerance->first || difference <= tolerance->second * larger);
    return {.differs = !is_tolerated,
            .has_distances = true,
            .absolute = difference,
            .relative = larger == 0 ? 0 : difference / larger};
}

std::string distances_text(const PairVerdict& verdict) {
    return verdict.has_distances ? fmt::format(" (abs {:.4g}, rel {:.4g})", verdict.absolute, verdict.relative) : "";
}

const Tolerance* tolerance_of(const std::string& name, const CompareOptions& options) {
    const auto found = std::find_if(options.tolerances.rbegin(), options.tolerances.rend(),
                                    [&](const Tolerance& t) { return names_column(t.column, name); });
    return found == options.tolerances.rend() ? nullptr : &*found;
}

bool is_ignored(const CompareOptions& options, const std::string& name) {
    return std::ranges::any_of(options.ignored,
                               [&](const std::string& pattern) { return names_column(pattern, name); });
}

std::string escape_and_quote(std::string_view text) {
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

}  // namespace lostbits::output::diff
