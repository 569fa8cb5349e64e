// Lays out problems as the columns that the stages read: in place, or gathered into buffers of whole registers.
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

/// Number of problems that a stage settles in one call: their columns stay in the first two caches.
inline constexpr std::size_t batch_size = 1024;
/// Stride of a column in a buffer. The stride is not a multiple of 4096 bytes, since all columns would then share a few
/// lines of the first cache.
inline constexpr std::size_t column_capacity = batch_size + 24;
/// Number of doubles in the widest register.
inline constexpr std::size_t max_lanes = 8;

/// Columns of the origin and the direction.
using SixColumns = std::array<std::span<const double>, 6>;

/// Rays [begin, end) of a block as columns of machine words: in place for double, copied for `Real`.
template <class S>
class WordColumns {
public:
    WordColumns(const scene::rays::BasicRayBlock<S>& rays, std::size_t begin, std::size_t end) {
        const auto columns = rays.numbers();
        for (std::size_t k = 0; k < columns.size(); ++k) {
            const std::span<const S> numbers = std::span(*columns[k]).subspan(begin, end - begin);
            if constexpr (std::is_same_v<S, double>) {
                words[k] = numbers;
            } else {
                // First words in the first six buffers, second words in the others
                buffers_[k].resize(numbers.size());
                buffers_[k + 6].resize(numbers.size());
                std::ranges::transform(numbers, buffers_[k].begin(), [](const S& x) { return nearest_double(x); });
                std::ranges::transform(numbers, buffers_[k + 6].begin(),
                                       [](const S& x) { return nearest_low_double(x); });
                words[k] = buffers_[k];
                low[k] = buffers_[k + 6];
            }
        }

        const auto block_part = [&](const std::vector<double>& column) {
            return column.empty() ? std::span(column) : std::span(column).subspan(begin, end - begin);
        };
        tmin = block_part(rays.tmin);
        tmax = block_part(rays.tmax);
    }
    SixColumns words;     ///< first words of the origin and the direction
    SixColumns low = {};  ///< second words; empty for double
    std::span<const double> tmin = {}, tmax = {};

private:
    std::array<std::vector<double>, std::is_same_v<S, double> ? 0 : 12> buffers_;
};

/// True if the range of some ray is not everything ahead of its origin.
template <class S>
bool have_ranges(std::span<const S> tmin, std::span<const S> tmax, OpenEnds open_ends) {
    return open_ends.tmin || std::ranges::any_of(tmin, [](S t) { return t != 0; }) ||
           std::ranges::any_of(tmax, [](S t) { return t != static_cast<S>(HUGE_VAL); });
}

/// Calls `use_column(column, raw_column, default_number)` for each column of the problems: with the column, the
/// column of the stages, and the number that stands for each element if the column is empty. Second words are skipped
/// if they are missing.
template <class S, class Raw, class Use>
void for_each_column(const ProblemColumns<S>& problems, stages::RawProblems<Raw>& raw, const Use& use_column) {
    for (std::size_t k = 0; k < 6; ++k) use_column(problems.ray[k], raw.ray[k], 0);
    for (std::size_t k = 0; k < max_primitive_number_count; ++k) use_column(problems.primitive[k], raw.primitive[k], 0);
    use_column(problems.tmin, raw.tmin, 0);
    use_column(problems.tmax, raw.tmax, static_cast<S>(HUGE_VAL));
    raw.two_words = !problems.ray_low[0].empty();
    if (!raw.two_words) return;
    for (std::size_t k = 0; k < 6; ++k) use_column(problems.ray_low[k], raw.ray_low[k], 0);
    for (std::size_t k = 0; k < max_primitive_number_count; ++k)
        use_column(problems.primitive_low[k], raw.primitive_low[k], 0);
}
/// Indices of the first columns of the ray, the primitive, the range and the second words.
inline constexpr std::size_t first_ray_column = 0, first_primitive_column = 6,
                             tmin_column = 6 + max_primitive_number_count, tmax_column = tmin_column + 1,
                             first_low_column = tmax_column + 1,
                             max_columns = first_low_column + 6 + max_primitive_number_count;

/// Findings of the stages on up to `batch_size` problems.
struct BatchFindings {
    std::uint8_t settled[column_capacity], hit[column_capacity], touches[column_capacity], on_surface[column_capacity];
    double hi[column_capacity], lo[column_capacity], bound[column_capacity];
    double distance_hi[column_capacity], distance_lo[column_capacity], distance_bound[column_capacity];

    stages::RawFindings raw() {
        return {settled, hit, {hi, lo, bound}, {distance_hi, distance_lo, distance_bound}, touches, on_surface};
    }
};

/// Problems copied from anywhere into columns without gaps. The last problem is repeated to fill whole registers.
template <class S>
struct GatheredProblems {
    alignas(64) S numbers[max_columns][column_capacity];
    BatchFindings findings;
    std::size_t size = 0;  ///< number of problems that were added one by one

    /// Buffer of this thread for a shape, or for columns of any shape. It is reused, because some callers settle one
    /// ray at a time, thousands of times.
    static GatheredProblems& for_thread(std::optional<Shape> shape = {}) {
        thread_local std::array<std::unique_ptr<GatheredProblems>, shape_rows.size() + 1> buffers;
        auto& buffer = buffers[shape ? static_cast<std::size_t>(*shape) : shape_rows.size()];
        if (!buffer) buffer = std::make_unique<GatheredProblems>();
        return *buffer;
    }

    /// Copies the problems with these indices into whole registers.
    template <class From>
    stages::RawProblems<S> gather(const ProblemColumns<From>& problems, std::span<const std::size_t> indices,
                                  std::size_t lanes) {
        const std::size_t padded_size = (indices.size() + lanes - 1) / lanes * lanes;
        auto raw = stages::make_raw_problems<S>(padded_size, findings.raw());
        raw.open_ends = problems.open_ends;
        raw.matrix = problems.matrix;
        S* target = numbers[0];
        for_each_column(problems, raw,
                        [&](std::span<const From> source, stages::RawColumn<S>& column, From default_number) {
                            column = {target, source.size() <= 1 ? std::size_t{0} : std::size_t{1}};
                            if (source.size() <= 1) {
                                std::fill_n(target, lanes, static_cast<S>(source.empty() ? default_number : source[0]));
                            } else {
                                for (std::size_t i = 0; i < indices.size(); ++i)
                                    target[i] = static_cast<S>(source[indices[i]]);
                                std::fill(target + indices.size(), target + padded_size, target[indices.size() - 1]);
                            }
                            target += column_capacity;
                        });
        return raw;
    }

    /// Sets numbers of the problem that is added next, in the columns from index `column` on.
    void set_numbers(std::size_t column, std::span<const S> next) {
        for (const S& x : next) numbers[column++][size] = x;
    }
    /// Added problems as columns of one word per number, for rays without ranges and primitives without matrices.
    [[nodiscard]] ProblemColumns<S> columns(Shape shape) const {
        ProblemColumns<S> p{.size = size, .ray = {}, .shape = shape, .primitive = {}};
        const auto column = [this](std::size_t k) { return std::span(numbers[k]).first(size); };
        for (std::size_t k = 0; k < p.ray.size(); ++k) p.ray[k] = column(first_ray_column + k);
        for (std::size_t k = 0; k < row_of(shape).number_count; ++k)
            p.primitive[k] = column(first_primitive_column + k);
        return p;
    }
    /// Added problems in whole registers, for rays without ranges; with `two_words`, also their second words.
    stages::RawProblems<S> added_problems(std::size_t lanes, bool two_words) {
        auto raw = stages::make_raw_problems<S>((size + lanes - 1) / lanes * lanes, findings.raw());
        for (auto& column : numbers) std::fill(column + size, column + raw.size, column[size - 1]);
        const auto point_to_columns = [this](std::size_t first, std::size_t count, stages::RawColumn<S>* target) {
            for (std::size_t k = 0; k < count; ++k) target[k] = {numbers[first + k], 1};
        };
        point_to_columns(first_ray_column, 6, raw.ray), point_to_columns(first_low_column, 6, raw.ray_low);
        point_to_columns(first_primitive_column, max_primitive_number_count, raw.primitive),
            point_to_columns(first_low_column + 6, max_primitive_number_count, raw.primitive_low);
        raw.two_words = two_words;
        raw.tmin = {numbers[tmin_column], 1};
        raw.tmax = {numbers[tmax_column], 1};
        return raw;
    }
};

/// Problems that the stages read in place. For a column of one number, that number is repeated in a register of its
/// own.
template <class S>
class ProblemsInPlace {
public:
    explicit ProblemsInPlace(const ProblemColumns<S>& problems)
        : problems_(problems), has_ranges_(have_ranges(problems.tmin, problems.tmax, problems.open_ends)) {
        stages::RawProblems<S> raw{};
        S* target = repeated_[0];
        for_each_column(problems, raw, [&](std::span<const S> source, stages::RawColumn<S>&, S default_number) {
            std::fill_n(target, max_lanes, source.empty() ? default_number : source[0]);
            target += max_lanes;
        });
    }
    /// True if the range of some ray is not everything ahead.
    [[nodiscard]] bool has_ranges() const { return has_ranges_; }
    /// Runs a stage on `count` problems from `begin` on, and writes its findings to `found`.
    void settle(const stages::ShapeStage<S>& stage, std::size_t lanes, std::size_t begin, std::size_t count,
                const stages::RawFindings& found) const {
        const std::size_t whole_count = count - count % lanes, rest_count = count - whole_count;
        if (whole_count > 0) stage(raw_at(begin, whole_count, found));
        if (rest_count == 0) return;

        // Copies the rest into whole registers, runs the stage there, and copies its findings back.
        std::array<std::size_t, max_lanes> rest_indices;
        std::iota(rest_indices.begin(), rest_indices.end(), begin + whole_count);
        auto& gathered = GatheredProblems<S>::for_thread();
        auto raw = gathered.gather(problems_, std::span(rest_indices).first(rest_count), lanes);
        raw.has_ranges = has_ranges_;
        if (!found.t.hi) raw.out.t = {};
        if (!found.distance.hi) raw.out.distance = {};
        stage(raw);

        const auto copy_rest = [&](const auto* source, auto* target) {
            std::copy_n(source, rest_count, target + whole_count);
        };
        const auto copy_length = [&](const stages::RawLength& source, const stages::RawLength& target) {
            if (!target.hi) return;
            copy_rest(source.hi, target.hi);
            copy_rest(source.lo, target.lo);
            copy_rest(source.bound, target.bound);
        };
        copy_rest(gathered.findings.settled, found.settled);
        copy_rest(gathered.findings.hit, found.hit);
        copy_length(raw.out.t, found.t);
        copy_length(raw.out.distance, found.distance);
    }

private:
    /// Returns `size` problems from `begin` on, in whole registers.
    stages::RawProblems<S> raw_at(std::size_t begin, std::size_t size, const stages::RawFindings& found) const {
        auto raw = stages::make_raw_problems<S>(size, found);
        raw.open_ends = problems_.open_ends;
        raw.matrix = problems_.matrix;
        raw.has_ranges = has_ranges_;
        const S* repeated = repeated_[0];
        for_each_column(problems_, raw, [&](std::span<const S> source, stages::RawColumn<S>& column, S) {
            column =
                source.size() > 1 ? stages::RawColumn<S>{source.data() + begin, 1} : stages::RawColumn<S>{repeated, 0};
            repeated += max_lanes;
        });
        return raw;
    }

    const ProblemColumns<S>& problems_;
    bool has_ranges_;
    alignas(64) S repeated_[max_columns][max_lanes];
};

}  // namespace lostbits::measure::truth
