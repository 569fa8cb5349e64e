// Time, measured so that a disturbance hits all alike: every piece of work once a round, over many rounds; and what all
// processors do together against what one does alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "intersect/process/stop_token.hpp"

namespace lostbits::measure::speed {

/// Keeps the calling thread on the processor that it runs on, and lets it go where it could before. Does nothing where
/// the system refuses.
class PinnedThread {
public:
    PinnedThread();
    ~PinnedThread();
    PinnedThread(const PinnedThread&) = delete;
    PinnedThread& operator=(const PinnedThread&) = delete;
    /// The processor, or −1 where it was refused.
    [[nodiscard]] int processor() const { return processor_; }

private:
    int processor_ = -1;
    std::vector<int> before_;  ///< the processors that were allowed
};

/// Bytes of the first- and second-level data cache of a core and of the last level, as the system tells; 32 KiB, 1 MiB
/// and 8 MiB where it does not.
struct CacheSizes {
    std::size_t l1, l2, last;
};
CacheSizes cache_sizes();

/// What the system calls the processor: `AMD EPYC 7763 64-Core Processor`; empty where it does not tell.
std::string processor_name();

/// Something whose time is asked for. `pass` leaves its results in memory.
struct TimedWork {
    std::function<void()> pass;
    std::size_t items;  ///< a pass
    bool warm;  ///< whether a pass that is not timed comes first, so that the data lie where they did the last time
};

struct TimingPlan {
    int repetitions = 25;
    double least_seconds = 4e-4;  ///< of a measurement: passes are repeated until it lasts so long; less than the time
                                  ///< slice of a busy machine
    intersect::process::StopToken stop = {};
    std::uint64_t seed = 1;  ///< of the order of the work, which is another in each round
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};  ///< units done
};

/// Seconds an item: median and quartiles of the repetitions.
struct Timing {
    double median = 0, low_quartile = 0, high_quartile = 0;
};

/// Seconds an item of every piece of work, one per repetition. By steady_clock, on one processor. One unit of progress
/// a piece of work and repetition.
std::vector<std::vector<double>> sample_interleaved(std::span<const TimedWork> work, const TimingPlan& plan);
/// The same, summed up.
std::vector<Timing> time_interleaved(std::span<const TimedWork> work, const TimingPlan& plan);

/// Median and quartiles, between two samples where the rank falls there. At least one sample.
Timing timing_of(std::vector<double> samples);

/// Of a[i]/b[i], quotients within a round: what slows a round down slows both. As many of both, at least one.
Timing ratio_of(std::span<const double> a, std::span<const double> b);

/// The processors that the calling thread may use; {0} where the system does not say.
std::vector<int> allowed_processors();

struct ThreadPlan {
    int repetitions = 15;
    double least_seconds = 0.02;  ///< of a measurement: long against the start of a thread
    std::size_t threads = 0;      ///< together; 0: one on each allowed processor
    intersect::process::StopToken stop = {};
};

/// The work of thread `i`: what it returns is called over and over on that thread, on memory of its own.
using WorkOfThread = std::function<std::function<void()>(std::size_t thread)>;

/// Passes a second of all threads together, each on a processor of its own, over those of one alone; one quotient a
/// repetition, the one taking turns on the processors. Perfect scaling is the number of threads. By steady_clock.
std::vector<double> thread_speedups(const WorkOfThread& work, const ThreadPlan& plan);

}  // namespace lostbits::measure::speed
