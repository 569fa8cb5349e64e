// Adds up and seals results, by the list of their fields. The same list writes the fields as bits of a shard.
#pragma once

#include <concepts>
#include <cstddef>
#include <optional>
#include <ranges>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace lostbits::measure::study {

/// Defines `fields(archive, whole)`, which passes the fields of a struct to `archive` in the order of their
/// declaration. A structured binding names all fields of the struct, so a field that is missing in the list does not
/// compile.
#define LOSTBITS_FIELDS(Struct, ...)               \
    template <class Archive>                       \
    void fields(Archive& archive, Struct& whole) { \
        auto& [__VA_ARGS__] = whole;               \
        archive(__VA_ARGS__);                      \
    }

struct AnyVisitor {
    template <class... T>
    void operator()(T&...) const {}
};
template <class T>
concept HasFields = requires(AnyVisitor visitor, T& whole) {
    fields(visitor, whole);
};

template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;

/// Adds a part of the work to `total`, which holds the parts before it. A result with a function `append` adds the part
/// itself. Counts and distributions add up; lists add up item by item; an optional is the first of something, so the
/// first one stays. Nothing is rounded, so the sum does not depend on where parts begin. Throws std::out_of_range for
/// lists of different sizes.
template <class T>
void add_up(T& total, T&& part) {
    if constexpr (requires { total.append(std::move(part)); }) {
        total.append(std::move(part));
    } else if constexpr (std::unsigned_integral<T> && !std::same_as<T, bool>) {
        total += part;
    } else if constexpr (is_optional<T>) {
        if (!total) total = std::move(part);
    } else if constexpr (std::ranges::range<T>) {
        if (total.size() != part.size()) throw std::out_of_range("two parts of a result have lists of different sizes");
        for (std::size_t i = 0; i < total.size(); ++i) add_up(total[i], std::move(part[i]));
    } else if constexpr (HasFields<T>) {
        auto add_part = [&part](auto&... sums) {
            auto add_fields = [&](auto&... addends) { (add_up(sums, std::move(addends)), ...); };
            fields(add_fields, part);
        };
        fields(add_part, total);
    } else if constexpr (requires { total.add(part); }) {
        total.add(part);
    } else {
        static_assert(!std::is_arithmetic_v<T>, "sums of rounded numbers depend on their order");
        total += part;
    }
}

/// Seals every distribution in a result, which frees most of its memory; see `metric::Distribution::seal`.
template <class T>
void seal_all(T& result) {
    if constexpr (requires { result.seal(); }) {
        result.seal();
    } else if constexpr (std::ranges::range<T>) {
        for (auto& item : result) seal_all(item);
    } else if constexpr (HasFields<T>) {
        auto seal_fields = [](auto&... parts) { (seal_all(parts), ...); };
        fields(seal_fields, result);
    }
}

}  // namespace lostbits::measure::study
