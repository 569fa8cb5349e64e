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
void sort_by_index(std::vector<T>& all, const Index& index_of) {
    constexpr std::size_t few = 512, digits = 1 << 11;
    if (all.size() <= few) {
        std::ranges::stable_sort(all, {}, index_of);
        return;
    }
    std::uint32_t largest = 0;
    bool sorted = true;
    for (const T& one : all) {
        const std::uint32_t index = index_of(one);
        sorted &= index >= largest;
        largest = std::max(largest, index);
    }
    if (sorted) return;
    std::vector<T> other(all.size());
    for (unsigned shift = 0; shift < 32 && (largest >> shift) != 0; shift += 11) {
        std::array<std::size_t, digits> places{};
        const auto digit = [&](const T& one) { return (index_of(one) >> shift) % digits; };
        for (const T& one : all) ++places[digit(one)];
        std::size_t before = 0;
        for (std::size_t& place : places) place = std::exchange(before, before + place);
        for (const T& one : all) other[places[digit(one)]++] = one;
        all.swap(other);
    }
}

}  // namespace lostbits::measure::culling
