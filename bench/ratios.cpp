#include "ratios.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>

#include "measure/trade/timing_work.hpp"

namespace bench {
namespace {

using namespace lostbits;

/// A loop that only reads: it sums 64-bit words of eight columns side by side, faster than memory delivers them. A
/// kernel has as many streams; one stream alone gets a third less.
Contestant make_read_loop(std::size_t bytes) {
    constexpr std::size_t streams = 8, stagger = 40;  // 5 cache lines
    const std::size_t length = bytes / 64;
    const auto words = std::make_shared<std::vector<std::uint64_t>>(streams * (length + stagger), 1);
    return {"read loop",
            "",
            8,
            {[words, length] {
                 std::uint64_t sums[streams] = {};
                 const std::uint64_t* const first = words->data();
                 for (std::size_t i = 0; i < length; ++i)
                     for (std::size_t k = 0; k < streams; ++k) sums[k] += first[k * (length + stagger) + i];
                 benchmark::DoNotOptimize(sums);
             },
             streams * length, measure::trade::fits_in_cache(bytes)}};
}

}  // namespace

void print_ratios(const std::string& data, std::vector<Contestant> all, std::size_t bytes) {
    const bool memory = !measure::trade::fits_in_cache(bytes);
    if (memory) all.push_back(make_read_loop(bytes));
    std::vector<measure::trade::TimedWork> work;
    for (const Contestant& c : all) work.push_back(c.work);
    const auto samples = measure::trade::sample_interleaved(work, {.repetitions = memory ? 9 : 201});
    const auto find_contestant = [&](const std::string& name) {
        return static_cast<std::size_t>(std::ranges::find(all, name, &Contestant::name) - all.begin());
    };
    std::printf("%-42s %-7s %9s  %s\n", "kernel", "data", "10^9/s",
                memory ? "over by hand        GB/s  of the read loop" : "over by hand");
    for (std::size_t k = 0; k < all.size(); ++k) {
        const double rate = 1e-9 / measure::trade::summarise_samples(samples[k]).median;
        std::printf("%-42s %-7s %9.3f", all[k].name.c_str(), data.c_str(), rate);
        if (const std::size_t rival = find_contestant(all[k].rival); rival < all.size()) {
            const measure::trade::Timing ratio = measure::trade::summarise_ratios(samples[rival], samples[k]);
            std::printf("  %.3f (%.2f-%.2f)", ratio.median, ratio.low_quartile, ratio.high_quartile);
        } else if (memory) {
            std::printf("%19s", "");
        }
        if (memory)
            std::printf(
                " %7.2f %8.2f", rate * all[k].bytes,
                all[k].bytes / all.back().bytes * measure::trade::summarise_ratios(samples.back(), samples[k]).median);
        std::printf("\n");
    }
    std::printf("\n");
}

void print_speedup(const std::string& name, const std::string& data, const measure::trade::ThreadWorkFactory& work) {
    const measure::trade::Timing speedup =
        measure::trade::summarise_samples(measure::trade::measure_thread_speedups(work, {}));
    std::printf("%-42s %-7s %zu processors over one: %.2f (%.2f-%.2f)\n", name.c_str(), data.c_str(),
                measure::trade::allowed_processors().size(), speedup.median, speedup.low_quartile,
                speedup.high_quartile);
}

}  // namespace bench
