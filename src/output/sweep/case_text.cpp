#include "output/sweep/case_text.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>

#include "output/file/number_text.hpp"

namespace lostbits::output::sweep {

namespace {

std::string hex_list(std::span<const double> x) {
    std::string text;
    for (const double number : x) text += (text.empty() ? "\"" : ", \"") + file::hex(number) + "\"";
    return "[" + text + "]";
}

/// A TOML basic string: a title may hold quotes.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (static_cast<unsigned char>(c) < 0x20) out += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
        else out += c;
    }
    return out + '"';
}

std::string solid_text(const Solid<double>& solid) {
    std::string keys;
    for_each_key(solid.shape, [&](const Key& key, std::size_t k) {
        keys += fmt::format("{} {} = ", keys.empty() ? "" : ",", key.name);
        keys += key.count() == 3 ? hex_list(solid.used().subspan(k, 3))
                                 : fmt::format("\"{}\"", file::hex(solid.numbers[k]));
    });
    if (solid.placed)
        keys += fmt::format(", {} = {}", solid.placed->is_inverse ? "inverse_matrix" : "matrix",
                            hex_list(solid.placed->matrix));
    return fmt::format("{{{} }}", keys);
}

}  // namespace

std::string head_of_cases(const std::string& title, const std::string& source) {
    return fmt::format("schema = \"lostbits-sweep/1\"\ntitle = {}\nsource = {}\n", quoted(title), quoted(source));
}

std::string case_text(const std::string& name, const scene::rays::RayGroup& one) {
    std::string solids;
    for (const ShapeRow& row : shape_rows) {
        std::string of_shape;
        for (const Solid<double>& solid : one.solids)
            if (solid.shape == row.shape) of_shape += (of_shape.empty() ? "" : ", ") + solid_text(solid);
        if (!of_shape.empty()) solids += fmt::format("{} = [{}]\n", row.plural, of_shape);
    }
    const Ray<double> ray = one.rays[0];
    const std::array origin{ray.origin.x, ray.origin.y, ray.origin.z};
    const std::array direction{ray.direction.x, ray.direction.y, ray.direction.z};
    const Range<double> range = one.rays.range(0);
    const std::string_view open = name_of(range.open);
    return fmt::format("\n[[case]]\nname = {}\n{}{}rays = [{{ origin = {}, direction = {}{}{} }}]\n", quoted(name),
                       open == "none" ? "" : fmt::format("open_ends = \"{}\"\n", open), solids, hex_list(origin),
                       hex_list(direction),
                       range.tmin == 0 ? "" : fmt::format(", tmin = \"{}\"", file::hex(range.tmin)),
                       std::isinf(range.tmax) ? "" : fmt::format(", tmax = \"{}\"", file::hex(range.tmax)));
}

}  // namespace lostbits::output::sweep
