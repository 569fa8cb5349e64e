// Converts between a primitive and its numbers, in the order of the keys of its shape.
#pragma once

#include <concepts>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "geometry/key.hpp"
#include "geometry/vec.hpp"

namespace lostbits {

/// Builds the primitive whose numbers are `number_at(0)`, `number_at(1)`, …
template <template <class> class S, class T, class Numbers>
constexpr S<T> primitive_from(const Numbers& number_at) {
    const auto make_key = [&number_at]<std::size_t key_index>(std::integral_constant<std::size_t, key_index>) {
        constexpr std::size_t first = [] {
            std::size_t count = 0;
            for (std::size_t k = 0; k < key_index; ++k) count += S<T>::keys[k].count();
            return count;
        }();
        if constexpr (S<T>::keys[key_index].count() == 1) return T(number_at(first));
        else return Vec<T>{number_at(first), number_at(first + 1), number_at(first + 2)};
    };
    return [&make_key]<std::size_t... key_index>(std::index_sequence<key_index...>) {
        return S<T>{make_key(std::integral_constant<std::size_t, key_index>())...};
    }
    (std::make_index_sequence<S<T>::keys.size()>());
}

/// Calls `visit(number)` for each number of a primitive.
template <template <class> class S, class T, class Visit>
constexpr void for_each_number(const S<T>& primitive, const Visit& visit) {
    const auto visit_keys = [&visit](const auto&... values) {
        const auto visit_key = [&visit](const auto& x) {
            if constexpr (std::same_as<decltype(x), const Vec<T>&>) {
                visit(x.x);
                visit(x.y);
                visit(x.z);
            } else {
                visit(x);
            }
        };
        (visit_key(values), ...);
    };

    // A primitive is taken apart into its keys, each a number or a point.
    constexpr std::size_t keys = S<T>::keys.size();
    static_assert(keys >= 2 && keys <= 4);
    if constexpr (keys == 2) {
        const auto& [a, b] = primitive;
        visit_keys(a, b);
    } else if constexpr (keys == 3) {
        const auto& [a, b, c] = primitive;
        visit_keys(a, b, c);
    } else {
        const auto& [a, b, c, d] = primitive;
        visit_keys(a, b, c, d);
    }
}

}  // namespace lostbits
