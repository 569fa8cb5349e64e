// Measures the bytes per sphere that a map of a flake holds in memory, by the resident set.
#include <malloc.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <string>

#include "measure/evaluate/map.hpp"
#include "measure/metric/metrics.hpp"
#include "number/real.hpp"
#include "ratios.hpp"

namespace bench {
namespace {

using namespace lostbits;

/// Value of a line of /proc/self/status in bytes, or 0 if there is no such line.
double status(const std::string& key) {
    std::ifstream file("/proc/self/status");
    for (std::string word; file >> word;) {
        double kilobytes = 0;
        if (word == key + ":" && file >> kilobytes) return 1024 * kilobytes;
    }
    return 0;
}

/// The flake of data/scenes/sphereflake-*.toml, with other levels.
scene::file::Scene flake_scene(int levels, double distance, const char* fov_deg) {
    scene::file::Scene scene;
    scene.width = scene.height = 64;
    scene.camera.eye = Vec<Real>(Real("2.1"), Real("1.3"), Real("1.7")) * Real(distance);
    scene.camera.look_at = Vec<Real>(Real(0), Real(0), Real(0));
    scene.camera.up = Vec<Real>(Real(0), Real(1), Real(0));
    scene.camera.fov_deg = Real(fov_deg);
    scene.flake = scene::sphere::Sphereflake{.levels = levels, .axis = {0.2, 0.9, 0.4}};
    scene.listed.emplace_back(Sphere<Real>{Vec<Real>(Real(0), Real("-1001.5"), Real(0)), Real(1000)});
    return scene;
}

void print_map_of(const scene::file::Scene& scene, const char* view, const char* form, const char* format) {
    measure::evaluate::MapStudy request{
        .scene = &scene, .tested_forms = {}, .metrics = {measure::metric::find_metric("lost_bits")}};
    for (const intersect::table::Intersector& i : intersect::table::intersectors(Shape::sphere)) {
        if (i.info->name == form) request.tested_forms.push_back({&i, *find_format(format)});
    }
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";  // forget the peak so far
    const double before = status("VmRSS"), spheres = static_cast<double>(scene.primitive_count());
    const auto start = std::chrono::steady_clock::now();
    measure::evaluate::run_map(request);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%-28s %-6s %-5s %10.0f %9.1f %8.2f\n", form, format, view, spheres,
                (status("VmHWM") - before) / spheres, seconds);
}

}  // namespace

void print_bytes_per_sphere() {
    std::printf("%-28s %-6s %-5s %10s %9s %8s\n", "map of 64x64", "format", "view", "spheres", "bytes", "s");
    for (const char* format : {"f32", "f64"}) {
        print_map_of(flake_scene(7, 1, "60"), "near", "sphere.schoolbook", format);
        print_map_of(flake_scene(7, 100, "0.66158"), "far", "sphere.schoolbook", format);
    }
    std::printf("\n");
}

}  // namespace bench
