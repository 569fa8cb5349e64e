// Measures one ray against many boxes: the packed kernels of four forms at every width, loops written by hand with
// intrinsics, and plain loops left to the compiler.
//
//   build/bench/bench_box --ratios     rates, ratios to the hand-written loops, and the speed-up by all processors
//   build/bench/bench_box OPTIONS      each kernel by itself. Recommended are --benchmark_repetitions=9,
//                                      --benchmark_enable_random_interleaving=true and
//                                      --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "by_hand.hpp"
#include "measure/trade/timing_work.hpp"
#include "ratios.hpp"

namespace {

using namespace lostbits;
using bench::Contestant;

constexpr std::string_view sizes[] = {"l1", "l2", "memory"};
constexpr std::string_view forms[] = {"box.baseline", "box.exclusive", "box.inclusive", "box.signs"};

std::size_t bytes_of(std::string_view size) {
    return measure::trade::working_set_bytes(size, measure::trade::read_cache_sizes());
}

#if defined(LOSTBITS_BY_HAND)
template <class S>
Contestant by_hand_on(const std::string& name, const std::shared_ptr<measure::trade::BoxField<S>>& field,
                      by_hand::Boxes<S> loop, bool warm) {
    const auto ray = field->ray_numbers();
    const auto columns = field->pointers();
    return {name,
            "",
            8 * sizeof(S),
            {[=] { loop(ray.data(), columns.data(), field->t.data(), field->t.size()); }, field->t.size(), warm}};
}

void add_by_hand(std::vector<Contestant>& all, measure::trade::BoxWork& work, intersect::simd::Isa isa, bool warm) {
    if (isa != intersect::simd::Isa::w256 && isa != intersect::simd::Isa::w512) return;
    const by_hand::Width loops = isa == intersect::simd::Isa::w256 ? by_hand::width_256() : by_hand::width_512();
    const std::string hand = std::string(name_of(isa)) + "/by hand, ";
    all.push_back(by_hand_on(hand + "box.inclusive/f32", work.f32(), loops.f32.inclusive, warm));
    all.push_back(by_hand_on(hand + "box.signs/f32", work.f32(), loops.f32.signs, warm));
    all.push_back(by_hand_on(hand + "box.inclusive/f64", work.f64(), loops.f64.inclusive, warm));
    all.push_back(by_hand_on(hand + "box.signs/f64", work.f64(), loops.f64.signs, warm));
}
#else
void add_by_hand(std::vector<Contestant>&, measure::trade::BoxWork&, intersect::simd::Isa, bool) {}
#endif

/// Kernels that are compared. For a box they read seven numbers and write one.
std::vector<Contestant> contestants(std::size_t bytes) {
    std::vector<Contestant> all;
    measure::trade::BoxWork work(bytes);
    const auto add = [&](const std::string& kernel, std::string_view form, const std::string& format) {
        const std::string end = std::string(form) + "/" + format;
        if (auto w = work.work_for({form, kernel, format}))
            all.push_back(
                {kernel + "/" + end, kernel + "/by hand, " + end, format == "f32" ? 32.0 : 64.0, std::move(*w)});
    };
    for (const std::string_view form : forms)
        for (const char* const plain : {"plain-256", "plain-structs-256"}) add(plain, form, "f32");
    for (const intersect::simd::Isa isa : intersect::simd::available_isas()) {
        for (const char* const format : {"f32", "f64"})
            for (const std::string_view form : forms) add(std::string(name_of(isa)), form, format);
        add_by_hand(all, work, isa, measure::trade::fits_in_cache(bytes));
    }
    return all;
}

void print_all() {
    for (const std::string_view size : sizes)
        bench::print_ratios(std::string(size), contestants(bytes_of(size)), bytes_of(size));
    const std::string widest(name_of(intersect::simd::best_isa()));
    for (const std::string_view size : sizes)
        bench::print_speedup(widest + "/box.signs/f32", std::string(size), [&](std::size_t) {
            return measure::trade::BoxWork(bytes_of(size)).work_for({"box.signs", widest, "f32"})->pass;
        });
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 2 && std::string_view(argv[1]) == "--ratios") {
        print_all();
        return 0;
    }
    std::vector<std::vector<Contestant>> all;
    for (const std::string_view size : sizes) all.push_back(contestants(bytes_of(size)));
    for (std::size_t s = 0; s < all.size(); ++s)
        for (const Contestant& c : all[s])
            benchmark::RegisterBenchmark((c.name + "/" + std::string(sizes[s])).c_str(), [&c](benchmark::State& state) {
                for (auto _ : state) {
                    c.work.pass();
                    benchmark::ClobberMemory();
                }
                state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(c.work.item_count));
            });
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
