#include "shapes/number_names.hpp"

#include <algorithm>
#include <array>

namespace lostbits {

namespace {

using Strings = std::vector<std::string>;

/// Collects `each(key, component)` for every number. The component is empty if the key has one number.
template <class Each>
Strings named(Shape shape, const Each& each) {
    Strings names;
    for (const Key& key : row_of(shape).keys) {
        if (key.count() == 1) names.push_back(each(key, std::string()));
        else
            for (const char* const component : {"x", "y", "z"}) names.push_back(each(key, std::string(component)));
    }
    return names;
}

/// Makes one list for each shape.
template <class Each>
std::array<Strings, shape_rows.size()> of_all(const Each& each) {
    std::array<Strings, shape_rows.size()> lists;
    for (const ShapeRow& row : shape_rows) lists[static_cast<std::size_t>(row.shape)] = named(row.shape, each);
    return lists;
}

std::string joined(std::string_view name, std::string_view between, const std::string& component) {
    return std::string(name) + (component.empty() ? "" : std::string(between) + component);
}

}  // namespace

std::span<const std::string> number_names(Shape shape) {
    static const auto lists = of_all([](const Key& key, const auto& part) { return joined(key.name, "_", part); });
    return lists[static_cast<std::size_t>(shape)];
}

std::span<const std::string> column_names(Shape shape) {
    static const auto lists = of_all([](const Key& key, const auto& part) {
        return part.empty() ? std::string(key.name) : joined(key.letter, "", part);
    });
    return lists[static_cast<std::size_t>(shape)];
}

std::vector<std::string> other_column_names(Shape shape, std::size_t k) {
    Strings others;
    const auto add = [&](const auto& each) {
        const std::string name = named(shape, each)[k];
        if (!name.empty() && name != column_names(shape)[k]) others.push_back(name);
    };
    add([](const Key& key, const auto& part) { return joined(key.name, "_", part); });
    for (std::size_t alias = 0; alias < Key().aliases.size(); ++alias)
        add([alias](const Key& key, const auto& part) {
            return key.aliases[alias].empty() ? std::string() : joined(key.aliases[alias], "_", part);
        });
    add([](const Key& key, const auto& part) { return joined(key.letter, "", part); });
    return others;
}

std::vector<std::string> number_paths(Shape shape) {
    const std::string front = std::string(name_of(shape)) + '.';
    return named(shape, [&](const Key& key, const auto& part) { return front + joined(key.name, ".", part); });
}

std::string with_article(Shape shape) {
    const std::string_view name = name_of(shape);
    return (std::string_view("aeiou").find(name.front()) == std::string_view::npos ? "a " : "an ") + std::string(name);
}

std::string option_placeholder(Shape shape) {
    // A shape with several radii names each: RMAJOR, RMINOR.
    const auto word = [](const Key& key, const std::string& part) {
        constexpr std::string_view tail = "_radius";
        const std::string_view name = key.name;
        return name.ends_with(tail) ? "r" + std::string(name.substr(0, name.size() - tail.size()))
                                    : joined(key.letter, "", part);
    };
    std::string words;
    for (const std::string& name : named(shape, word)) words += (words.empty() ? "" : ",") + name;
    std::ranges::transform(words, words.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; });
    return words;
}

std::string key_phrase(Shape shape) {
    const auto keys = row_of(shape).keys;
    std::string words(keys.front().name);
    for (const Key& key : keys.subspan(1)) words += (&key == &keys.back() ? " and " : ", ") + std::string(key.name);
    return words;
}

std::string key_list(Shape shape) {
    std::string words;
    for (const Key& key : row_of(shape).keys) words += (words.empty() ? "" : ", ") + std::string(key.name);
    return words;
}

std::string order_phrase(const Key& key) {
    const Key& before = *(&key - 1);
    return std::string(before.name) + " <= " + std::string(key.name);
}

std::string no_end_reason(Shape shape) {
    std::string told;
    for (const ShapeRow& row : shape_rows)
        if (row.takes_tmax) told += (told.empty() ? "" : ", ") + std::string(row.plural);
    return "ends a ray only for the forms of " + told + "; the forms of " + std::string(row_of(shape).plural) +
           " take no end and would ignore it; leave it out, or use " + told;
}

std::string limit_phrase(Shape shape, const Key& key) {
    if (key.limit == Key::Limit::positive) return "is not greater than 0; write a positive number";
    if (key.limit == Key::Limit::not_negative) return "is less than 0; write 0 or a positive number";
    if (key.limit == Key::Limit::non_negative_below_previous)
        return "is less than 0, or not less than " + std::string((&key - 1)->name) + "; write a number from 0 to that";
    if (key.limit == Key::Limit::positive_below_previous)
        return "is not greater than 0, or not less than " + std::string((&key - 1)->name) +
               "; write a positive number less than that";
    if (key.limit == Key::Limit::not_zero)
        return "is 0 in all three components; write a vector of any length that points the right way";
    if (key.limit == Key::Limit::off_line_before)
        return "is on one line with " + std::string((&key - 2)->name) + " and " + std::string((&key - 1)->name) + "; " +
               with_article(shape) + " has an area, so move one of the three";
    if (key.limit == Key::Limit::apart_from_before)
        return "equals " + std::string((&key - 1)->name) + "; " + with_article(shape) +
               " has a height, so move one of the two";
    return "is below " + std::string((&key - 1)->name) + " in a component; " + with_article(shape) + " needs " +
           order_phrase(key) + " in each";
}

}  // namespace lostbits
