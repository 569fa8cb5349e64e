// What all processors do together against what one does alone.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "intersect/process/stop_token.hpp"

namespace lostbits::measure::speed {

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
