// Interleaved timing: every piece of work runs once a round, over many rounds, so that a disturbance affects all of
// them alike. Also the throughput of all processors together, compared with that of one processor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "intersect/process/stop_token.hpp"

namespace lostbits::measure::trade {

/// Pins the calling thread to the processor that it runs on, and restores its old processors at the end. Does nothing
/// if the system refuses.
class PinnedThread {
public:
    PinnedThread();
    ~PinnedThread();
    PinnedThread(const PinnedThread&) = delete;
    PinnedThread& operator=(const PinnedThread&) = delete;
    /// The processor, or −1 if the system refused.
    [[nodiscard]] int processor() const { return processor_; }

private:
    int processor_ = -1;
    std::vector<int> allowed_before_;  ///< processors that the thread was allowed to use before
};

/// Bytes of the first- and second-level data cache of a core and of the last level, as the system reports them; 32 KiB,
/// 1 MiB and 8 MiB if it does not.
struct CacheSizes {
    std::size_t l1, l2, last;
};
CacheSizes read_cache_sizes();

/// Name of the processor by the system: `AMD EPYC 7763 64-Core Processor`; empty if it reports none.
std::string read_processor_name();

/// Work to be timed. `pass` leaves its results in memory.
struct TimedWork {
    std::function<void()> pass;
    std::size_t item_count;  ///< items in one pass
    bool needs_warm_up;      ///< an untimed pass runs first, so that the data are in the same cache as the last time
};

struct TimingPlan {
    int repetitions = 25;
    double min_seconds = 4e-4;  ///< shortest measurement: passes are repeated until it lasts this long; less than the
                                ///< time slice of a busy machine
    intersect::process::StopToken stop = {};
    std::uint64_t seed = 1;  ///< seed of the order of the work, which differs in each round
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};  ///< units done
};

/// Seconds per item: median and quartiles of the repetitions.
struct Timing {
    double median = 0, low_quartile = 0, high_quartile = 0;
};

/// Measures the seconds per item of every piece of work, one value per repetition, by steady_clock on one processor.
/// Progress counts one unit for each piece of work and repetition.
std::vector<std::vector<double>> sample_interleaved(std::span<const TimedWork> work, const TimingPlan& plan);
/// Times the work the same way and summarises the repetitions.
std::vector<Timing> time_interleaved(std::span<const TimedWork> work, const TimingPlan& plan);

/// Returns median and quartiles, interpolated between two samples if the rank falls between them. Needs at least one
/// sample.
Timing summarise_samples(std::vector<double> samples);

/// Returns the timing of the quotients a[i]/b[i] within a round: a disturbance of a round slows both. Both spans have
/// the same size, at least one.
Timing summarise_ratios(std::span<const double> a, std::span<const double> b);

/// Processors that the calling thread may use; {0} if the system does not report them.
std::vector<int> allowed_processors();

struct ThreadPlan {
    int repetitions = 15;
    double min_seconds = 0.02;     ///< shortest measurement: long compared with the start of a thread
    std::size_t thread_count = 0;  ///< threads that run together; 0: one on each allowed processor
    intersect::process::StopToken stop = {};
};

/// Makes the work of a thread: the returned function is called repeatedly on that thread, on memory of its own.
using ThreadWorkFactory = std::function<std::function<void()>(std::size_t thread)>;

/// Measures the speedup by threads: the passes per second of all threads together, each on a processor of its own,
/// divided by the passes per second of a single thread. Returns one quotient per repetition. The single thread runs on
/// each processor in turn. Perfect scaling is the number of threads. Uses steady_clock.
std::vector<double> measure_thread_speedups(const ThreadWorkFactory& work, const ThreadPlan& plan);

}  // namespace lostbits::measure::trade
