#include "analysis/selection/ray_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "number/error.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/parse_number.hpp"
#include "scene/toml/round.hpp"
#include "shapes/given_matrix.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::analysis::selection {

namespace {

std::vector<std::string> split_at_commas(const std::string& text) {
    std::vector<std::string> parts{""};
    for (const char c : text) {
        if (c == ',') parts.emplace_back();
        else if (c != ' ') parts.back() += c;
    }
    return parts;
}

/// The exact number in the value of an option; nothing if it is above the largest binary64.
std::optional<Real> parse_exact_number(const std::string& text, const std::string& option) {
    const auto parsed = scene::toml::parse_number(text);
    const auto* const fault = std::get_if<scene::toml::NumberFault>(&parsed);
    if (fault && !fault->is_too_large) throw InputError(fmt::format("{}: \"{}\" {}", option, text, fault->why));
    if (fault) return {};
    return std::get<Real>(parsed);
}

}  // namespace

std::vector<Shape> PrimitiveOptions::shapes() const {
    std::vector<Shape> given;
    for (const ShapeRow& shape_row : shape_rows)
        if (!values_of(shape_row.shape).empty()) given.push_back(shape_row.shape);
    return given;
}

std::vector<std::pair<Shape, std::string>> PrimitiveOptions::in_given_order() const {
    std::vector<std::pair<Shape, std::string>> primitives;
    std::array<std::size_t, shape_rows.size()> next_index{};
    for (const std::size_t index : order_()) {
        const Shape shape = shape_rows[index].shape;
        primitives.emplace_back(shape, values_of(shape).at(next_index[index]++));
    }
    return primitives;
}

std::string PrimitiveOptions::names() const {
    std::vector<std::string> options;
    for (const Shape shape : shapes()) options.push_back(fmt::format("--{}", lostbits::name_of(shape)));
    return output::file::word_list(options);
}

std::vector<Real> parse_numbers(const std::string& text, const NumberOption& wanted,
                                const std::optional<Format>& format) {
    const char* const option = wanted.option;
    const FloatFormat parameters = format ? format->parameters : binary64;
    std::vector<Real> numbers;
    for (const std::string& part : split_at_commas(text)) {
        if (wanted.allows_special && (part == "nan" || part == "inf" || part == "-inf")) {
            numbers.emplace_back(part == "nan" ? std::nan("") : part == "inf" ? HUGE_VAL : -HUGE_VAL);
            continue;
        }

        const auto exact = parse_exact_number(part, option);
        const double rounded = exact ? scene::toml::round_to_format(*exact, parameters) : HUGE_VAL;
        if (!std::isfinite(rounded)) {
            const double largest = std::ldexp(2 - std::ldexp(1.0, 1 - parameters.precision), parameters.emax);
            throw InputError(
                fmt::format("{}: \"{}\" is out of range: the largest number of {} is {} ({}); scale the "
                            "ray and the primitives down",
                            option, part, format ? format->name : "binary64", output::file::decimal(largest),
                            output::file::hex(largest)));
        }
        numbers.push_back(format ? Real(rounded) : *exact);
    }
    if (numbers.size() != wanted.count)
        throw InputError(fmt::format("{} {}: is not {}", option, text, wanted.expected));
    return numbers;
}

double stored_number(const Real& x) {
    return isfinite(x) ? scene::toml::round_to_format(x, binary64) : static_cast<double>(x);
}

namespace {

Transform<double> parse_transform(const std::string& text, const char* option, const std::optional<Format>& format) {
    const bool is_inverse = text.starts_with('/');
    const auto exact_numbers =
        parse_numbers(text.substr(is_inverse ? 1 : 0),
                      {option,
                       "a matrix; write after the @ its three rows of four numbers, with commas between "
                       "them, and a / before the rows of a stored inverse",
                       Affine<double>::number_count},
                      format);
    std::array<double, Affine<double>::number_count> numbers;
    std::ranges::transform(exact_numbers, numbers.begin(), stored_number);
    const Transform<double> transform = transform_of(numbers, is_inverse);
    if (!transform.is_proper()) throw InputError(fmt::format("{} …@{}: the matrix {}", option, text, singular_reason));
    return transform;
}

}  // namespace

Primitive<double> parse_primitive(Shape shape, const std::string& text, const std::optional<Format>& format) {
    const std::size_t at_sign = std::min(text.find('@'), text.size());
    const std::string numbers_text = text.substr(0, at_sign), option = "--" + std::string(name_of(shape));
    Primitive<double> primitive(shape);
    const std::string expected =
        fmt::format("{}; write its {}: {}, {} numbers with commas between them", with_article(shape), key_phrase(shape),
                    option_placeholder(shape), primitive.shape_numbers().size());
    const auto exact_numbers =
        parse_numbers(numbers_text, {option.c_str(), expected.c_str(), primitive.shape_numbers().size()}, format);
    std::ranges::transform(exact_numbers, primitive.numbers.begin(), stored_number);
    if (at_sign < text.size()) primitive.transform = parse_transform(text.substr(at_sign + 1), option.c_str(), format);
    if (const auto broken = broken_limit(primitive))
        throw InputError(
            fmt::format("{} {}: {} {}", option, numbers_text, broken->key->name, limit_phrase(shape, *broken)));
    return primitive;
}

std::pair<int, int> parse_size(const std::string& text) {
    int width = 0, height = 0;
    const auto separator = text.find('x');
    const auto parse_int = [&text](std::size_t begin, std::size_t end, int& value) {
        const auto [stop, error] = std::from_chars(text.data() + begin, text.data() + end, value);
        return error == std::errc{} && stop == text.data() + end;
    };
    if (separator == std::string::npos || !parse_int(0, separator, width) ||
        !parse_int(separator + 1, text.size(), height)) {
        throw InputError(fmt::format("--size {}: is not a size; write width and height in pixels, like 512x384", text));
    }
    return {width, height};
}

std::pair<int, int> parse_pixel(const std::string& text) {
    std::vector<double> indices;
    for (const std::string& part : split_at_commas(text)) {
        const auto parsed = parse_exact_number(part, "--pixel");
        indices.push_back(parsed ? static_cast<double>(*parsed) : HUGE_VAL);
    }
    constexpr double max_index = 1e9;  // more than any picture has, less than an int
    if (indices.size() != 2 ||
        std::ranges::any_of(indices, [](double v) { return v != std::floor(v) || std::fabs(v) > max_index; }))
        throw InputError("--pixel " + text + ": is not a pixel; write its column and row, like 17,42");
    return {static_cast<int>(indices[0]), static_cast<int>(indices[1])};
}

namespace {

struct Unit {
    std::string_view name;
    double micrometres;
};
constexpr std::array units{Unit{"m", 1e6},  Unit{"km", 1e9},   Unit{"cm", 1e4},   Unit{"mm", 1e3},
                           Unit{"um", 1.0}, Unit{"in", 25400}, Unit{"ft", 304800}};

const Unit* find_unit(std::string_view name) {
    const auto found = std::ranges::find(units, name, &Unit::name);
    return found == units.end() ? nullptr : &*found;
}

}  // namespace

double tolerance_in_units(const std::string& text, const std::string& unit) {
    const Unit* const scene_unit = find_unit(unit);
    if (!unit.empty() && scene_unit == nullptr)
        throw InputError(fmt::format("--unit {}: is not a unit of length; write m, km, cm, mm, um, in or ft", unit));

    double length = 0;
    const char* const end = text.data() + text.size();
    const char* const unit_text = std::from_chars(text.data(), end, length).ptr;
    const std::string_view text_unit(unit_text, static_cast<std::size_t>(end - unit_text));
    if (unit_text == text.data() || !(length >= 0) || !std::isfinite(length) ||
        (!text_unit.empty() && !find_unit(text_unit)))
        throw InputError(fmt::format(
            "--tolerance {}: is not a length; write a number of at least 0 in the scene's unit of length, such as "
            "0.001, or with --unit a length such as 1mm",
            text));

    // A length with a unit is converted to the unit of the scene.
    if (text_unit.empty()) return length;
    if (scene_unit == nullptr)
        throw InputError(fmt::format(
            "--tolerance {}: scenes and files of rays do not say what their unit of length is; write a number without "
            "a unit, or name the unit of the scene, as in --unit m",
            text));
    return length * find_unit(text_unit)->micrometres / scene_unit->micrometres;
}

}  // namespace lostbits::analysis::selection
