// Columns of problems in the layout that the stages read: in place, or gathered into buffers of whole registers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <span>

#include "measure/stages/stages.hpp"
#include "measure/truth/truth_columns.hpp"
#include "scene/rays/rays.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::truth {

/// Number of problems that are settled together: their columns stay in the first two caches.
inline constexpr std::size_t settled_together = 1024;
/// Stride of a column in a buffer. It is not a multiple of 4096 bytes, since all columns would then share a few lines
/// of the first cache.
inline constexpr std::size_t column_capacity = settled_together + 24;
/// Doubles of the widest register.
inline constexpr std::size_t most_lanes = 8;

using Spans = std::array<std::span<const double>, 6>;

/// Rays begin to end of a block as columns of words: in place, or copied.
template <class S>
class WordColumns {
public:
    WordColumns(const scene::rays::BasicRayBlock<S>& rays, std::size_t begin, std::size_t end) {
        const auto from = rays.numbers();
        for (std::size_t k = 0; k < from.size(); ++k) {
            const std::span<const S> numbers = std::span(*from[k]).subspan(begin, end - begin);
            if constexpr (std::is_same_v<S, double>) {
                words[k] = numbers;
            } else {
                buffers_[k].resize(numbers.size()), buffers_[k + 6].resize(numbers.size());
                std::ranges::transform(numbers, buffers_[k].begin(), [](const S& x) { return word_of(x); });
                std::ranges::transform(numbers, buffers_[k + 6].begin(), [](const S& x) { return low_word_of(x); });
                words[k] = buffers_[k], low[k] = buffers_[k + 6];
            }
        }
        const auto part = [&](const std::vector<double>& all) {
            return all.empty() ? std::span(all) : std::span(all).subspan(begin, end - begin);
        };
        tmin = part(rays.tmin), tmax = part(rays.tmax);
    }
    Spans words, low = {};
    std::span<const double> tmin = {}, tmax = {};

private:
    std::array<std::vector<double>, std::is_same_v<S, double> ? 0 : 12> buffers_;
};

/// True if some ray has a range that is not everything ahead of its origin.
template <class S>
bool have_ranges(std::span<const S> tmin, std::span<const S> tmax, OpenEnds open) {
    return open.tmin || std::ranges::any_of(tmin, [](S t) { return t != 0; }) ||
           std::ranges::any_of(tmax, [](S t) { return t != static_cast<S>(HUGE_VAL); });
}

/// Calls `use(column, raw)` for each column of the problems, with its index among those of the stages. A missing column
/// is empty; missing second words are skipped.
template <class S, class Raw, class Use>
void for_each_column(const ProblemColumns<S>& p, stages::RawProblems<Raw>& raw, const Use& use) {
    for (std::size_t k = 0; k < 6; ++k) use(p.ray[k], raw.ray[k], 0);
    for (std::size_t k = 0; k < most_stored; ++k) use(p.primitive[k], raw.primitive[k], 0);
    use(p.tmin, raw.tmin, 0);
    use(p.tmax, raw.tmax, static_cast<S>(HUGE_VAL));
    raw.two_words = !p.ray_low[0].empty();
    if (!raw.two_words) return;
    for (std::size_t k = 0; k < 6; ++k) use(p.ray_low[k], raw.ray_low[k], 0);
    for (std::size_t k = 0; k < most_stored; ++k) use(p.primitive_low[k], raw.primitive_low[k], 0);
}
/// Indices of the first columns of the ray, the primitive, the range and the second words.
inline constexpr std::size_t first_of_ray = 0, first_of_primitive = 6, place_of_tmin = 6 + most_stored,
                             place_of_tmax = place_of_tmin + 1, first_of_low = place_of_tmax + 1,
                             most_columns = first_of_low + 6 + most_stored;

/// Findings of the stages on up to `settled_together` problems.
struct BatchFindings {
    std::uint8_t settled[column_capacity], hit[column_capacity], touches[column_capacity], on_surface[column_capacity];
    double hi[column_capacity], lo[column_capacity], bound[column_capacity];
    double distance_hi[column_capacity], distance_lo[column_capacity], distance_bound[column_capacity];

    stages::RawFindings raw() {
        return {settled, hit, {hi, lo, bound}, {distance_hi, distance_lo, distance_bound}, touches, on_surface};
    }
};

/// Problems from anywhere, gathered in a row. The last one is repeated to fill whole registers.
template <class S>
struct GatheredProblems {
    alignas(64) S numbers[most_columns][column_capacity];
    BatchFindings found;
    std::size_t size = 0;  ///< number of problems that were added one by one

    /// Buffer of this thread for a shape, or for columns of any shape. It is reused, because some callers settle one
    /// ray at a time, thousands of times.
    static GatheredProblems& of_thread(std::optional<Shape> shape = {}) {
        thread_local std::array<std::unique_ptr<GatheredProblems>, shape_rows.size() + 1> all;
        auto& wanted = all[shape ? static_cast<std::size_t>(*shape) : shape_rows.size()];
        if (!wanted) wanted = std::make_unique<GatheredProblems>();
        return *wanted;
    }

    /// Copies the problems `which` into whole registers.
    template <class From>
    stages::RawProblems<S> gather(const ProblemColumns<From>& p, std::span<const std::size_t> which,
                                  std::size_t lanes) {
        const std::size_t filled = (which.size() + lanes - 1) / lanes * lanes;
        auto raw = stages::raw_problems<S>(filled, found.raw());
        raw.open = p.open, raw.matrix = p.matrix;
        S* to = numbers[0];
        for_each_column(p, raw, [&](std::span<const From> from, stages::RawColumn<S>& column, From absent) {
            column = {to, from.size() <= 1 ? std::size_t{0} : std::size_t{1}};
            if (from.size() <= 1) {
                std::fill_n(to, lanes, static_cast<S>(from.empty() ? absent : from[0]));
            } else {
                for (std::size_t i = 0; i < which.size(); ++i) to[i] = static_cast<S>(from[which[i]]);
                std::fill(to + which.size(), to + filled, to[which.size() - 1]);
            }
            to += column_capacity;
        });
        return raw;
    }

    /// Sets the numbers of the problem that is added next.
    void set(std::size_t column, std::span<const S> next) {
        for (const S& x : next) numbers[column++][size] = x;
    }
    /// Added problems as columns of one word per number, for rays without ranges and primitives without matrices.
    [[nodiscard]] ProblemColumns<S> columns(Shape shape) const {
        ProblemColumns<S> p{.size = size, .ray = {}, .shape = shape, .primitive = {}};
        const auto column = [this](std::size_t k) { return std::span(numbers[k]).first(size); };
        for (std::size_t k = 0; k < p.ray.size(); ++k) p.ray[k] = column(first_of_ray + k);
        for (std::size_t k = 0; k < row_of(shape).numbers; ++k) p.primitive[k] = column(first_of_primitive + k);
        return p;
    }
    /// Added problems, for rays without ranges; with `two_words`, also their second words.
    stages::RawProblems<S> added(std::size_t lanes, bool two_words) {
        auto raw = stages::raw_problems<S>((size + lanes - 1) / lanes * lanes, found.raw());
        for (auto& column : numbers) std::fill(column + size, column + raw.size, column[size - 1]);
        const auto words = [this](std::size_t first, std::size_t count, stages::RawColumn<S>* to) {
            for (std::size_t k = 0; k < count; ++k) to[k] = {numbers[first + k], 1};
        };
        words(first_of_ray, 6, raw.ray), words(first_of_low, 6, raw.ray_low);
        words(first_of_primitive, most_stored, raw.primitive), words(first_of_low + 6, most_stored, raw.primitive_low);
        raw.two_words = two_words;
        raw.tmin = {numbers[place_of_tmin], 1};
        raw.tmax = {numbers[place_of_tmax], 1};
        return raw;
    }
};

/// Problems read in place. A column of one number is repeated in a register of its own.
template <class S>
class ProblemsInPlace {
public:
    explicit ProblemsInPlace(const ProblemColumns<S>& p) : problems_(p), ranged_(have_ranges(p.tmin, p.tmax, p.open)) {
        stages::RawProblems<S> raw{};
        S* to = same_[0];
        for_each_column(p, raw, [&](std::span<const S> from, stages::RawColumn<S>&, S absent) {
            std::fill_n(to, most_lanes, from.empty() ? absent : from[0]);
            to += most_lanes;
        });
    }
    [[nodiscard]] bool has_own_ranges() const { return ranged_; }
    /// Runs a stage on `count` problems from `begin` on. The findings are written from where `found` points to.
    void settle(const stages::ShapeStage<S>& stage, std::size_t lanes, std::size_t begin, std::size_t count,
                const stages::RawFindings& found) const {
        const std::size_t whole = count - count % lanes, left = count - whole;
        if (whole > 0) stage(at(begin, whole, found));
        if (left == 0) return;
        std::array<std::size_t, most_lanes> last;
        std::iota(last.begin(), last.end(), begin + whole);
        auto& rest = GatheredProblems<S>::of_thread();
        auto raw = rest.gather(problems_, std::span(last).first(left), lanes);
        raw.ranged = ranged_;
        if (!found.t.hi) raw.out.t = {};
        if (!found.distance.hi) raw.out.distance = {};
        stage(raw);
        const auto keep = [&](const auto* from, auto* to) { std::copy_n(from, left, to + whole); };
        const auto keep_length = [&](const stages::RawLength& from, const stages::RawLength& to) {
            if (to.hi) keep(from.hi, to.hi), keep(from.lo, to.lo), keep(from.bound, to.bound);
        };
        keep(rest.found.settled, found.settled), keep(rest.found.hit, found.hit);
        keep_length(raw.out.t, found.t), keep_length(raw.out.distance, found.distance);
    }

private:
    /// `size` problems from `begin` on, in whole registers.
    stages::RawProblems<S> at(std::size_t begin, std::size_t size, const stages::RawFindings& found) const {
        auto raw = stages::raw_problems<S>(size, found);
        raw.open = problems_.open, raw.matrix = problems_.matrix;
        raw.ranged = ranged_;
        const S* same = same_[0];
        for_each_column(problems_, raw, [&](std::span<const S> from, stages::RawColumn<S>& column, S) {
            column = from.size() > 1 ? stages::RawColumn<S>{from.data() + begin, 1} : stages::RawColumn<S>{same, 0};
            same += most_lanes;
        });
        return raw;
    }

    const ProblemColumns<S>& problems_;
    bool ranged_;
    alignas(64) S same_[most_columns][most_lanes];
};

}  // namespace lostbits::measure::truth
