#include "measure/trade/timing.hpp"

#if defined(__linux__)
#include <sched.h>
#endif
#include <unistd.h>

#include <algorithm>
#include <barrier>
#include <chrono>
#include <cmath>
#include <fstream>
#include <numeric>
#include <random>
#include <thread>

namespace lostbits::measure::trade {
namespace {

/// Keeps the compiler from moving, dropping or joining memory accesses across this point.
void compiler_barrier() { asm volatile("" ::: "memory"); }

using Clock = std::chrono::steady_clock;

double measure_seconds(const TimedWork& work, std::uint64_t pass_count) {
    const auto begin = Clock::now();
    for (std::uint64_t i = 0; i < pass_count; ++i) {
        work.pass();
        compiler_barrier();
    }
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Returns the number of passes that last `min_seconds` seconds, found by doubling.
std::uint64_t find_pass_count(const TimedWork& work, double min_seconds) {
    work.pass();
    for (std::uint64_t pass_count = 1;; pass_count *= 2) {
        const double seconds = measure_seconds(work, pass_count);
        if (seconds < min_seconds / 4) continue;
        return std::max<std::uint64_t>(
            1, static_cast<std::uint64_t>(std::ceil(static_cast<double>(pass_count) * min_seconds / seconds)));
    }
}

std::size_t system_size([[maybe_unused]] int name, std::size_t fallback) {
    const long size = sysconf(name);
    return size > 0 ? static_cast<std::size_t>(size) : fallback;
}

/// Processors that the calling thread may use; empty if the system does not report them.
std::vector<int> processors_of_thread() {
    std::vector<int> processors;
#if defined(__linux__)
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0) {
        for (int i = 0; i < CPU_SETSIZE; ++i)
            if (CPU_ISSET(static_cast<std::size_t>(i), &set)) processors.push_back(i);
    }
#endif
    return processors;
}

/// Pins the calling thread to these processors. Returns false if the system refuses: the thread then keeps its
/// processors.
bool pin_to([[maybe_unused]] const std::vector<int>& processors) {
#if defined(__linux__)
    cpu_set_t set;
    CPU_ZERO(&set);
    for (const int processor : processors) CPU_SET(static_cast<std::size_t>(processor), &set);
    return sched_setaffinity(0, sizeof set, &set) == 0;
#else
    return false;
#endif
}

int own_processor() {
#if defined(__linux__)
    return sched_getcpu();
#else
    return -1;
#endif
}

/// Returns the passes per second, measured for `seconds`. The clock is read after each batch of passes; batches double
/// until a sixteenth of the time has passed.
double measure_rate(const std::function<void()>& pass, double seconds) {
    const auto seconds_since = [](Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    const auto start = Clock::now();
    double passes = 0, elapsed = 0;
    for (std::size_t batch = 1; elapsed < seconds; batch *= elapsed < seconds / 16 ? 2 : 1) {
        for (std::size_t i = 0; i < batch; ++i) {
            pass();
            compiler_barrier();
        }
        passes += static_cast<double>(batch);
        elapsed = seconds_since(start);
    }
    return passes / elapsed;
}

/// Returns the sum of the rates of all threads, which start together, thread i on `processors[i]`.
double measure_total_rate(const std::vector<std::function<void()>>& passes, const std::vector<int>& processors,
                          double seconds) {
    std::vector<double> rates(passes.size());
    std::barrier ready(static_cast<std::ptrdiff_t>(passes.size()));
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < passes.size(); ++i) {
        threads.emplace_back([&, i] {
            pin_to({processors[i]});
            passes[i]();
            ready.arrive_and_wait();
            rates[i] = measure_rate(passes[i], seconds);
        });
    }
    threads.clear();
    return std::accumulate(rates.begin(), rates.end(), 0.0);
}

}  // namespace

PinnedThread::PinnedThread() : allowed_before_(processors_of_thread()) {
    const int current = own_processor();
    if (current >= 0 && !allowed_before_.empty() && pin_to({current})) processor_ = current;
}

PinnedThread::~PinnedThread() {
    if (processor_ >= 0) pin_to(allowed_before_);
}

CacheSizes read_cache_sizes() {
    CacheSizes sizes{std::size_t{32} << 10, std::size_t{1} << 20, std::size_t{8} << 20};
#if defined(_SC_LEVEL1_DCACHE_SIZE)
    sizes.l1 = system_size(_SC_LEVEL1_DCACHE_SIZE, sizes.l1);
    sizes.l2 = system_size(_SC_LEVEL2_CACHE_SIZE, sizes.l2);
    sizes.last = system_size(_SC_LEVEL3_CACHE_SIZE, sizes.last);
#endif
    return sizes;
}

std::string read_processor_name() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
    }
    return {};
}

Timing summarise_samples(std::vector<double> samples) {
    std::ranges::sort(samples);
    const auto quantile = [&](double level) {
        const double rank = level * static_cast<double>(samples.size() - 1);
        const auto below = static_cast<std::size_t>(rank), above = std::min(below + 1, samples.size() - 1);
        return std::lerp(samples[below], samples[above], rank - static_cast<double>(below));
    };
    return {quantile(0.5), quantile(0.25), quantile(0.75)};
}

Timing summarise_ratios(std::span<const double> a, std::span<const double> b) {
    std::vector<double> quotients(a.size());
    std::ranges::transform(a, b, quotients.begin(), std::divides<>());
    return summarise_samples(std::move(quotients));
}

std::vector<std::vector<double>> sample_interleaved(std::span<const TimedWork> work, const TimingPlan& plan) {
    const PinnedThread pinned;
    std::vector<std::uint64_t> passes;
    for (const TimedWork& w : work) {
        plan.stop.check();
        passes.push_back(find_pass_count(w, plan.min_seconds));
    }

    // Runs all work in each round, in a new order.
    std::vector<std::vector<double>> samples(work.size());
    std::vector<std::size_t> order(work.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::mt19937_64 random(plan.seed);
    for (int round = 0; round < plan.repetitions; ++round) {
        for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
        for (const std::size_t i : order) {
            plan.stop.check();
            if (work[i].needs_warm_up) work[i].pass();
            samples[i].push_back(measure_seconds(work[i], passes[i]) /
                                 static_cast<double>(passes[i] * work[i].item_count));
            plan.progress(1);
        }
    }
    return samples;
}

std::vector<Timing> time_interleaved(std::span<const TimedWork> work, const TimingPlan& plan) {
    std::vector<Timing> timings;
    for (auto& s : sample_interleaved(work, plan)) timings.push_back(summarise_samples(std::move(s)));
    return timings;
}

std::vector<int> allowed_processors() {
    auto processors = processors_of_thread();
    return processors.empty() ? std::vector{0} : processors;
}

std::vector<double> measure_thread_speedups(const ThreadWorkFactory& work, const ThreadPlan& plan) {
    const auto allowed = allowed_processors();
    const std::size_t count = plan.thread_count == 0 ? allowed.size() : plan.thread_count;
    std::vector<int> processors;
    std::vector<std::function<void()>> passes;
    for (std::size_t i = 0; i < count; ++i) {
        processors.push_back(allowed[i % allowed.size()]);
        passes.push_back(work(i));
    }

    std::vector<double> quotients;
    for (int round = 0; round < plan.repetitions; ++round) {
        plan.stop.check();
        const std::size_t single = static_cast<std::size_t>(round) % count;
        const double single_rate = measure_total_rate({passes[single]}, {processors[single]}, plan.min_seconds);
        quotients.push_back(measure_total_rate(passes, processors, plan.min_seconds) / single_rate);
    }
    return quotients;
}

}  // namespace lostbits::measure::trade
