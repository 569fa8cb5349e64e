// The trade: measured speed against measured accuracy, for every form, format and register width, in one run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/speed/timing_work.hpp"

namespace lostbits::measure::speed {

/// One thing that can be called: a form in a native format over registers of a width. Kernels of one form and format
/// with the same `measured` give the same bits.
struct TradeKernel {
    evaluate::TestedForm measured;                                    ///< what its accuracy is that of
    std::string_view isa;                                             ///< `scalar`, `128`, ...
    decltype(intersect::table::Intersector::native32) f32 = nullptr;  ///< one of the two, by the format
    decltype(intersect::table::Intersector::native64) f64 = nullptr;
};

/// Every selected row (f32 and f64 alone) on every instruction set that there is, in the order of rows, then widths.
std::vector<TradeKernel> trade_kernels(const std::vector<evaluate::TestedForm>& rows);

/// The rays that a kernel is timed on: so many bytes of them and their answers, of which so many hit.
struct TradeLoad {
    std::string_view working_set;  ///< `l1`, `l2`, `memory`; `scene`: rays of a scene (see `SceneWork`)
    std::size_t bytes;             ///< about; half of the cache, and all that is walked round and round in `memory`
    double hit_rate;               ///< of `scene` what its rays have, and 0 here
};

/// Each working set with each hit rate; `memory` is sized so that all arrays together are twice the last cache, within
/// 32 and 96 MiB each.
std::vector<TradeLoad> trade_loads(const CacheSizes& caches);
/// The only one of a trade on a scene.
std::vector<TradeLoad> scene_load();
/// The one whose times stand for a kernel: l1, every other ray a hit; otherwise the first.
std::size_t standing_load(const std::vector<TradeLoad>& loads);

struct TradeRequest {
    Shape shape{};
    /// Instead of the sets of the shape: its pixels are what is judged, its rays what is timed, on `scene_load`.
    const scene::file::Scene* scene = nullptr;
    std::vector<TradeKernel> kernels;
    std::vector<const metric::Metric*> metrics;  ///< with lost_bits and excess_bits
    std::vector<TradeLoad> loads;
    TimingPlan plan{};
    truth::TruthLimit limit{};
};

/// The rays that accuracy is measured on, in the order of `TradeResult::rows`.
struct TradeSet {
    std::string name;   ///< in files
    std::string title;  ///< what the rays are
};
std::vector<TradeSet> trade_sets(const TradeRequest& request);

/// Units of progress that `run_trade` reports through the plan.
std::uint64_t trade_units(const TradeRequest& request);

/// Of each kernel, in the request's order.
struct TradeResult {
    struct Timed {
        Timing timing;  ///< seconds a ray, on a scene a ray and solid
        std::size_t bytes, rays;
        double hit_rate;  ///< of these rays
        std::size_t solids = 1;
    };
    std::vector<std::vector<Timed>> times;                 ///< [kernel][load]
    std::vector<OperationCounts> operations;               ///< [kernel]
    std::vector<std::size_t> row_of;                       ///< [kernel]: where its accuracy is
    std::vector<std::vector<evaluate::FormSummary>> rows;  ///< [ray set][row]

    [[nodiscard]] const evaluate::FormSummary& accuracy(std::size_t set, std::size_t kernel) const {
        return rows[set][row_of[kernel]];
    }
};
TradeResult run_trade(const TradeRequest& request);

/// What a kernel is worth on a set of rays. More accurate is, first, what decides fewer rays wrongly, and among equals
/// what keeps more bits.
struct ParetoPoint {
    double time_ns;         ///< a ray
    double wrong_fraction;  ///< false hits, false misses and NaNs among the rays whose truth is known
    double kept_bits;       ///< p − p99 of lost_bits; NaN where no hit is agreed on: less than any number

    [[nodiscard]] bool never_wrong() const { return wrong_fraction == 0; }
};
ParetoPoint pareto_point(const Timing& timing, const evaluate::TestedForm& row, const evaluate::FormSummary& accuracy,
                         const std::vector<const metric::Metric*>& metrics);

/// Of each: whether another is at least as fast and at least as accurate, and better in one of the two.
std::vector<bool> dominated(const std::vector<ParetoPoint>& all);

/// The fastest that is never wrong and keeps so many bits, or nothing.
std::optional<std::size_t> cheapest(const std::vector<ParetoPoint>& all, double kept_bits);

/// The bits that are asked for in words.
inline constexpr std::array<int, 6> asked_bits{8, 12, 16, 20, 22, 40};

}  // namespace lostbits::measure::speed
