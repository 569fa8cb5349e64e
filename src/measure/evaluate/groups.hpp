// Rays by the values of a column of the user's own, such as depth, material or instance: a summary of each.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::evaluate {

/// What is known of the rays that have a value, a summary a row.
struct Group {
    std::string value;
    std::vector<FormSummary> summaries;
};

/// The groups of a run, in their order: numbers by size, then words.
class Groups {
public:
    /// More values than that are no kinds of rays but their names.
    static constexpr std::size_t most = 4096;

    /// Makes the group of a value, with an empty summary of these metrics for each row, where there is none. InputError
    /// for more than `most`.
    void add(const std::string& value, std::size_t rows, const std::vector<const metric::Metric*>& metrics);
    /// That of a value that was added. For several threads at once.
    [[nodiscard]] Group& at(const std::string& value) { return all_[place_of(value)]; }
    /// What is known of the rays that come next.
    void append(Groups&& after);
    [[nodiscard]] const std::vector<Group>& all() const { return all_; }

    /// What it knows, for `output::shard`.
    template <class Bits>
    void fields(Bits& bits) {
        bits(all_);
    }

private:
    [[nodiscard]] std::size_t place_of(const std::string& value) const;
    [[nodiscard]] bool has(const std::string& value, std::size_t at) const {
        return at < all_.size() && all_[at].value == value;
    }
    void insert(std::size_t at, Group&& group);
    std::vector<Group> all_;
};

/// Some rays of one value, by their places.
struct RaysOfValue {
    std::string value;
    std::vector<std::uint32_t> rays;
};
/// Each value once; value i is at `values[i * step]`.
std::vector<RaysOfValue> by_value(std::span<const std::string> values, std::size_t step);

}  // namespace lostbits::measure::evaluate
