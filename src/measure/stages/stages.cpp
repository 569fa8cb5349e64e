#include "measure/stages/stages.hpp"

#include <map>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <tuple>

#include "intersect/simd/of_width.hpp"
#include "measure/stages/column_run.hpp"
#include "measure/stages/stage_program.hpp"

namespace lostbits::measure::stages {

using intersect::simd::Isa;

namespace {

/// Returns the table that `fill` fills. `fill` is itself compiled for its register width, so it must not be called for
/// a width that the machine lacks.
#if defined(LOSTBITS_HAS_W256) || defined(LOSTBITS_HAS_W512)
constexpr auto fill_wide_stages = fill_stages_w256;
#else
constexpr void (*fill_wide_stages)(RawStages&) = nullptr;
#endif

/// Registers of 512 bits use the kernels of 256 bits. Maps then take 3 to 4 % more processor time than with
/// kernels for 512 bits, which were slow to compile and were removed.
const RawStages& kernels_at(Isa isa) {
    static constexpr intersect::simd::FunctionOfWidth<void(RawStages&)> fill{LOSTBITS_W128(fill_stages),
                                                                             fill_wide_stages, fill_wide_stages};
    return intersect::simd::with_width(intersect::simd::register_isa(isa), []<Isa width>() -> const RawStages& {
        static const RawStages kernels = [] {
            RawStages filled{};
            fill.at(width)(filled);
            return filled;
        }();
        return kernels;
    });
}

/// Cache of programs that are ready to run. The first use of a program records it.
class RunCache {
public:
    static const ColumnRun& of(const StageKey& key, const RawStages& kernels, std::uint64_t shared_inputs) {
        static RunCache cache;
        const RunKey run_key(key, &kernels, shared_inputs);
        {
            const std::shared_lock lock(cache.mutex_);
            const auto known = cache.runs_.find(run_key);
            if (known != cache.runs_.end()) return *known->second;
        }
        auto run = std::make_unique<ColumnRun>(record_stage(key), kernels.columns, shared_inputs);
        const std::unique_lock lock(cache.mutex_);
        return *cache.runs_.try_emplace(run_key, std::move(run)).first->second;
    }

private:
    using RunKey = std::tuple<StageKey, const RawStages*, std::uint64_t>;
    std::shared_mutex mutex_;
    std::map<RunKey, std::unique_ptr<ColumnRun>> runs_;
};

/// Sets bit k if input k is the same number for every problem, or is missing.
template <class S>
std::uint64_t shared_inputs_of(const RawProblems<S>& problems) {
    std::uint64_t shared = 0;
    const auto add_input = [&shared](std::size_t input, const RawColumn<S>& column) {
        if (column.step == 0) shared |= std::uint64_t{1} << input;
    };
    for (std::size_t k = 0; k < 6; ++k)
        add_input(input_of_ray + k, problems.ray[k]), add_input(input_of_ray_low + k, problems.ray_low[k]);
    for (std::size_t k = 0; k < max_primitive_number_count; ++k)
        add_input(input_of_primitive + k, problems.primitive[k]),
            add_input(input_of_primitive_low + k, problems.primitive_low[k]);
    add_input(input_of_tmin, problems.tmin), add_input(input_of_tmax, problems.tmax);
    static_assert(stage_input_count <= 64);
    return shared;
}

}  // namespace

template <class S>
void ShapeStage<S>::operator()(const RawProblems<S>& problems) const {
    if constexpr (std::is_same_v<S, double>) {
        if (arithmetic == Arithmetic::exact_sums) return kernels->ties[static_cast<std::size_t>(shape)](problems);
    }
    const StageKey key{.shape = shape,
                       .words = arithmetic == Arithmetic::one_word ? 1 : 2,
                       .two_words = problems.two_words,
                       .matrix = problems.matrix.exists ? problems.matrix : MatrixKind{},
                       .has_ranges = problems.has_ranges,
                       .open_ends = problems.has_ranges ? problems.open_ends : OpenEnds{},
                       .wants_t = problems.out.t.hi != nullptr,
                       .wants_distance = problems.out.distance.hi != nullptr};
    RunCache::of(key, *kernels, shared_inputs_of(problems))(problems);
}
template void ShapeStage<float>::operator()(const RawProblems<float>&) const;
template void ShapeStage<double>::operator()(const RawProblems<double>&) const;

Stages stages_of(Shape shape, Isa isa) {
    const RawStages& kernels = kernels_at(isa);
    const bool has_ties = kernels.ties[static_cast<std::size_t>(shape)] != nullptr;
    using Exact = ShapeStage<double>;
    return {.binary64 = {shape, ShapeStage<float>::Arithmetic::one_word, &kernels},
            .double_double = {shape, Exact::Arithmetic::two_words, &kernels},
            .ties = has_ties ? Exact{shape, Exact::Arithmetic::exact_sums, &kernels} : Exact{},
            .ties_first = has_ties && row_of(shape).is_flat,
            .unit_directions = kernels.unit_directions,
            .lanes = kernels.columns.lanes};
}

}  // namespace lostbits::measure::stages
