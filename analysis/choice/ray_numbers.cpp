#include "analysis/choice/ray_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "number/error.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/parse_number.hpp"
#include "scene/toml/round.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::analysis::choice {

namespace {

std::vector<std::string> parts_of(const std::string& text) {
    std::vector<std::string> parts{""};
    for (const char c : text) {
        if (c == ',') parts.emplace_back();
        else if (c != ' ') parts.back() += c;
    }
    return parts;
}

/// The number that a word of an option stands for, exactly; nothing where it is above every number there is.
std::optional<Real> number_of(const std::string& text, const std::string& option) {
    const auto read = scene::toml::parse_number(text);
    const auto* const fault = std::get_if<scene::toml::NumberFault>(&read);
    if (fault && !fault->too_large) throw InputError(fmt::format("{}: \"{}\" {}", option, text, fault->why));
    if (fault) return {};
    return std::get<Real>(read);
}

}  // namespace

std::vector<Shape> SolidWords::shapes() const {
    std::vector<Shape> given;
    for (const ShapeRow& row : shape_rows)
        if (!of(row.shape).empty()) given.push_back(row.shape);
    return given;
}

std::string solid_options(bool numbers, const char* between) {
    std::string options;
    for (const ShapeRow& row : shape_rows) {
        options += fmt::format("{}--{}", options.empty() ? "" : between, row.name);
        if (numbers) options += ' ' + option_words(row.shape);
    }
    return options;
}

std::vector<Real> numbers_of(const std::string& text, const WantedNumbers& wanted, const std::optional<Format>& as) {
    const char* const option = wanted.option;
    const FloatFormat shape = as ? as->shape : binary64;
    std::vector<Real> numbers;
    for (const std::string& part : parts_of(text)) {
        if (wanted.special && (part == "nan" || part == "inf" || part == "-inf")) {
            numbers.emplace_back(part == "nan" ? std::nan("") : part == "inf" ? HUGE_VAL : -HUGE_VAL);
            continue;
        }
        const auto exact = number_of(part, option);
        const double rounded = exact ? scene::toml::round_to_format(*exact, shape) : HUGE_VAL;
        if (!std::isfinite(rounded)) {
            const double largest = std::ldexp(2 - std::ldexp(1.0, 1 - shape.precision), shape.emax);
            throw InputError(fmt::format(
                "{}: \"{}\" is out of range: the largest number of {} is {} ({}); scale the "
                "ray and what it is aimed at down",
                option, part, as ? as->name : "binary64", output::file::decimal(largest), output::file::hex(largest)));
        }
        numbers.push_back(as ? Real(rounded) : *exact);
    }
    if (numbers.size() != wanted.count) throw InputError(fmt::format("{} {}: is not {}", option, text, wanted.what));
    return numbers;
}

std::pair<int, int> pixel_named(const std::string& text) {
    std::vector<double> x;
    for (const std::string& part : parts_of(text)) {
        const auto read = number_of(part, "--pixel");
        x.push_back(read ? static_cast<double>(*read) : HUGE_VAL);
    }
    constexpr double most = 1e9;  // more than any picture has, less than an int
    if (x.size() != 2 || std::ranges::any_of(x, [](double v) { return v != std::floor(v) || std::fabs(v) > most; }))
        throw InputError("--pixel " + text + ": is not a pixel; write its column and row, like 17,42");
    return {static_cast<int>(x[0]), static_cast<int>(x[1])};
}

}  // namespace lostbits::analysis::choice
