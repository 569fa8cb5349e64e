// The columns of problems as the stages read them: in place, or gathered into buffers of whole registers.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "measure/stages/stages.hpp"
#include "measure/truth/truth_columns.hpp"

namespace lostbits::measure::truth {

/// Problems that are settled together: their columns stay in the first two caches.
inline constexpr std::size_t settled_together = 1024;
/// Doubles of the widest register.
inline constexpr std::size_t most_lanes = 8;

/// Calls `use(column, raw)` for each column of the problems, with its place among those of the stages. A column that
/// is not there is empty.
template <class S, class Raw, class Use>
void for_each_column(const ProblemColumns<S>& p, stages::RawProblems<Raw>& raw, const Use& use) {
    for (std::size_t k = 0; k < 6; ++k) use(p.ray[k], raw.ray[k], 0);
    for (std::size_t k = 0; k < 6; ++k) use(p.solid[k], raw.solid[k], 0);
    use(p.tmax, raw.tmax, static_cast<S>(HUGE_VAL));
    if (p.ray_low[0].empty()) return;
    for (std::size_t k = 0; k < 6; ++k) use(p.ray_low[k], raw.ray_low[k], 0);
    for (std::size_t k = 0; k < 6; ++k) use(p.solid_low[k], raw.solid_low[k], 0);
}
inline constexpr std::size_t most_columns = 25;

/// What the stages find of up to `settled_together` problems.
struct FoundTogether {
    std::uint8_t settled[settled_together], hit[settled_together];
    double hi[settled_together], lo[settled_together], bound[settled_together];
    double distance_hi[settled_together], distance_lo[settled_together], distance_bound[settled_together];

    stages::RawFindings raw() { return {settled, hit, hi, lo, bound, distance_hi, distance_lo, distance_bound}; }
};

/// Problems in a row, wherever they were: filled up to whole registers by the last of them.
template <class S>
struct Gathered {
    alignas(64) S numbers[most_columns][settled_together];
    FoundTogether found;

    template <class From>
    stages::RawProblems<S> gather(const ProblemColumns<From>& p, std::span<const std::size_t> which,
                                  std::size_t lanes) {
        const std::size_t size = (which.size() + lanes - 1) / lanes * lanes;
        auto raw = stages::raw_problems<S>(size, found.raw());
        S* to = numbers[0];
        for_each_column(p, raw, [&](std::span<const From> from, stages::RawColumn<S>& column, From absent) {
            column = {to, from.size() <= 1 ? std::size_t{0} : std::size_t{1}};
            if (from.size() <= 1) {
                std::fill_n(to, lanes, static_cast<S>(from.empty() ? absent : from[0]));
            } else {
                for (std::size_t i = 0; i < which.size(); ++i) to[i] = static_cast<S>(from[which[i]]);
                std::fill(to + which.size(), to + size, to[which.size() - 1]);
            }
            to += settled_together;
        });
        return raw;
    }
};

/// Problems where they lie: the columns of one number are repeated in registers of their own.
template <class S>
class InPlace {
public:
    explicit InPlace(const ProblemColumns<S>& p) : problems_(p) {
        stages::RawProblems<S> raw{};
        S* to = same_[0];
        for_each_column(p, raw, [&](std::span<const S> from, stages::RawColumn<S>&, S absent) {
            std::fill_n(to, most_lanes, from.empty() ? absent : from[0]);
            to += most_lanes;
        });
    }
    /// `size` of them from `begin` on.
    stages::RawProblems<S> at(std::size_t begin, std::size_t size, const stages::RawFindings& found) const {
        auto raw = stages::raw_problems<S>(size, found);
        const S* same = same_[0];
        for_each_column(problems_, raw, [&](std::span<const S> from, stages::RawColumn<S>& column, S) {
            column = from.size() > 1 ? stages::RawColumn<S>{from.data() + begin, 1} : stages::RawColumn<S>{same, 0};
            same += most_lanes;
        });
        return raw;
    }

private:
    const ProblemColumns<S>& problems_;
    alignas(64) S same_[most_columns][most_lanes];
};

}  // namespace lostbits::measure::truth
