#include "measure/speed/timing.hpp"

#if defined(__linux__)
#include <sched.h>
#endif
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numeric>
#include <random>

namespace lostbits::measure::speed {
namespace {

/// The compiler may not move, drop or join what lies before and after.
void settle_memory() { asm volatile("" ::: "memory"); }

double seconds_of(const TimedWork& work, std::uint64_t passes) {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    for (std::uint64_t i = 0; i < passes; ++i) {
        work.pass();
        settle_memory();
    }
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Passes that last `least` seconds, found by doubling.
std::uint64_t passes_for(const TimedWork& work, double least) {
    work.pass();
    for (std::uint64_t passes = 1;; passes *= 2) {
        const double seconds = seconds_of(work, passes);
        if (seconds < least / 4) continue;
        return std::max<std::uint64_t>(
            1, static_cast<std::uint64_t>(std::ceil(static_cast<double>(passes) * least / seconds)));
    }
}

std::size_t from_system([[maybe_unused]] int name, std::size_t otherwise) {
    const long size = sysconf(name);
    return size > 0 ? static_cast<std::size_t>(size) : otherwise;
}

}  // namespace

#if defined(__linux__)
PinnedThread::PinnedThread() {
    cpu_set_t allowed;
    const int here = sched_getcpu();
    if (here < 0 || sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(here), &one);
    if (sched_setaffinity(0, sizeof one, &one) != 0) return;
    processor_ = here;
    before_.resize(sizeof allowed / sizeof(unsigned long));
    std::memcpy(before_.data(), &allowed, sizeof allowed);
}

PinnedThread::~PinnedThread() {
    if (processor_ < 0) return;
    cpu_set_t allowed;
    std::memcpy(&allowed, before_.data(), sizeof allowed);
    sched_setaffinity(0, sizeof allowed, &allowed);
}
#else
PinnedThread::PinnedThread() = default;
PinnedThread::~PinnedThread() = default;
#endif

CacheSizes cache_sizes() {
    CacheSizes sizes{std::size_t{32} << 10, std::size_t{1} << 20, std::size_t{8} << 20};
#if defined(_SC_LEVEL1_DCACHE_SIZE)
    sizes.l1 = from_system(_SC_LEVEL1_DCACHE_SIZE, sizes.l1);
    sizes.l2 = from_system(_SC_LEVEL2_CACHE_SIZE, sizes.l2);
    sizes.last = from_system(_SC_LEVEL3_CACHE_SIZE, sizes.last);
#endif
    return sizes;
}

std::string processor_name() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
    }
    return {};
}

Timing timing_of(std::vector<double> samples) {
    std::ranges::sort(samples);
    const auto at = [&](double share) {
        const double rank = share * static_cast<double>(samples.size() - 1);
        const auto below = static_cast<std::size_t>(rank), above = std::min(below + 1, samples.size() - 1);
        return std::lerp(samples[below], samples[above], rank - static_cast<double>(below));
    };
    return {at(0.5), at(0.25), at(0.75)};
}

Timing ratio_of(std::span<const double> a, std::span<const double> b) {
    std::vector<double> quotients(a.size());
    std::ranges::transform(a, b, quotients.begin(), std::divides<>());
    return timing_of(std::move(quotients));
}

std::vector<std::vector<double>> sample_interleaved(std::span<const TimedWork> work, const TimingPlan& plan) {
    const PinnedThread pinned;
    std::vector<std::uint64_t> passes;
    for (const TimedWork& w : work) {
        plan.stop.check();
        passes.push_back(passes_for(w, plan.least_seconds));
    }
    std::vector<std::vector<double>> samples(work.size());
    std::vector<std::size_t> order(work.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::mt19937_64 random(plan.seed);
    for (int round = 0; round < plan.repetitions; ++round) {
        for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
        for (const std::size_t i : order) {
            plan.stop.check();
            if (work[i].warm) work[i].pass();
            samples[i].push_back(seconds_of(work[i], passes[i]) / static_cast<double>(passes[i] * work[i].items));
            plan.progress(1);
        }
    }
    return samples;
}

std::vector<Timing> time_interleaved(std::span<const TimedWork> work, const TimingPlan& plan) {
    std::vector<Timing> timings;
    for (auto& s : sample_interleaved(work, plan)) timings.push_back(timing_of(std::move(s)));
    return timings;
}

}  // namespace lostbits::measure::speed
