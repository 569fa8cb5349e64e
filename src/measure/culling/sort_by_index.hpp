// Sorts long lists by an index of a primitive, in time proportional to their length.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace lostbits::measure::culling {

/// Sorts by `index_of(element)`; elements of equal index keep their order. Short lists are sorted by comparing, long
/// ones by 11 bits of the index at a time. Far from a mesh of 20,480 triangles each ray has all of them as candidates:
/// comparing took two thirds of the time of `choose` there.
template <class T, class Index>
void sort_by_index(std::vector<T>& elements, const Index& index_of) {
    constexpr std::size_t short_size = 512, digits = 1 << 11;
    if (elements.size() <= short_size) {
        std::ranges::stable_sort(elements, {}, index_of);
        return;
    }

    // The largest index limits the number of passes. A sorted list needs none.
    std::uint32_t largest = 0;
    bool is_sorted = true;
    for (const T& element : elements) {
        const std::uint32_t index = index_of(element);
        is_sorted &= index >= largest;
        largest = std::max(largest, index);
    }
    if (is_sorted) return;

    // Each pass counts the elements by one digit, then moves them in order to the places of their digit.
    std::vector<T> buffer(elements.size());
    for (unsigned shift = 0; shift < 32 && (largest >> shift) != 0; shift += 11) {
        std::array<std::size_t, digits> offsets{};
        const auto digit = [&](const T& element) { return (index_of(element) >> shift) % digits; };
        for (const T& element : elements) ++offsets[digit(element)];
        std::size_t next_offset = 0;
        for (std::size_t& offset : offsets) offset = std::exchange(next_offset, next_offset + offset);
        for (const T& element : elements) buffer[offsets[digit(element)]++] = element;
        elements.swap(buffer);
    }
}

}  // namespace lostbits::measure::culling
