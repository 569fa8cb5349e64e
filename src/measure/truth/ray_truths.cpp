// Rays among solids as pairs of one ray and one solid, which are settled in packs and joined ray by ray.
#include <memory>

#include "measure/truth/gathered.hpp"
#include "measure/truth/truth_columns.hpp"
#include "number/error.hpp"

namespace lostbits::measure::truth {
namespace {

/// Room for `settled_together` pairs of a ray and a solid of one shape.
struct PairColumns {
    alignas(64) double numbers[most_columns][column_room];
    FoundTogether found;
    std::size_t places[settled_together];  ///< which of the pairs they are
    std::size_t size = 0;

    static constexpr std::size_t tmax = 12, low = 13;

    void set(std::size_t first, const Ray<double>& ray) {
        for (int i = 0; i < 3; ++i) {
            numbers[first + static_cast<std::size_t>(i)][size] = ray.origin[i];
            numbers[first + static_cast<std::size_t>(i) + 3][size] = ray.direction[i];
        }
    }
    void set(std::size_t first, const Solid<double>& solid) {
        for (std::size_t k = 0; k < 6; ++k) numbers[first + k][size] = solid.numbers[k];
    }
    stages::RawProblems<double> raw(std::size_t lanes) {
        auto problems = stages::raw_problems<double>((size + lanes - 1) / lanes * lanes, found.raw());
        for (auto& column : numbers) std::fill(column + size, column + problems.size, column[size - 1]);
        for (std::size_t k = 0; k < 6; ++k) {
            problems.ray[k] = {numbers[k], 1};
            problems.solid[k] = {numbers[6 + k], 1};
            problems.ray_low[k] = {numbers[low + k], 1};
            problems.solid_low[k] = {numbers[low + 6 + k], 1};
        }
        problems.tmax = {numbers[tmax], 1};
        return problems;
    }
};

/// The pairs of some rays in order, and their truths.
class PairSearch {
public:
    PairSearch(const RaysAndSolids& problems, StageCounts& counts)
        : problems_(problems), counts_(counts), isa_(intersect::simd::current_isa()) {}

    void add(std::size_t ray) {
        problems_.candidates(ray, candidates_);
        if (candidates_.empty()) return;
        const Ray<double> words = problems_.ray(ray);
        const Ray<double> low = problems_.ray_low ? problems_.ray_low(ray) : Ray<double>{};
        for (const std::uint32_t solid : candidates_) {
            const Solid<double> numbers = problems_.solid(solid);
            PairColumns& columns = columns_of(numbers.shape);
            columns.set(0, words);
            columns.set(6, numbers);
            columns.numbers[PairColumns::tmax][columns.size] = problems_.tmax(ray);
            if (problems_.ray_low) {
                columns.set(PairColumns::low, low);
                columns.set(PairColumns::low + 6, problems_.solid_low(solid));
            }
            columns.places[columns.size++] = pairs_.size();
            pairs_.push_back({ray, solid});
            if (columns.size == settled_together) settle(numbers.shape);
        }
    }
    [[nodiscard]] std::size_t size() const { return pairs_.size(); }

    void finish(std::span<Truth> out) {
        settle(Shape::sphere);
        settle(Shape::box);
        for (std::size_t k = 0; k < pairs_.size(); ++k)
            join(truths_[k], static_cast<int>(pairs_[k].solid), out[pairs_[k].ray]);
        pairs_.clear();
    }

private:
    struct Pair {
        std::size_t ray;
        std::uint32_t solid;
    };

    /// Kept by the thread: a family asks for one ray at a time, a thousand times.
    static PairColumns& columns_of(Shape shape) {
        thread_local std::unique_ptr<PairColumns> columns[2];
        auto& wanted = columns[shape == Shape::box ? 1 : 0];
        if (!wanted) wanted = std::make_unique<PairColumns>();
        return *wanted;
    }

    void settle(Shape shape) {
        PairColumns& columns = columns_of(shape);
        if (columns.size == 0) return;
        const auto& stages = stages::stages_of(shape, isa_);
        constexpr auto both = static_cast<std::size_t>(stages::Wanted::both);
        const auto stage = problems_.ray_low ? stages.kernels.of_two_words[both] : stages.kernels.double_double[both];
        stage(columns.raw(stages.lanes));
        truths_.resize(std::max(truths_.size(), pairs_.size()));
        for (std::size_t k = 0; k < columns.size; ++k) truths_[columns.places[k]] = truth_of(columns, k);
        columns.size = 0;
    }

    Truth truth_of(const PairColumns& columns, std::size_t k) {
        const FoundTogether& found = columns.found;
        if (found.settled[k] == 0) {
            const Pair pair = pairs_[columns.places[k]];
            const Truth truth = problems_.alone(pair.ray, pair.solid);
            ++(truth.bits <= 106 ? counts_.ball : counts_.interval);
            return truth;
        }
        ++counts_.double_double;
        Truth truth;
        truth.bits = 106;
        if (found.hit[k] == 0) return truth;
        truth.decision = Truth::Decision::hit;
        truth.object = 0;
        truth.t = certified(found.hi[k], found.lo[k], found.bound[k]);
        truth.distance = certified(found.distance_hi[k], found.distance_lo[k], found.distance_bound[k]);
        return truth;
    }

    const RaysAndSolids& problems_;
    StageCounts& counts_;
    intersect::simd::Isa isa_;
    std::vector<Pair> pairs_;
    std::vector<Truth> truths_;
    std::vector<std::uint32_t> candidates_;
};

}  // namespace

void find_truths(const RaysAndSolids& problems, std::span<Truth> out, StageCounts& stages) {
    std::ranges::fill(out, Truth{});
    PairSearch search(problems, stages);
    for (std::size_t ray = 0; ray < problems.rays; ++ray) {
        stop_if_interrupted();
        search.add(ray);
        if (search.size() >= settled_together) search.finish(out);
    }
    search.finish(out);
}

}  // namespace lostbits::measure::truth
