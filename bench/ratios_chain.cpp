// Measures whole chains, from rays to the numbers of tables: a row of a map, and every float of an axis.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "intersect/simd/packed.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/sweep/exhaustive.hpp"
#include "measure/tape/tape_form.hpp"
#include "ratios.hpp"

namespace bench {
namespace {

using namespace lostbits;

const intersect::table::Intersector& form_named(std::string_view name) {
    for (const auto& form : intersect::table::intersectors(Shape::sphere))
        if (form.info->name == name) return form;
    throw std::logic_error("no such form");
}

double seconds_of(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A picture of 256 × 128 rays that one sphere fills, as in a band of a map.
scene::rays::RayGroup draw_picture_rays() {
    scene::rays::RayGroup group;
    group.rays.width = 256;
    group.rays.y1 = 128;
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 256; ++x) {
            const auto at = [](int k, int n) { return static_cast<double>(static_cast<float>((k + 0.5) / n - 0.5)); };
            group.rays.push({{0.25, 0.125, 4}, {at(x, 256), at(y, 128), -1}});
        }
    }
    group.primitives = {Primitive<double>(Sphere<double>{{0, 0, 0}, 1})};
    return group;
}

void print_rows() {
    std::vector<const measure::metric::Metric*> metrics;
    for (const char* name : {"lost_bits", "ulp_error", "relative_error", "residual"})
        metrics.push_back(measure::metric::find_metric(name));
    const scene::rays::RayGroup group = draw_picture_rays();
    const auto rays = static_cast<double>(group.rays.size());
    for (const char* format : {"f32", "f64"}) {
        for (const char* form : {"sphere.schoolbook", "sphere.unified"}) {
            const measure::evaluate::TestedForm row{&form_named(form), *find_format(format)};
            double truth = HUGE_VAL, rest = HUGE_VAL;
            for (int k = 0; k < 9; ++k) {
                std::optional<measure::truth::Band> band;
                truth = std::min(truth, seconds_of([&] { band.emplace(group); }));
                const auto inputs = band->inputs(row.format, {});
                measure::evaluate::FormSummary summary(metrics);
                rest = std::min(rest, seconds_of([&] {
                                    measure::evaluate::measure_form({row, metrics}, *band, inputs, summary);
                                }));
            }
            std::printf("%-28s %-6s %12.1f %12.1f\n", form, format, 1e9 * truth / rays, 1e9 * rest / rays);
        }
    }
}

/// Prints the speed of tapes, by which `lostbits mend` tries its candidates.
void print_tapes() {
    const auto& form = form_named("sphere.schoolbook");
    const Format format = *find_format("f32");
    const Tape plain = measure::tape::record_tape(form, format);
    const auto all = measure::tape::find_widenable_operations(plain);
    const measure::truth::Band band(draw_picture_rays());
    const auto inputs = band.inputs(format, {});
    std::printf("\n%-28s %18s\n", "tape of sphere.schoolbook", "million operations/s");
    for (const auto& [name, tape] :
         {std::pair("in float", plain), std::pair("in double", measure::tape::widen_operations(plain, all, binary64)),
          std::pair("in two floats", measure::tape::widen_operations(plain, all, measure::tape::two_floats))}) {
        const measure::tape::TapeForm row(form, format, tape, "tape", "");
        double best = HUGE_VAL;
        for (int k = 0; k < 9; ++k)
            best = std::min(best, seconds_of([&] { measure::answer::evaluate(row.form(), inputs); }));
        const double done = static_cast<double>(row.program().operation_count() * band.pixel_count());
        std::printf("%-28s %18.0f\n", name, done / best / 1e6);
    }
}

void print_every_float() {
    const auto file = std::filesystem::temp_directory_path() / "lostbits-bench-every-float.toml";
    std::ofstream(file) << R"(schema = "lostbits-sweep/1"
title = "Every distance between 2 and 16"
source = "-"
note = "-"
[axis]
name = "distance"
spacing = "every_float"
set = "ray.origin.z"
from = 2
to = 16
[[ray]]
name = "half"
origin = [0.5, 0.25, 2]
direction = [0, 0, -1]
[sphere]
centre = [0, 0, 0]
radius = 1
)";
    const scene::sweep::ExhaustiveFile sweep(file, {});
    for (const char* form : {"sphere.schoolbook", "sphere.unified"}) {
        const measure::sweep::ExhaustiveRequest request{.sweep = sweep,
                                                        .tested_forms = {{&form_named(form), *find_format("f32")}}};
        measure::sweep::ExhaustiveState state;
        const double seconds = seconds_of([&] { measure::sweep::run_exhaustive(request, state); });
        std::printf("%-28s %-6s %25.1f   (all processors together)\n", form, "f32",
                    1e9 * seconds / static_cast<double>(state.tried_float_count));
    }
    std::filesystem::remove(file);
}

}  // namespace

void print_chains() {
    std::printf("%-28s %-6s %12s %12s\n", "row of a map, ns a ray", "format", "truth", "all the rest");
    print_rows();
    std::printf("%-28s %-6s %25s\n", "every float, ns a float", "format", "truth and all");
    print_every_float();
    print_tapes();
    std::printf("\n");
}

}  // namespace bench
