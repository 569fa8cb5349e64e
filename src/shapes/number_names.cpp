#include "shapes/number_names.hpp"

#include <algorithm>
#include <array>

namespace lostbits {

namespace {

using Strings = std::vector<std::string>;

/// Returns `make_name(key, component)` for every number of a shape. The component is empty if the key has one number.
template <class MakeName>
Strings names_from(Shape shape, const MakeName& make_name) {
    Strings names;
    for (const Key& key : row_of(shape).keys) {
        if (key.count() == 1) names.push_back(make_name(key, std::string()));
        else
            for (const char* const component : {"x", "y", "z"}) names.push_back(make_name(key, std::string(component)));
    }
    return names;
}

/// Returns the lists of names for all shapes.
template <class MakeName>
std::array<Strings, shape_rows.size()> lists_for_shapes(const MakeName& make_name) {
    std::array<Strings, shape_rows.size()> lists;
    for (const ShapeRow& shape_row : shape_rows)
        lists[static_cast<std::size_t>(shape_row.shape)] = names_from(shape_row.shape, make_name);
    return lists;
}

std::string join_name(std::string_view name, std::string_view separator, const std::string& component) {
    return std::string(name) + (component.empty() ? "" : std::string(separator) + component);
}

}  // namespace

std::span<const std::string> number_names(Shape shape) {
    static const auto lists =
        lists_for_shapes([](const Key& key, const auto& component) { return join_name(key.name, "_", component); });
    return lists[static_cast<std::size_t>(shape)];
}

std::span<const std::string> column_names(Shape shape) {
    static const auto lists = lists_for_shapes([](const Key& key, const auto& component) {
        return component.empty() ? std::string(key.name) : join_name(key.short_name, "", component);
    });
    return lists[static_cast<std::size_t>(shape)];
}

std::vector<std::string> other_column_names(Shape shape, std::size_t k) {
    Strings others;
    const auto add_name = [&](const auto& make_name) {
        const std::string name = names_from(shape, make_name)[k];
        if (!name.empty() && name != column_names(shape)[k]) others.push_back(name);
    };
    add_name([](const Key& key, const auto& component) { return join_name(key.name, "_", component); });
    for (std::size_t alias = 0; alias < Key().aliases.size(); ++alias)
        add_name([alias](const Key& key, const auto& component) {
            return key.aliases[alias].empty() ? std::string() : join_name(key.aliases[alias], "_", component);
        });
    add_name([](const Key& key, const auto& component) { return join_name(key.short_name, "", component); });
    return others;
}

std::vector<std::string> number_paths(Shape shape) {
    const std::string prefix = std::string(name_of(shape)) + '.';
    return names_from(
        shape, [&](const Key& key, const auto& component) { return prefix + join_name(key.name, ".", component); });
}

std::string with_article(Shape shape) {
    const std::string_view name = name_of(shape);
    return (std::string_view("aeiou").find(name.front()) == std::string_view::npos ? "a " : "an ") + std::string(name);
}

std::string option_placeholder(Shape shape) {
    // The radii of a shape with several get their own names: RMAJOR, RMINOR.
    const auto placeholder_of = [](const Key& key, const std::string& component) {
        constexpr std::string_view suffix = "_radius";
        const std::string_view name = key.name;
        return name.ends_with(suffix) ? "r" + std::string(name.substr(0, name.size() - suffix.size()))
                                      : join_name(key.short_name, "", component);
    };
    std::string placeholder;
    for (const std::string& name : names_from(shape, placeholder_of))
        placeholder += (placeholder.empty() ? "" : ",") + name;
    std::ranges::transform(placeholder, placeholder.begin(),
                           [](char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; });
    return placeholder;
}

std::string key_phrase(Shape shape) {
    const auto keys = row_of(shape).keys;
    std::string text(keys.front().name);
    for (const Key& key : keys.subspan(1)) text += (&key == &keys.back() ? " and " : ", ") + std::string(key.name);
    return text;
}

std::string key_list(Shape shape) {
    std::string text;
    for (const Key& key : row_of(shape).keys) text += (text.empty() ? "" : ", ") + std::string(key.name);
    return text;
}

std::string order_phrase(const Key& key) {
    const Key& previous = *(&key - 1);
    return std::string(previous.name) + " <= " + std::string(key.name);
}

std::string no_end_reason(Shape shape) {
    std::string shapes;
    for (const ShapeRow& shape_row : shape_rows)
        if (shape_row.takes_tmax) shapes += (shapes.empty() ? "" : ", ") + std::string(shape_row.plural);
    return "ends a ray only for the forms of " + shapes + "; the forms of " + std::string(row_of(shape).plural) +
           " take no end and would ignore it; leave it out, or use " + shapes;
}

std::string limit_phrase(Shape shape, const BrokenLimit& broken) {
    const Key& key = *broken.key;
    if (key.limit == Key::Limit::positive) return "is not greater than 0; write a positive number";
    if (key.limit == Key::Limit::not_negative) return "is less than 0; write 0 or a positive number";
    if (key.limit == Key::Limit::non_negative_below_previous)
        return "is less than 0, or not less than " + std::string((&key - 1)->name) + "; write a number from 0 to that";
    if (key.limit == Key::Limit::positive_below_previous)
        return "is not greater than 0, or not less than " + std::string((&key - 1)->name) +
               "; write a positive number less than that";
    if (key.limit == Key::Limit::not_zero)
        return "is 0 in all three components; write a vector of any length that points the right way";
    if (key.limit == Key::Limit::not_collinear_with_previous)
        return "is on one line with " + std::string((&key - 2)->name) + " and " + std::string((&key - 1)->name) + "; " +
               with_article(shape) + " has an area, so move one of the three";
    if (key.limit == Key::Limit::differs_from_previous)
        return "equals " + std::string((&key - 1)->name) + "; " + with_article(shape) +
               " has a height, so move one of the two";
    return "is below " + std::string((&key - 1)->name) + " in " + number_paths(shape)[broken.number_index].back() +
           "; " + with_article(shape) + " needs " + order_phrase(key) + " in x, y and z";
}

}  // namespace lostbits
