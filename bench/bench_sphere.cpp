// Measures rays per second (items_per_second) of the certified truth, of plain 256-bit MPFR on the same rays, and of
// every form in every engine. All are measured in one run: compare ratios, not times.
//
//   build/bench/bench_sphere --ratios     all tables of ratios (ratios.hpp)
//   build/bench/bench_sphere --filtered   only the cost of sphere.filtered and box.filtered
//   build/bench/bench_sphere OPTIONS      each kernel by itself. Recommended are --benchmark_repetitions=5,
//                                         --benchmark_min_time=0.5, --benchmark_enable_random_interleaving=true,
//                                         and a filter such as --benchmark_filter='truth|mpfr' or
//                                         --benchmark_filter='packed.*(schoolbook|unified)/f32'
#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/simd/packed.hpp"
#include "intersect/table/table.hpp"
#include "measure/answer/without_rounding.hpp"
#include "measure/truth/truth.hpp"
#include "number/real.hpp"
#include "ratios.hpp"

namespace {

using namespace lostbits;

constexpr std::size_t ray_count = 4096;

/// Binary32 rays like those of a scene. Each coordinate of an origin is within `distance` of 0, and rays are aimed at
/// the sphere or close to it; about half hit.
struct RaySet {
    std::vector<double> ox, oy, oz, dx, dy, dz;
    Sphere<double> sphere{{0.25, -0.5, 1.0}, 1.0};

    explicit RaySet(double distance) {
        std::mt19937_64 engine(20190325);
        const auto uniform = [&engine](double low, double high) {
            return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
        };
        const auto stored = [](double x) { return static_cast<double>(static_cast<float>(x)); };
        for (std::size_t i = 0; i < ray_count; ++i) {
            const double o[3] = {uniform(-distance, distance), uniform(-distance, distance),
                                 uniform(-distance, distance)};
            const double target[3] = {sphere.centre.x + uniform(-1.2, 1.2), sphere.centre.y + uniform(-1.2, 1.2),
                                      sphere.centre.z + uniform(-1.2, 1.2)};
            ox.push_back(stored(o[0]));
            oy.push_back(stored(o[1]));
            oz.push_back(stored(o[2]));
            dx.push_back(stored(target[0] - o[0]));
            dy.push_back(stored(target[1] - o[1]));
            dz.push_back(stored(target[2] - o[2]));
        }
    }
    [[nodiscard]] Ray<double> operator[](std::size_t i) const { return {{ox[i], oy[i], oz[i]}, {dx[i], dy[i], dz[i]}}; }
};

const RaySet& near_rays() {
    static const RaySet set(10);
    return set;
}
const RaySet& far_rays() {
    static const RaySet set(4100);
    return set;
}

void set_ray_count(benchmark::State& state) {
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(ray_count));
}

void measure_truth(benchmark::State& state, const RaySet& (*get_rays)()) {
    const RaySet& set = get_rays();
    for (auto _ : state) {
        for (std::size_t i = 0; i < ray_count; ++i)
            benchmark::DoNotOptimize(measure::truth::find_truth(set[i], set.sphere));
    }
    set_ray_count(state);
}

/// A reference by plain high precision: the half-b quadratic in 256 bits, without a certificate.
void measure_plain_mpfr(benchmark::State& state, const RaySet& (*get_rays)()) {
    const RaySet& set = get_rays();
    const auto vec = [](const Vec<double>& v) { return Vec<Real>(Real(v.x), Real(v.y), Real(v.z)); };
    const Sphere<Real> sphere{vec(set.sphere.centre), Real(set.sphere.radius)};
    for (auto _ : state) {
        for (std::size_t i = 0; i < ray_count; ++i) {
            const Ray<double> ray = set[i];
            const Vec<Real> f = vec(ray.origin) - sphere.centre, d = vec(ray.direction);
            const Real a = dot(d, d), h = dot(f, d), c = dot(f, f) - sphere.radius * sphere.radius;
            const Real disc = h * h - a * c;
            Real t(-1);
            if (disc >= 0) {
                const Real root = sqrt(disc);
                t = (-h - root) / a;
                if (t < 0) t = (-h + root) / a;
            }
            benchmark::DoNotOptimize(t);
        }
    }
    set_ray_count(state);
}

template <class S, class Kernel>
void measure_form(benchmark::State& state, const Kernel& kernel) {
    const RaySet& set = near_rays();
    const auto stored = [](const std::vector<double>& x) { return std::vector<S>(x.begin(), x.end()); };
    const auto ox = stored(set.ox), oy = stored(set.oy), oz = stored(set.oz), dx = stored(set.dx), dy = stored(set.dy),
               dz = stored(set.dz);
    const auto cast = [](double x) { return static_cast<S>(x); };
    const Primitive<S> sphere(
        Sphere<S>{Vec<S>(cast(set.sphere.centre.x), cast(set.sphere.centre.y), cast(set.sphere.centre.z)),
                  cast(set.sphere.radius)});
    std::vector<S> t(ray_count), near(ray_count), far(ray_count);
    std::vector<std::uint8_t> hit(ray_count);
    for (auto _ : state) {
        kernel(intersect::table::RayBatch<S>{ox, oy, oz, dx, dy, dz}, sphere,
               intersect::table::HitBatch<S>{t, near, far, hit});
        benchmark::ClobberMemory();
    }
    set_ray_count(state);
}

void measure_without_rounding(benchmark::State& state, const intersect::table::Intersector& i) {
    const RaySet& set = near_rays();
    const Primitive<double> sphere(set.sphere);
    for (auto _ : state) {
        for (std::size_t r = 0; r < ray_count; ++r)
            benchmark::DoNotOptimize(measure::answer::evaluate_exactly(i, set[r], sphere));
    }
    set_ray_count(state);
}

void register_all() {
    benchmark::RegisterBenchmark("truth/near", measure_truth, near_rays);
    benchmark::RegisterBenchmark("mpfr_256/near", measure_plain_mpfr, near_rays);
    benchmark::RegisterBenchmark("truth/far", measure_truth, far_rays);
    benchmark::RegisterBenchmark("mpfr_256/far", measure_plain_mpfr, far_rays);
    for (const intersect::table::Intersector& i : intersect::table::intersectors(Shape::sphere)) {
        const std::string name(i.info->name);
        benchmark::RegisterBenchmark((name + "/f32").c_str(),
                                     [&i](benchmark::State& s) { measure_form<float>(s, i.native32); });
        if (i.native64)
            benchmark::RegisterBenchmark((name + "/f64").c_str(),
                                         [&i](benchmark::State& s) { measure_form<double>(s, i.native64); });
        if (i.rounded) {
            benchmark::RegisterBenchmark((name + "/bf16").c_str(), [&i](benchmark::State& s) {
                measure_form<double>(s, [&i](const auto&... a) { i.rounded(bfloat16, a...); });
            });
        }
        benchmark::RegisterBenchmark((name + "/without_rounding").c_str(),
                                     [&i](benchmark::State& s) { measure_without_rounding(s, i); });
    }
    for (const intersect::simd::Isa isa : intersect::simd::available_isas())
        for (const intersect::simd::PackedFormKernels& row :
             intersect::simd::all_packed_kernels(isa).first(intersect::table::intersectors(Shape::sphere).size())) {
            const std::string name = "packed_" + std::string(name_of(isa)) + "/" + std::string(row.info->name);
            benchmark::RegisterBenchmark((name + "/f32").c_str(),
                                         [&row](benchmark::State& s) { measure_form<float>(s, row.f32); });
            if (row.f64)
                benchmark::RegisterBenchmark((name + "/f64").c_str(),
                                             [&row](benchmark::State& s) { measure_form<double>(s, row.f64); });
        }
}

void print_all() {
    bench::print_truth();
    bench::print_truth_of_shapes();
    bench::print_chains();
    bench::print_rays(Shape::sphere, {"sphere.schoolbook", "sphere.unified"});
    bench::print_bytes_per_sphere();
    bench::print_filtered();
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 2 && std::string_view(argv[1]) == "--ratios") {
        print_all();
        return 0;
    }
    if (argc == 2 && std::string_view(argv[1]) == "--filtered") {
        bench::print_filtered();
        return 0;
    }
    register_all();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
