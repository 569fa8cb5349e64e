// Units of a run's work that are measured: all of them, or those of one of its shards.
#pragma once

#include <cstdint>

namespace lostbits::measure::shard {

/// Consecutive units [first, last) of a run's work: bands of a picture, blocks of floats, steps, or rows.
struct UnitRange {
    std::uint64_t first = 0, last = 0;

    [[nodiscard]] std::uint64_t size() const { return last - first; }
    [[nodiscard]] bool holds(std::uint64_t unit) const { return first <= unit && unit < last; }
};

/// Share of a run that one shard measures: shard `number` (from 1) of `count`. With `count` = 1 it is the whole run.
struct Share {
    static constexpr std::uint64_t max_count = 1'000'000;  ///< so that no product below overflows with 2^44 units

    std::uint64_t number = 1, count = 1;

    [[nodiscard]] bool is_whole() const { return count == 1; }
    /// Returns the units ⌊units·(number − 1)/count⌋ to ⌊units·number/count⌋. The shards of a run follow one another,
    /// share no unit, and together have all units; their sizes differ by at most one. Where there are fewer units than
    /// shards, some shards are empty.
    [[nodiscard]] UnitRange unit_range(std::uint64_t units) const {
        return {units * (number - 1) / count, units * number / count};
    }
    friend bool operator==(const Share&, const Share&) = default;
};

}  // namespace lostbits::measure::shard
