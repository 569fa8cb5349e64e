// Groups rays by the values of a column that the user's file has, such as depth, material or instance, with summaries
// of each group.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::evaluate {

/// Summaries of all rays with the same value of the column, one for each row.
struct Group {
    std::string value;
    std::vector<FormSummary> summaries;
};

/// Groups of a run, in order: numbers by size, then all other text.
class Groups {
public:
    /// Limit on the number of values. A column with more values identifies rays instead of grouping them.
    static constexpr std::size_t max_values = 4096;

    /// Makes the group of a new value, with an empty summary of these metrics for each tested form. Throws InputError
    /// for more than `max_values` values.
    void add(const std::string& value, std::size_t row_count, const std::vector<const metric::Metric*>& metrics);
    /// Group of a value that was added. May be called by several threads at once.
    [[nodiscard]] Group& at(const std::string& value) { return all_[index_of(value)]; }
    /// Adds the groups of the rays that come next.
    void append(Groups&& next_rays);
    [[nodiscard]] const std::vector<Group>& all() const { return all_; }

    /// Serialises the groups, for `output::shard`.
    template <class Archive>
    void fields(Archive& archive) {
        archive(all_);
    }

private:
    [[nodiscard]] std::size_t index_of(const std::string& value) const;
    [[nodiscard]] bool has(const std::string& value, std::size_t index) const {
        return index < all_.size() && all_[index].value == value;
    }
    void insert(std::size_t index, Group&& group);
    std::vector<Group> all_;
};

/// Indices of the rays with one value.
struct RaysWithValue {
    std::string value;
    std::vector<std::uint32_t> rays;
};
/// Groups the rays by value, each value once; the value of ray i is at `values[i * step]`.
std::vector<RaysWithValue> group_by_value(std::span<const std::string> values, std::size_t step);

}  // namespace lostbits::measure::evaluate
