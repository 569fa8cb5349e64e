// Trade-off: measured speed against measured accuracy, for every form, format and register width, in one run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/trade/timing_work.hpp"

namespace lostbits::measure::trade {

/// Callable kernel: a form in a native format over registers of one width. Kernels of one form and format with the same
/// `measured` give the same bits.
struct TradeKernel {
    evaluate::TestedForm measured;                                    ///< the row that has its accuracy
    std::string_view isa;                                             ///< `scalar`, `128`, ...
    decltype(intersect::table::Intersector::native32) f32 = nullptr;  ///< set for f32; `f64` is set for f64
    decltype(intersect::table::Intersector::native64) f64 = nullptr;
};

/// All kernels of the selected forms in f32 and f64 on every available instruction set, in the order of the forms, then
/// widths.
std::vector<TradeKernel> make_trade_kernels(const std::vector<evaluate::TestedForm>& tested_forms);

/// Rays that a kernel is timed on: the size of the rays with their answers, and the share that hits.
struct TradeLoad {
    std::string_view working_set;  ///< `l1`, `l2`, `memory`; `scene`: rays of a scene (see `SceneWork`)
    std::size_t bytes;             ///< approximate size: half of the cache, or for `memory` all that is read in turn
    double hit_rate;               ///< 0 for `scene`, whose rays have their own rate
};

/// Each working set with each hit rate. The size of `memory` makes all arrays together twice as large as the last
/// cache, within 32 and 96 MiB for each array.
std::vector<TradeLoad> make_trade_loads(const CacheSizes& caches);
/// The only load of a trade-off on a scene.
std::vector<TradeLoad> make_scene_load();
/// Returns the index of the load whose times represent a kernel: l1 with a hit rate of one half, if there is one;
/// otherwise the first load.
std::size_t reference_load(const std::vector<TradeLoad>& loads);

struct TradeRequest {
    Shape shape{};
    /// Replaces the sets of the shape: accuracy is measured on its pixels, and times on its rays, with
    /// `make_scene_load`.
    const scene::file::Scene* scene = nullptr;
    std::vector<TradeKernel> kernels;
    std::vector<const metric::Metric*> metrics;  ///< with lost_bits and excess_bits
    std::vector<TradeLoad> loads;
    TimingPlan plan{};
    truth::ProofLimit limit{};
};

/// Rays that accuracy is measured on, in the order of `TradeResult::summaries`.
struct TradeSet {
    std::string name;   ///< name in files
    std::string title;  ///< description of the rays
};
std::vector<TradeSet> make_trade_sets(const TradeRequest& request);

/// Returns the number of units of progress that `run_trade` reports through the plan.
std::uint64_t count_trade_units(const TradeRequest& request);

/// Results of each kernel, in the request's order.
struct TradeResult {
    struct KernelTime {
        Timing timing;  ///< seconds a ray, on a scene for one ray and one primitive
        std::size_t bytes, ray_count;
        double hit_rate;  ///< hit rate of these rays
        std::size_t primitive_count = 1;
    };
    std::vector<std::vector<KernelTime>> times;                 ///< [kernel][load]
    std::vector<OperationCounts> operations;                    ///< [kernel]
    std::vector<std::size_t> form_indices;                      ///< [kernel]: index of the row with its accuracy
    std::vector<std::vector<evaluate::FormSummary>> summaries;  ///< [ray set][tested form]

    [[nodiscard]] const evaluate::FormSummary& accuracy(std::size_t ray_set, std::size_t kernel) const {
        return summaries[ray_set][form_indices[kernel]];
    }
};
TradeResult run_trade(const TradeRequest& request);

/// Speed and accuracy of a kernel on a set of rays. A kernel is more accurate if it decides fewer rays wrongly; among
/// equals, if it keeps more bits.
struct ParetoPoint {
    double time_ns;         ///< nanoseconds a ray
    double wrong_fraction;  ///< false hits, false misses and NaNs among the rays whose truth is known
    double kept_bits;       ///< p − p99 of lost_bits; NaN without agreed hits, which ranks below every number

    [[nodiscard]] bool never_wrong() const { return wrong_fraction == 0; }
};
ParetoPoint make_pareto_point(const Timing& timing, const evaluate::TestedForm& tested_form,
                              const evaluate::FormSummary& accuracy, const std::vector<const metric::Metric*>& metrics);

/// Marks each point for which another one is at least as fast and as accurate, and better in one of the two.
std::vector<bool> find_dominated(const std::vector<ParetoPoint>& points);

/// Fastest point that is never wrong and keeps at least `kept_bits` bits; nothing if no point qualifies.
std::optional<std::size_t> find_cheapest(const std::vector<ParetoPoint>& points, double kept_bits);

/// Numbers of kept bits for which the summary names the fastest kernel.
inline constexpr std::array<int, 6> summary_bits{8, 12, 16, 20, 22, 40};

}  // namespace lostbits::measure::trade
