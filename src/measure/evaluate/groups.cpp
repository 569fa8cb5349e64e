#include "measure/evaluate/groups.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "number/error.hpp"

namespace lostbits::measure::evaluate {

namespace {

/// Order of values: numbers by size, then all other text. Equal numbers are ordered by their text.
struct Rank {
    bool is_text;
    double number;
    const std::string& text;

    explicit Rank(const std::string& value) : is_text(true), number(0), text(value) {
        double x = 0;
        const char* const end = value.data() + value.size();
        if (value.empty() || std::from_chars(value.data(), end, x).ptr != end || std::isnan(x)) return;
        is_text = false;
        number = x;
    }
    friend bool operator<(const Rank& a, const Rank& b) {
        return std::tie(a.is_text, a.number, a.text) < std::tie(b.is_text, b.number, b.text);
    }
};

}  // namespace

std::size_t Groups::index_of(const std::string& value) const {
    const auto is_before = [](const Group& group, const std::string& v) { return Rank(group.value) < Rank(v); };
    return static_cast<std::size_t>(std::lower_bound(all_.begin(), all_.end(), value, is_before) - all_.begin());
}

void Groups::insert(std::size_t index, Group&& group) {
    if (all_.size() == max_values)
        throw InputError("more than " + std::to_string(max_values) + " values, such as " + all_.front().value +
                         " and " + group.value +
                         "; group by a column that many rays share, such as depth, material or instance");
    all_.insert(all_.begin() + static_cast<std::ptrdiff_t>(index), std::move(group));
}

void Groups::add(const std::string& value, std::size_t row_count, const std::vector<const metric::Metric*>& metrics) {
    const std::size_t index = index_of(value);
    if (has(value, index)) return;
    Group group{value, {}};
    for (std::size_t r = 0; r < row_count; ++r) group.summaries.emplace_back(metrics);
    insert(index, std::move(group));
}

void Groups::append(Groups&& next_rays) {
    for (Group& group : next_rays.all_) {
        const std::size_t index = index_of(group.value);
        if (!has(group.value, index)) {
            insert(index, std::move(group));
            continue;
        }
        for (std::size_t r = 0; r < group.summaries.size(); ++r)
            all_[index].summaries.at(r).append(std::move(group.summaries[r]));
    }
}

std::vector<RaysWithValue> group_by_value(std::span<const std::string> values, std::size_t step) {
    std::vector<RaysWithValue> groups;
    std::unordered_map<std::string, std::size_t> indices;
    for (std::size_t i = 0; i * step < values.size(); ++i) {
        const std::string& value = values[i * step];
        const auto [entry, is_new] = indices.try_emplace(value, groups.size());
        if (is_new) groups.push_back({value, {}});
        groups[entry->second].rays.push_back(static_cast<std::uint32_t>(i));
    }
    return groups;
}

}  // namespace lostbits::measure::evaluate
