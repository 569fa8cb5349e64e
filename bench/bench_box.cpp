// Tests per second (items_per_second) of one ray against many boxes: the packed kernels of four forms at every width beside
// loops written by hand with intrinsics, and between them the ratio to compare, in one run:
//
//   build/bench/bench_box --benchmark_enable_random_interleaving=true --benchmark_repetitions=9 --benchmark_report_aggregates_only=true
//   build/bench/bench_box --ratios     medians of interleaved repetitions, packed over hand-written
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "by_hand.hpp"
#include "intersect/packed_many.hpp"

namespace {

using namespace lostbits;

struct Size {
    const char* name;
    std::size_t boxes;
};
/// 28 bytes a box: 7 KiB, 448 KiB, 112 MiB.
constexpr Size sizes[] = {{"l1", 256}, {"l2", std::size_t{1} << 14}, {"memory", std::size_t{1} << 22}};

/// Boxes scattered about the ray's way; t is infinite at first and tmin of the boxes met from the second round on.
struct Boxes {
    std::vector<float> column[6], t;
    const float* pointers[6];
    Ray<float> ray{{-3.0f, 0.1f, 0.2f}, {1.0f, -0.25f, 0.125f}};

    explicit Boxes(std::size_t n) : t(n, INFINITY) {
        std::mt19937 engine(2);
        std::uniform_real_distribution<float> place(-2, 2), side(0.1f, 1);
        for (int axis = 0; axis < 3; ++axis) {
            for (std::size_t i = 0; i < n; ++i) {
                column[axis].push_back(place(engine));
                column[axis + 3].push_back(column[axis].back() + side(engine));
            }
        }
        for (int c = 0; c < 6; ++c) pointers[c] = column[c].data();
    }
};

struct Contestant {
    std::string name;
    ManyBoxes<float> packed;
    by_hand::Boxes by_hand;

    void run(Boxes& b) const {
        const auto& c = b.column;
        if (packed) return packed(b.ray, {c[0], c[1], c[2], c[3], c[4], c[5]}, b.t);
        const float numbers[6] = {b.ray.origin.x, b.ray.origin.y, b.ray.origin.z, b.ray.direction.x, b.ray.direction.y, b.ray.direction.z};
        by_hand(numbers, b.pointers, b.t.data(), b.t.size());
    }
};

std::vector<Contestant> contestants() {
    std::vector<Contestant> all;
    for (const Isa isa : available_isas()) {
        const std::string width(name_of(isa));
        for (const ManyRow& row : many_rows(isa))
            for (const std::string_view name : {"box.baseline", "box.exclusive", "box.inclusive", "box.signs"})
                if (row.info->name == name) all.push_back({width + "/" + std::string(name), row.boxes32, nullptr});
#if defined(LOSTBITS_BY_HAND)
        if (isa == Isa::w256) {
            all.push_back({"256/hand.inclusive", nullptr, by_hand::inclusive_w256});
            all.push_back({"256/hand.signs", nullptr, by_hand::signs_w256});
        }
        if (isa == Isa::w512) {
            all.push_back({"512/hand.inclusive", nullptr, by_hand::inclusive_w512});
            all.push_back({"512/hand.signs", nullptr, by_hand::signs_w512});
        }
#endif
    }
    return all;
}

/// Boxes per nanosecond in one go of about a millisecond or one pass.
double speed(const Contestant& c, Boxes& boxes) {
    const std::size_t rounds = std::max<std::size_t>(1, (std::size_t{1} << 21) / boxes.t.size());
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < rounds; ++i) {
        c.run(boxes);
        benchmark::ClobberMemory();
    }
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
    return static_cast<double>(rounds * boxes.t.size()) / took.count();
}

double median(std::vector<double> x) {
    std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
    return x[x.size() / 2];
}

/// Every contestant once a round, round after round, so that a busy neighbour slows them alike; the ratio is the median of the
/// rounds' own ratios.
void print_ratios() {
    const auto all = contestants();
    std::printf("%-20s %-7s %8s %16s\n", "kernel", "boxes", "10^9/s", "over by hand");
    for (const Size& size : sizes) {
        Boxes boxes(size.boxes);
        const int rounds = size.boxes > 1000000 ? 15 : 101;
        std::vector<std::vector<double>> speeds(all.size());
        for (int r = 0; r < rounds; ++r)
            for (std::size_t k = 0; k < all.size(); ++k) speeds[k].push_back(speed(all[k], boxes));
        for (std::size_t k = 0; k < all.size(); ++k) {
            std::printf("%-20s %-7s %8.3f", all[k].name.c_str(), size.name, median(speeds[k]));
            std::string rival = all[k].name;
            if (const auto at = rival.find("box."); at != rival.npos) rival.replace(at, 4, "hand.");
            const auto found = std::ranges::find(all, rival, &Contestant::name);
            if (all[k].packed && found != all.end()) {
                std::vector<double> ratios;
                for (int r = 0; r < rounds; ++r) ratios.push_back(speeds[k][static_cast<std::size_t>(r)] / speeds[static_cast<std::size_t>(found - all.begin())][static_cast<std::size_t>(r)]);
                std::printf(" %16.3f", median(ratios));
            }
            std::printf("\n");
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 2 && std::string_view(argv[1]) == "--ratios") {
        print_ratios();
        return 0;
    }
    static const auto all = contestants();
    for (const Size& size : sizes)
        for (const Contestant& c : all)
            benchmark::RegisterBenchmark((c.name + "/" + size.name).c_str(), [&c, &size](benchmark::State& state) {
                Boxes boxes(size.boxes);
                for (auto _ : state) {
                    c.run(boxes);
                    benchmark::ClobberMemory();
                }
                state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(size.boxes));
            });
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
