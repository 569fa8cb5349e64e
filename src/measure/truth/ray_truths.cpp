// Truth of rays among primitives. Each primitive is tested against whole columns of rays. If a ray can meet only a few
// primitives, or if columns cannot decide which one comes first, pairs of one ray and one primitive are tested instead.
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

/// Truths that columns cannot hold, with the indices of their rays, and counts of the stages that settled the truths.
struct UnsettledTruths {
    StageCounts counts;
    std::vector<std::pair<std::size_t, Truth>> whole;
};

/// Finds the truths of rays begin to end, at most `settled_together`.
template <class S>
class BlockSearch {
public:
    static constexpr bool two_words = !std::is_same_v<S, double>;

    BlockSearch(const RaysAndPrimitives<S>& problems, TruthLimit limit, std::size_t begin, std::size_t end,
                RayTruths& out, UnsettledTruths& rest)
        : problems_(problems),
          limit_(limit),
          begin_(begin),
          count_(end - begin),
          rays_(problems.rays, begin, end),
          out_(out),
          rest_(rest),
          isa_(intersect::simd::current_isa()),
          ranged_(have_ranges(rays_.tmin, rays_.tmax, problems.rays.open)) {}

    /// Finds the truths. With an index, each ray is tested against its candidates; without one, each primitive is
    /// tested against whole columns of rays.
    void find() {
        if (problems_.index) return find_pairs([](std::size_t) { return true; });
        open_.assign(count_, 0);
        if (problems_.paired) meet_own();
        else
            for (std::size_t s = 0; s < problems_.primitives.size(); ++s) meet(s);
        const auto open = static_cast<std::size_t>(std::ranges::count(open_, 1));
        rest_.counts.double_double += (count_ - open) * (problems_.paired ? 1 : problems_.primitives.size());
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
                .open = problems_.rays.open,
                .matrix = {},
                .ray_low = rays_.low};
    }

    /// Tests every ray against one primitive, and keeps the hits that come first.
    void meet(std::size_t s) {
        limit_.stop.check();
        const Primitive<S> primitive = problems_.primitives[s];
        const Primitive<double> words = transformed(primitive, [](const S& x) { return word_of(x); });
        const Primitive<double> low = transformed(primitive, [](const S& x) { return low_word_of(x); });
        ProblemColumns<double> columns = columns_for(primitive.shape);
        const auto put = [](const Primitive<double>& from, auto& to) {
            for (std::size_t k = 0; k < from.used().size(); ++k) to[k] = std::span(&from.numbers[k], 1);
            for (std::size_t k = most_numbers; from.placed && k < most_stored; ++k)
                to[k] = std::span(&from.placed->matrix[k - most_numbers], 1);
        };
        put(words, columns.primitive);
        columns.matrix = under_matrix(primitive);
        if constexpr (two_words) put(low, columns.primitive_low);
        meet(columns, s == 0, [s](std::size_t) { return static_cast<std::int32_t>(s); });
    }

    static stages::UnderMatrix under_matrix(const Primitive<S>& primitive) {
        return primitive.placed ? stages::UnderMatrix{true, primitive.placed->is_inverse, primitive.placed->orientation}
                                : stages::UnderMatrix{};
    }

    /// Tests every ray against the primitive that it is paired with.
    void meet_own() {
        limit_.stop.check();
        if (problems_.primitives[begin_].placed) {  // each has a matrix of its own
            std::ranges::fill(open_, 1);
            return;
        }
        const Shape shape = problems_.primitives[begin_].shape;
        const std::size_t numbers = row_of(shape).numbers;
        std::array<std::vector<double>, 2 * most_numbers> buffers;
        for (auto& column : buffers) column.resize(count_);
        for (std::size_t i = 0; i < count_; ++i) {
            const Primitive<S> primitive = problems_.primitives[begin_ + i];
            for (std::size_t k = 0; k < numbers; ++k)
                buffers[k][i] = word_of(primitive.numbers[k]),
                buffers[numbers + k][i] = low_word_of(primitive.numbers[k]);
        }
        ProblemColumns<double> columns = columns_for(shape);
        for (std::size_t k = 0; k < numbers; ++k) columns.primitive[k] = buffers[k];
        for (std::size_t k = 0; two_words && k < numbers; ++k) columns.primitive_low[k] = buffers[numbers + k];
        meet(columns, true, [this](std::size_t i) { return static_cast<std::int32_t>(begin_ + i); });
    }

    /// Tests every ray against its primitive of these columns, whose index is `place(ray)`. The results of the first
    /// primitive are written to the output directly.
    template <class Place>
    void meet(const ProblemColumns<double>& columns, bool is_first, const Place& place) {
        const stages::Stages stages = stages::stages_of(columns.shape, isa_);
        const ProblemsInPlace<double> rays(columns);
        const auto ask = [&](const stages::RawFindings& found) {
            rays.settle(stages.double_double, stages.lanes, 0, count_, found);
            for (std::size_t i = 0; i < count_; ++i) open_[i] |= static_cast<std::uint8_t>(found.settled[i] == 0);
        };
        if (is_first) {
            auto* const hit = reinterpret_cast<std::uint8_t*>(out_.decision.data()) + begin_;
            const auto at = [this](std::vector<double>& column) { return column.data() + begin_; };
            std::uint8_t settled[settled_together];
            const auto length = [&](RayTruths::Lengths& to) {
                return stages::RawLength{at(to.hi), at(to.lo), at(to.bound)};
            };
            ask({settled, hit, length(out_.t), length(out_.distance)});
            for (std::size_t i = 0; i < count_; ++i) out_.object[begin_ + i] = hit[i] != 0 ? place(i) : -1;
            return;
        }
        BatchFindings& found = GatheredProblems<double>::of_thread(shape_rows.front().shape).found;
        ask(found.raw());
        for (std::size_t i = 0; i < count_; ++i)
            if (found.hit[i] != 0) keep_nearest(found, i, place(i));
    }

    void keep_nearest(const BatchFindings& found, std::size_t i, std::int32_t place) {
        // Lengths that differ by 2^-40 are ordered by their first words: the second words and both bounds are far
        // smaller.
        constexpr double nearer = 1 - 0x1p-40, farther = 1 + 0x1p-40;
        const std::size_t to = begin_ + i;
        if (out_.object[to] >= 0) {
            const double best = out_.t.hi[to];
            if (found.hi[i] > best * farther) return;
            if (!(found.hi[i] < best * nearer)) open_[i] = 1;
        }
        out_.decision[to] = Truth::Decision::hit;
        out_.object[to] = place;
        out_.t.hi[to] = found.hi[i], out_.t.lo[to] = found.lo[i], out_.t.bound[to] = found.bound[i];
        out_.distance.hi[to] = found.distance_hi[i], out_.distance.lo[to] = found.distance_lo[i];
        out_.distance.bound[to] = found.distance_bound[i];
    }

    struct RayAndPrimitive {
        std::size_t ray;  ///< index, counted from `begin_`
        std::uint32_t primitive;
        Truth truth;
    };

    /// Finds the truths of all rays for which `wanted(i)` is true: settles each of them with every primitive that it
    /// can meet, and joins the results ray by ray.
    template <class Wanted>
    void find_pairs(const Wanted& wanted) {
        for (const ShapeRow& row : shape_rows) gathered(row.shape).size = 0;
        matrices_.fill({});
        std::vector<std::size_t> some;
        for (std::size_t i = 0; i < count_; ++i) {
            if (wanted(i)) some.push_back(i);
            if (some.empty() || (problems_.index && some.size() < found_together && i + 1 < count_)) continue;
            limit_.stop.check();
            if (problems_.index) find_candidates(some);
            for (std::size_t k = 0; k < some.size(); ++k) {
                add_pairs(some[k], k);
                if (pairs_.size() >= settled_together) join_pairs();
            }
            some.clear();
        }
        join_pairs();
    }

    /// Finds the candidates of some rays, and loads them into the cache.
    void find_candidates(std::span<const std::size_t> rays) {
        std::array<Ray<double>, found_together> words;
        for (std::size_t k = 0; k < rays.size(); ++k)
            for (int c = 0; c < 3; ++c) {
                words[k].origin[c] = rays_.words[static_cast<std::size_t>(c)][rays[k]];
                words[k].direction[c] = rays_.words[static_cast<std::size_t>(c) + 3][rays[k]];
            }
        candidates_.clear();
        problems_.index->append_candidates(std::span(words).first(rays.size()), candidates_, ends_);
        problems_.primitives.prefetch(candidates_);
    }

    /// Adds the pairs of ray i, the k-th ray whose candidates were found.
    void add_pairs(std::size_t i, std::size_t k) {
        asked_.push_back(i);
        if (problems_.index) {
            for (std::size_t c = k == 0 ? 0 : ends_[k - 1]; c < ends_[k]; ++c) add_pair(i, candidates_[c]);
        } else if (problems_.paired) {
            add_pair(i, static_cast<std::uint32_t>(begin_ + i));
        } else {
            for (std::size_t s = 0; s < problems_.primitives.size(); ++s) add_pair(i, static_cast<std::uint32_t>(s));
        }
    }

    void add_pair(std::size_t i, std::uint32_t s) {
        const Primitive<S> primitive = problems_.primitives[s];
        GatheredProblems<double>& to = gathered(primitive.shape);
        stages::UnderMatrix& matrix = matrices_[static_cast<std::size_t>(primitive.shape)];
        if (const auto its = under_matrix(primitive); !(its == matrix)) {
            settle(primitive.shape);
            matrix = its;
        }
        const auto words_of_ray = [&](std::size_t first, const Spans& from) {
            for (std::size_t k = 0; k < 6; ++k) to.numbers[first + k][to.size] = from[k][i];
        };
        words_of_ray(first_of_ray, rays_.words);
        const auto put = [&](std::size_t first, const Primitive<double>& words) {
            to.set(first, words.numbers);
            if (words.placed) to.set(first + most_numbers, words.placed->matrix);
        };
        put(first_of_primitive, transformed(primitive, [](const S& x) { return word_of(x); }));
        to.numbers[place_of_tmin][to.size] = rays_.tmin.empty() ? 0 : rays_.tmin[i];
        to.numbers[place_of_tmax][to.size] = rays_.tmax.empty() ? HUGE_VAL : rays_.tmax[i];
        if constexpr (two_words) {
            words_of_ray(first_of_low, rays_.low);
            put(first_of_low + 6, transformed(primitive, [](const S& x) { return low_word_of(x); }));
        }
        places(primitive.shape)[to.size++] = pairs_.size();
        pairs_.push_back({i, s, {}});
        if (to.size == settled_together) settle(primitive.shape);
    }

    static GatheredProblems<double>& gathered(Shape shape) { return GatheredProblems<double>::of_thread(shape); }
    std::array<std::size_t, settled_together>& places(Shape shape) { return places_[static_cast<std::size_t>(shape)]; }

    void settle(Shape shape) {
        GatheredProblems<double>& together = gathered(shape);
        if (together.size == 0) return;
        std::vector<std::size_t> left(together.size);
        std::iota(left.begin(), left.end(), std::size_t{0});
        // Without an index, columns in two words with bounds were tried before, and the pairs that they leave open are
        // often ties. A pair that is the only one of its ray would stay open in them again.
        const bool ties_first = !problems_.index && stages::stages_of(shape, isa_).ties_first;
        if (ties_first) settle_ties(shape, left);
        if (!left.empty() && !are_tried()) settle_gathered(shape, left);
        if (!ties_first) settle_ties(shape, left);
        for (const std::size_t k : left) settle_alone(pairs_[places(shape)[k]]);
        together.size = 0;
    }
    /// True if columns in two words with bounds left all gathered pairs open.
    [[nodiscard]] bool are_tried() const {
        if (problems_.index) return false;
        return problems_.paired ? !problems_.primitives[begin_].placed : problems_.primitives.size() == 1;
    }
    /// Settles the gathered pairs of one shape that are in `left`. Pairs that stay open remain in `left`.
    void settle_gathered(Shape shape, std::vector<std::size_t>& left) {
        const stages::Stages stages = stages::stages_of(shape, isa_);
        auto& together = gathered(shape);
        auto raw = together.added(stages.lanes, two_words);
        raw.open = problems_.rays.open, raw.ranged = ranged_;
        raw.matrix = matrices_[static_cast<std::size_t>(shape)];
        stages.double_double(raw);
        take(together.found, shape, left, [&left](std::size_t k) { return left[k]; });
    }
    void settle_ties(Shape shape, std::vector<std::size_t>& left) {
        const stages::Stages stages = stages::stages_of(shape, isa_);
        const bool are_plain = !two_words && !ranged_ && !matrices_[static_cast<std::size_t>(shape)].placed;
        if (left.empty() || !stages.ties || !are_plain) return;
        GatheredProblems<double>& ties = GatheredProblems<double>::of_thread();
        stages.ties(ties.gather(gathered(shape).columns(shape), left, stages.lanes));
        take(ties.found, shape, left, [](std::size_t k) { return k; });
    }
    /// Copies the findings on the pairs of `left`, each at `place(k)`. Pairs that stay open remain in `left`.
    template <class Place>
    void take(const BatchFindings& found, Shape shape, std::vector<std::size_t>& left, const Place& place) {
        std::size_t still = 0;
        for (std::size_t k = 0; k < left.size(); ++k) {
            if (found.settled[place(k)] == 0) left[still++] = left[k];
            else settle(found, place(k), pairs_[places(shape)[left[k]]]);
        }
        left.resize(still);
    }
    void settle(const BatchFindings& found, std::size_t k, RayAndPrimitive& pair) {
        ++rest_.counts.double_double;
        pair.truth.bits = 106;
        if (found.hit[k] == 0) return;
        pair.truth.decision = Truth::Decision::hit;
        pair.truth.object = 0;
        pair.truth.touches = found.touches[k] != 0;
        pair.truth.on_surface = found.on_surface[k] != 0;
        pair.truth.t = certified(found.hi[k], found.lo[k], found.bound[k]);
        pair.truth.distance = certified(found.distance_hi[k], found.distance_lo[k], found.distance_bound[k]);
    }

    void settle_alone(RayAndPrimitive& pair) {
        const std::size_t ray = begin_ + pair.ray;
        pair.truth = find_truth(problems_.rays[ray], problems_.primitives[pair.primitive], limit_, {},
                                problems_.rays.range(ray));
        rest_.counts.count_alone(pair.truth);
    }

    void join_pairs() {
        for (const ShapeRow& row : shape_rows) settle(row.shape);
        auto pair = pairs_.cbegin();
        for (const std::size_t i : asked_) {
            Truth best;
            for (; pair != pairs_.cend() && pair->ray == i; ++pair)
                join(pair->truth, static_cast<int>(pair->primitive), best);
            if (!out_.put(begin_ + i, best)) rest_.whole.emplace_back(begin_ + i, best);
        }
        pairs_.clear();
        asked_.clear();
    }

    const RaysAndPrimitives<S>& problems_;
    TruthLimit limit_;
    std::size_t begin_, count_;
    WordColumns<S> rays_;
    RayTruths& out_;
    UnsettledTruths& rest_;
    intersect::simd::Isa isa_;
    bool ranged_;
    std::vector<std::uint8_t> open_;  ///< 1: columns do not settle the ray
    std::vector<std::size_t> asked_;  ///< rays whose pairs are in `pairs_`
    std::vector<RayAndPrimitive> pairs_;
    std::array<std::array<std::size_t, settled_together>, shape_rows.size()>
        places_;  ///< indices into `pairs_` of the pairs that are gathered, by shape
    std::array<stages::UnderMatrix, shape_rows.size()> matrices_;  ///< kind of matrix of these pairs, by shape
    static constexpr std::size_t found_together = 64;
    std::vector<std::uint32_t> candidates_;         ///< candidates of some rays
    std::array<std::size_t, found_together> ends_;  ///< number of candidates up to each of these rays
};

template <class S>
StageCounts find_all(const RaysAndPrimitives<S>& problems, TruthLimit limit, RayTruths& out) {
    const std::size_t n = problems.rays.size();
    out.resize(n);
    tbb::combinable<UnsettledTruths> rests;
    const auto find = [&](std::size_t begin, std::size_t end) {
        intersect::process::require_standard("the truth of rays");
        BlockSearch<S>(problems, limit, begin, end, out, rests.local()).find();
    };
    if (n <= settled_together) {
        find(0, n);
    } else {
        intersect::process::in_parallel(
            std::size_t{0}, (n + settled_together - 1) / settled_together,
            [&](std::size_t block) { find(block * settled_together, std::min(n, (block + 1) * settled_together)); });
    }
    StageCounts counts;
    out.whole.clear();
    rests.combine_each([&](const UnsettledTruths& rest) {
        counts += rest.counts;
        out.whole.insert(out.whole.end(), rest.whole.begin(), rest.whole.end());
    });
    std::ranges::sort(out.whole, {}, &std::pair<std::size_t, Truth>::first);
    return counts;
}

}  // namespace

StageCounts find_truths(const RaysAndPrimitives<double>& problems, TruthLimit limit, RayTruths& out) {
    return find_all(problems, limit, out);
}
StageCounts find_truths(const RaysAndPrimitives<Real>& problems, TruthLimit limit, RayTruths& out) {
    return find_all(problems, limit, out);
}

}  // namespace lostbits::measure::truth
