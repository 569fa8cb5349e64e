// Finds the truth of rays among primitives. Each primitive is tested against whole columns of rays. If a ray can meet
// only a few primitives, or if columns cannot decide which primitive comes first, pairs of one ray and one primitive
// are tested instead.
#include <tbb/combinable.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "intersect/process/floating_point.hpp"
#include "intersect/process/parallel.hpp"
#include "measure/truth/enclose.hpp"
#include "measure/truth/gathered.hpp"
#include "measure/truth/truth_columns.hpp"
#include "number/real.hpp"

namespace lostbits::measure::truth {

namespace {

/// Results of one thread: truths that columns cannot hold, with the indices of their rays, and counts of the stages
/// that settled the truths.
struct ThreadResults {
    StageCounts counts;
    std::vector<std::pair<std::size_t, Truth>> complete_truths;
};

/// Finds the truths of rays [begin, end), at most `batch_size`.
template <class S>
class BlockSearch {
public:
    static constexpr bool two_words = !std::is_same_v<S, double>;

    BlockSearch(const RaysAndPrimitives<S>& problems, ProofLimit limit, std::size_t begin, std::size_t end,
                RayTruths& out, ThreadResults& results)
        : problems_(problems),
          limit_(limit),
          begin_(begin),
          count_(end - begin),
          rays_(problems.rays, begin, end),
          out_(out),
          results_(results),
          isa_(intersect::simd::current_isa()),
          has_ranges_(have_ranges(rays_.tmin, rays_.tmax, problems.rays.open_ends)) {}

    /// Finds the truths. With an index, each ray is tested against its candidates; without one, each primitive is
    /// tested against whole columns of rays.
    void find() {
        if (problems_.index) return find_pairs([](std::size_t) { return true; });
        open_.assign(count_, 0);
        if (problems_.is_paired) test_paired_primitives();
        else
            for (std::size_t k = 0; k < problems_.primitives.size(); ++k) test_primitive(k);
        const auto open = static_cast<std::size_t>(std::ranges::count(open_, 1));
        results_.counts.double_double += (count_ - open) * (problems_.is_paired ? 1 : problems_.primitives.size());
        if (open > 0) find_pairs([this](std::size_t i) { return open_[i] != 0; });
    }

private:
    /// Columns of the rays and their ranges, for one shape.
    [[nodiscard]] ProblemColumns<double> columns_for(Shape shape) const {
        return {.size = count_,
                .ray = rays_.words,
                .shape = shape,
                .primitive = {},
                .tmin = rays_.tmin,
                .tmax = rays_.tmax,
                .open_ends = problems_.rays.open_ends,
                .matrix = {},
                .ray_low = rays_.low};
    }

    /// Tests every ray against one primitive, and stores the hits that come first.
    void test_primitive(std::size_t primitive_index) {
        limit_.stop.check();
        const Primitive<S> primitive = problems_.primitives[primitive_index];
        const Primitive<double> words = convert_numbers(primitive, [](const S& x) { return nearest_double(x); });
        const Primitive<double> low = convert_numbers(primitive, [](const S& x) { return nearest_low_double(x); });
        ProblemColumns<double> columns = columns_for(primitive.shape);
        const auto set_columns = [](const Primitive<double>& from, auto& to) {
            for (std::size_t k = 0; k < from.shape_numbers().size(); ++k) to[k] = std::span(&from.numbers[k], 1);
            for (std::size_t k = max_number_count; from.transform && k < max_primitive_number_count; ++k)
                to[k] = std::span(&from.transform->matrix[k - max_number_count], 1);
        };
        set_columns(words, columns.primitive);
        columns.matrix = matrix_kind_of(primitive);
        if constexpr (two_words) set_columns(low, columns.primitive_low);
        test_columns(columns, primitive_index == 0,
                     [primitive_index](std::size_t) { return static_cast<std::int32_t>(primitive_index); });
    }

    static stages::MatrixKind matrix_kind_of(const Primitive<S>& primitive) {
        return primitive.transform
                   ? stages::MatrixKind{true, primitive.transform->is_inverse, primitive.transform->orientation}
                   : stages::MatrixKind{};
    }

    /// Tests every ray against the primitive that it is paired with.
    void test_paired_primitives() {
        limit_.stop.check();
        if (problems_.primitives[begin_].transform) {  // each primitive has a matrix of its own
            std::ranges::fill(open_, 1);
            return;
        }
        const Shape shape = problems_.primitives[begin_].shape;
        const std::size_t number_count = row_of(shape).number_count;
        std::array<std::vector<double>, 2 * max_number_count> buffers;
        for (auto& column : buffers) column.resize(count_);
        for (std::size_t i = 0; i < count_; ++i) {
            const Primitive<S> primitive = problems_.primitives[begin_ + i];
            for (std::size_t k = 0; k < number_count; ++k)
                buffers[k][i] = nearest_double(primitive.numbers[k]),
                buffers[number_count + k][i] = nearest_low_double(primitive.numbers[k]);
        }
        ProblemColumns<double> columns = columns_for(shape);
        for (std::size_t k = 0; k < number_count; ++k) columns.primitive[k] = buffers[k];
        for (std::size_t k = 0; two_words && k < number_count; ++k)
            columns.primitive_low[k] = buffers[number_count + k];
        test_columns(columns, true, [this](std::size_t i) { return static_cast<std::int32_t>(begin_ + i); });
    }

    /// Tests every ray against its primitive of these columns, whose index is `primitive_of(ray)`. If `is_first`, no
    /// primitive was tested before, and the results are written to the output directly.
    template <class PrimitiveOf>
    void test_columns(const ProblemColumns<double>& columns, bool is_first, const PrimitiveOf& primitive_of) {
        const stages::Stages stages = stages::stages_of(columns.shape, isa_);
        const ProblemsInPlace<double> rays(columns);
        const auto run_stage = [&](const stages::RawFindings& found) {
            rays.settle(stages.double_double, stages.lanes, 0, count_, found);
            for (std::size_t i = 0; i < count_; ++i) open_[i] |= static_cast<std::uint8_t>(found.settled[i] == 0);
        };

        if (is_first) {
            auto* const hit = reinterpret_cast<std::uint8_t*>(out_.decision.data()) + begin_;
            const auto from_begin = [this](std::vector<double>& column) { return column.data() + begin_; };
            std::uint8_t settled[batch_size];
            const auto length = [&](RayTruths::Lengths& lengths) {
                return stages::RawLength{from_begin(lengths.hi), from_begin(lengths.lo), from_begin(lengths.bound)};
            };
            run_stage({settled, hit, length(out_.t), length(out_.distance)});
            for (std::size_t i = 0; i < count_; ++i) out_.primitive[begin_ + i] = hit[i] != 0 ? primitive_of(i) : -1;
            return;
        }

        BatchFindings& found = GatheredProblems<double>::for_thread(shape_rows.front().shape).findings;
        run_stage(found.raw());
        for (std::size_t i = 0; i < count_; ++i)
            if (found.hit[i] != 0) store_if_nearest(found, i, primitive_of(i));
    }

    /// Stores the hit of ray i at `primitive` if it comes before the hits that are stored. If the first words do not
    /// decide the order, the ray stays open.
    void store_if_nearest(const BatchFindings& found, std::size_t i, std::int32_t primitive) {
        // The first words order two lengths that differ by 2^-40 of themselves: the second words and both bounds are
        // far smaller.
        constexpr double nearer = 1 - 0x1p-40, farther = 1 + 0x1p-40;
        const std::size_t ray = begin_ + i;
        if (out_.primitive[ray] >= 0) {
            const double best = out_.t.hi[ray];
            if (found.hi[i] > best * farther) return;
            if (!(found.hi[i] < best * nearer)) open_[i] = 1;
        }
        out_.decision[ray] = Truth::Decision::hit;
        out_.primitive[ray] = primitive;
        out_.t.hi[ray] = found.hi[i];
        out_.t.lo[ray] = found.lo[i];
        out_.t.bound[ray] = found.bound[i];
        out_.distance.hi[ray] = found.distance_hi[i];
        out_.distance.lo[ray] = found.distance_lo[i];
        out_.distance.bound[ray] = found.distance_bound[i];
    }

    struct RayAndPrimitive {
        std::size_t ray;  ///< index, counted from `begin_`
        std::uint32_t primitive;
        Truth truth;
    };

    /// Finds the truths of all rays for which `is_wanted(i)` is true: settles each pair of such a ray and a primitive
    /// that it can meet, and merges the results ray by ray.
    template <class IsWanted>
    void find_pairs(const IsWanted& is_wanted) {
        for (const ShapeRow& shape_row : shape_rows) gathered_problems(shape_row.shape).size = 0;
        matrices_.fill({});
        std::vector<std::size_t> batch;
        for (std::size_t i = 0; i < count_; ++i) {
            if (is_wanted(i)) batch.push_back(i);
            if (batch.empty() || (problems_.index && batch.size() < candidate_batch_size && i + 1 < count_)) continue;
            limit_.stop.check();
            if (problems_.index) find_candidates(batch);
            for (std::size_t k = 0; k < batch.size(); ++k) {
                add_pairs(batch[k], k);
                if (pairs_.size() >= batch_size) merge_pairs();
            }
            batch.clear();
        }
        merge_pairs();
    }

    /// Finds the candidates of these rays, and loads the primitives into the cache.
    void find_candidates(std::span<const std::size_t> rays) {
        std::array<Ray<double>, candidate_batch_size> first_words;
        for (std::size_t k = 0; k < rays.size(); ++k)
            for (int c = 0; c < 3; ++c) {
                first_words[k].origin[c] = rays_.words[c][rays[k]];
                first_words[k].direction[c] = rays_.words[static_cast<std::size_t>(c) + 3][rays[k]];
            }
        candidates_.clear();
        problems_.index->append_candidates(std::span(first_words).first(rays.size()), candidates_, candidate_ends_);
        problems_.primitives.prefetch(candidates_);
    }

    /// Adds the pairs of ray i, which is the k-th ray of the batch whose candidates were found.
    void add_pairs(std::size_t i, std::size_t k) {
        pair_rays_.push_back(i);
        if (problems_.index) {
            for (std::size_t candidate = k == 0 ? 0 : candidate_ends_[k - 1]; candidate < candidate_ends_[k];
                 ++candidate)
                add_pair(i, candidates_[candidate]);
        } else if (problems_.is_paired) {
            add_pair(i, static_cast<std::uint32_t>(begin_ + i));
        } else {
            for (std::size_t primitive = 0; primitive < problems_.primitives.size(); ++primitive)
                add_pair(i, static_cast<std::uint32_t>(primitive));
        }
    }

    void add_pair(std::size_t i, std::uint32_t primitive_index) {
        const Primitive<S> primitive = problems_.primitives[primitive_index];
        GatheredProblems<double>& target = gathered_problems(primitive.shape);

        // All gathered problems of a shape have one kind of matrix, so another kind settles those before.
        stages::MatrixKind& matrix = matrices_[static_cast<std::size_t>(primitive.shape)];
        if (const auto matrix_kind = matrix_kind_of(primitive); !(matrix_kind == matrix)) {
            settle(primitive.shape);
            matrix = matrix_kind;
        }

        // First words of the ray and the primitive, the range, and then second words
        const auto set_ray_columns = [&](std::size_t first, const SixColumns& source) {
            for (std::size_t k = 0; k < 6; ++k) target.numbers[first + k][target.size] = source[k][i];
        };
        set_ray_columns(first_ray_column, rays_.words);
        const auto set_primitive_columns = [&](std::size_t first, const Primitive<double>& numbers) {
            target.set_numbers(first, numbers.numbers);
            if (numbers.transform) target.set_numbers(first + max_number_count, numbers.transform->matrix);
        };
        set_primitive_columns(first_primitive_column,
                              convert_numbers(primitive, [](const S& x) { return nearest_double(x); }));
        target.numbers[tmin_column][target.size] = rays_.tmin.empty() ? 0 : rays_.tmin[i];
        target.numbers[tmax_column][target.size] = rays_.tmax.empty() ? HUGE_VAL : rays_.tmax[i];
        if constexpr (two_words) {
            set_ray_columns(first_low_column, rays_.low);
            set_primitive_columns(first_low_column + 6,
                                  convert_numbers(primitive, [](const S& x) { return nearest_low_double(x); }));
        }

        pair_indices(primitive.shape)[target.size++] = pairs_.size();
        pairs_.push_back({i, primitive_index, {}});
        if (target.size == batch_size) settle(primitive.shape);
    }

    static GatheredProblems<double>& gathered_problems(Shape shape) {
        return GatheredProblems<double>::for_thread(shape);
    }
    std::array<std::size_t, batch_size>& pair_indices(Shape shape) {
        return pair_indices_[static_cast<std::size_t>(shape)];
    }

    /// Settles the gathered pairs of one shape, and empties their buffer.
    void settle(Shape shape) {
        GatheredProblems<double>& problems = gathered_problems(shape);
        if (problems.size == 0) return;
        std::vector<std::size_t> open_pairs(problems.size);
        std::iota(open_pairs.begin(), open_pairs.end(), std::size_t{0});
        // Without an index, columns in two words with bounds were tried before, and the pairs that they left open are
        // often ties. If a ray has only one pair, such columns would leave it open again.
        const bool ties_first = !problems_.index && stages::stages_of(shape, isa_).ties_first;
        if (ties_first) settle_ties(shape, open_pairs);
        if (!open_pairs.empty() && !columns_left_all_open()) settle_gathered(shape, open_pairs);
        if (!ties_first) settle_ties(shape, open_pairs);
        for (const std::size_t k : open_pairs) settle_pair(pairs_[pair_indices(shape)[k]]);
        problems.size = 0;
    }
    /// True if columns in two words with bounds were tried before and left all gathered pairs open.
    [[nodiscard]] bool columns_left_all_open() const {
        if (problems_.index) return false;
        return problems_.is_paired ? !problems_.primitives[begin_].transform : problems_.primitives.size() == 1;
    }
    /// Settles the gathered pairs of one shape that are in `open_pairs`. Pairs that stay open remain there.
    void settle_gathered(Shape shape, std::vector<std::size_t>& open_pairs) {
        const stages::Stages stages = stages::stages_of(shape, isa_);
        auto& problems = gathered_problems(shape);
        auto raw = problems.added_problems(stages.lanes, two_words);
        raw.open_ends = problems_.rays.open_ends;
        raw.has_ranges = has_ranges_;
        raw.matrix = matrices_[static_cast<std::size_t>(shape)];
        stages.double_double(raw);
        store_findings(problems.findings, shape, open_pairs, [&open_pairs](std::size_t k) { return open_pairs[k]; });
    }
    /// Settles pairs in which a ray may touch its primitive or start on it, if the stages have such code for the shape.
    void settle_ties(Shape shape, std::vector<std::size_t>& open_pairs) {
        const stages::Stages stages = stages::stages_of(shape, isa_);
        const bool are_plain = !two_words && !has_ranges_ && !matrices_[static_cast<std::size_t>(shape)].exists;
        if (open_pairs.empty() || !stages.ties || !are_plain) return;
        GatheredProblems<double>& ties = GatheredProblems<double>::for_thread();
        stages.ties(ties.gather(gathered_problems(shape).columns(shape), open_pairs, stages.lanes));
        store_findings(ties.findings, shape, open_pairs, [](std::size_t k) { return k; });
    }
    /// Stores the findings on the pairs of `open_pairs`; that on `open_pairs[k]` has the index `index_of(k)`. Pairs
    /// that stay open remain in `open_pairs`.
    template <class IndexOf>
    void store_findings(const BatchFindings& found, Shape shape, std::vector<std::size_t>& open_pairs,
                        const IndexOf& index_of) {
        std::size_t open_count = 0;
        for (std::size_t k = 0; k < open_pairs.size(); ++k) {
            if (found.settled[index_of(k)] == 0) open_pairs[open_count++] = open_pairs[k];
            else store_finding(found, index_of(k), pairs_[pair_indices(shape)[open_pairs[k]]]);
        }
        open_pairs.resize(open_count);
    }
    void store_finding(const BatchFindings& found, std::size_t k, RayAndPrimitive& pair) {
        ++results_.counts.double_double;
        pair.truth.proof_bits = 106;
        if (found.hit[k] == 0) return;
        pair.truth.decision = Truth::Decision::hit;
        pair.truth.primitive = 0;
        pair.truth.touches = found.touches[k] != 0;
        pair.truth.on_surface = found.on_surface[k] != 0;
        pair.truth.t = make_certified(found.hi[k], found.lo[k], found.bound[k]);
        pair.truth.distance = make_certified(found.distance_hi[k], found.distance_lo[k], found.distance_bound[k]);
    }

    /// Settles a pair that all columns left open.
    void settle_pair(RayAndPrimitive& pair) {
        const std::size_t ray = begin_ + pair.ray;
        pair.truth = find_truth(problems_.rays[ray], problems_.primitives[pair.primitive], limit_, {},
                                problems_.rays.range(ray));
        results_.counts.count_single(pair.truth);
    }

    /// Settles the pairs that are left, and stores the truth of each of their rays.
    void merge_pairs() {
        for (const ShapeRow& shape_row : shape_rows) settle(shape_row.shape);
        auto pair = pairs_.cbegin();
        for (const std::size_t i : pair_rays_) {
            Truth best;
            for (; pair != pairs_.cend() && pair->ray == i; ++pair)
                merge_truth(pair->truth, static_cast<int>(pair->primitive), best);
            if (!out_.store(begin_ + i, best)) results_.complete_truths.emplace_back(begin_ + i, best);
        }
        pairs_.clear();
        pair_rays_.clear();
    }

    const RaysAndPrimitives<S>& problems_;
    ProofLimit limit_;
    std::size_t begin_, count_;
    WordColumns<S> rays_;
    RayTruths& out_;
    ThreadResults& results_;
    intersect::simd::Isa isa_;
    bool has_ranges_;
    std::vector<std::uint8_t> open_;      ///< 1 for each ray that columns do not settle
    std::vector<std::size_t> pair_rays_;  ///< rays whose pairs are in `pairs_`
    std::vector<RayAndPrimitive> pairs_;
    /// Indices into `pairs_` of the gathered pairs, by shape.
    std::array<std::array<std::size_t, batch_size>, shape_rows.size()> pair_indices_;
    std::array<stages::MatrixKind, shape_rows.size()> matrices_;  ///< kind of matrix of the gathered pairs, by shape
    static constexpr std::size_t candidate_batch_size = 64;
    std::vector<std::uint32_t> candidates_;  ///< candidates of a batch of rays, one ray after the other
    /// Index in `candidates_` after those of each ray of the batch.
    std::array<std::size_t, candidate_batch_size> candidate_ends_;
};

template <class S>
StageCounts find_truths_of_rays(const RaysAndPrimitives<S>& problems, ProofLimit limit, RayTruths& out) {
    const std::size_t ray_count = problems.rays.size();
    out.resize(ray_count);
    tbb::combinable<ThreadResults> results_by_thread;
    const auto find = [&](std::size_t begin, std::size_t end) {
        intersect::process::require_standard("the truth of rays");
        BlockSearch<S>(problems, limit, begin, end, out, results_by_thread.local()).find();
    };

    // A single block needs no parallel loop.
    if (ray_count <= batch_size) {
        find(0, ray_count);
    } else {
        intersect::process::in_parallel(
            std::size_t{0}, (ray_count + batch_size - 1) / batch_size,
            [&](std::size_t block) { find(block * batch_size, std::min(ray_count, (block + 1) * batch_size)); });
    }

    StageCounts counts;
    out.complete_truths.clear();
    results_by_thread.combine_each([&](const ThreadResults& results) {
        counts += results.counts;
        out.complete_truths.insert(out.complete_truths.end(), results.complete_truths.begin(),
                                   results.complete_truths.end());
    });
    std::ranges::sort(out.complete_truths, {}, &std::pair<std::size_t, Truth>::first);
    return counts;
}

}  // namespace

StageCounts find_truths(const RaysAndPrimitives<double>& problems, ProofLimit limit, RayTruths& out) {
    return find_truths_of_rays(problems, limit, out);
}
StageCounts find_truths(const RaysAndPrimitives<Real>& problems, ProofLimit limit, RayTruths& out) {
    return find_truths_of_rays(problems, limit, out);
}

}  // namespace lostbits::measure::truth
