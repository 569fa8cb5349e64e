#include "measure/speed/timing_threads.hpp"

#if defined(__linux__)
#include <sched.h>
#endif

#include <barrier>
#include <chrono>
#include <numeric>
#include <thread>

namespace lostbits::measure::speed {
namespace {

using Clock = std::chrono::steady_clock;

void pin([[maybe_unused]] int processor) {
#if defined(__linux__)
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(processor), &one);
    sched_setaffinity(0, sizeof one, &one);  // refused: it is timed where it runs
#endif
}

/// Passes a second for `seconds`, asked of the clock after every 2^k passes that a sixteenth of the time has room for.
double rate_of(const std::function<void()>& pass, double seconds) {
    const auto since = [](Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    const auto start = Clock::now();
    double passes = 0, took = 0;
    for (std::size_t batch = 1; took < seconds; batch *= took < seconds / 16 ? 2 : 1) {
        for (std::size_t i = 0; i < batch; ++i) {
            pass();
            asm volatile("" ::: "memory");
        }
        passes += static_cast<double>(batch);
        took = since(start);
    }
    return passes / took;
}

/// The sum over the threads, which start together on these processors.
double rate_together(const std::vector<std::function<void()>>& passes, const std::vector<int>& processors,
                     double seconds) {
    std::vector<double> rates(passes.size());
    std::barrier ready(static_cast<std::ptrdiff_t>(passes.size()));
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < passes.size(); ++i) {
        threads.emplace_back([&, i] {
            pin(processors[i]);
            passes[i]();
            ready.arrive_and_wait();
            rates[i] = rate_of(passes[i], seconds);
        });
    }
    threads.clear();
    return std::accumulate(rates.begin(), rates.end(), 0.0);
}

}  // namespace

std::vector<int> allowed_processors() {
    std::vector<int> all;
#if defined(__linux__)
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0) {
        for (int i = 0; i < CPU_SETSIZE; ++i)
            if (CPU_ISSET(static_cast<std::size_t>(i), &set)) all.push_back(i);
    }
#endif
    if (all.empty()) all.push_back(0);
    return all;
}

std::vector<double> thread_speedups(const WorkOfThread& work, const ThreadPlan& plan) {
    const auto allowed = allowed_processors();
    const std::size_t count = plan.threads == 0 ? allowed.size() : plan.threads;
    std::vector<int> processors;
    std::vector<std::function<void()>> passes;
    for (std::size_t i = 0; i < count; ++i) {
        processors.push_back(allowed[i % allowed.size()]);
        passes.push_back(work(i));
    }
    std::vector<double> quotients;
    for (int round = 0; round < plan.repetitions; ++round) {
        plan.stop.check();
        const std::size_t one = static_cast<std::size_t>(round) % count;
        const double alone = rate_together({passes[one]}, {processors[one]}, plan.least_seconds);
        quotients.push_back(rate_together(passes, processors, plan.least_seconds) / alone);
    }
    return quotients;
}

}  // namespace lostbits::measure::speed
