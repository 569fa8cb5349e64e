// Slow commands of the documents: ways to shorten some, and the list of those that only the long tests run.
#pragma once

#include <array>
#include <string_view>

namespace lostbits::test {

/// Commands that are run with less work than the page states. All others run as they are written there.
struct CheaperTest {
    std::string_view start, adds, why;
};
inline constexpr std::array cheaper{
    CheaperTest{"map ", " --size 32x32", "a small picture has the same files"},
    CheaperTest{"render ", " --size 32x32", "a small picture has the same files"},
    CheaperTest{"offsets ", " --size 16x12", "a small picture has the same files"},
    CheaperTest{"consistency ", " --size 16x12", "a small picture has the same files"},
    CheaperTest{"report ", " --size 32x32", "a small picture has the same parts"},
    CheaperTest{"report ", " --no-claims",
                "test_reports.cpp measures every claim, test_report.cpp has pages with claims"},
    CheaperTest{"report ", " --seeds 0", "further draws are rows of the same tables"},
    CheaperTest{"report sphere-height ", " -f f32", "a plane of each format takes 2 s"},
    CheaperTest{"sweep padding --worst ", " --set starts=16", "7 s"},
    CheaperTest{"report -o out ", " -i sphere.unified -i sdf.sphere_trace -f f32 near-benign sphere-distance",
                "all scenes take 40 s"},
    CheaperTest{"report near-benign --metric residual --trade ", " -i sphere.unified -i sphere.press",
                "times of every form are 6 s"},
    CheaperTest{"report near-benign --choose ", " -i sphere.unified -i sphere.press", "the same"},
    CheaperTest{"report rtg-fig-7-3-4100-oblique near-benign ", " -i sphere.schoolbook -i sphere.unified",
                "20 s: the page of the screenshots"},
    CheaperTest{"sweep sphere-", " --steps 8", "10 s each"},
    CheaperTest{"sweep data/sweeps/sdf-", " --steps 3", "10 s"},
    CheaperTest{"check  ", " --filter 'float.*'", "20 s; test_reports.cpp measures every claim"},
    CheaperTest{"check --profile timing", " --filter 'speed.signs-over-inclusive-*'",
                "a minute; test_check.cpp measures times"},
    CheaperTest{"trade -o out ", " --quick -i sphere.unified -i sphere.press",
                "a minute; test_trade.cpp measures every form"},
};

/// Commands that take seconds of processor time and run in the long tests only, each with what tries the like in the
/// short tests. The short tests check that the options of the slow commands exist. If several pages have such a
/// command, `start` begins with the page.
struct SlowCommand {
    std::string_view start, instead;
};
inline constexpr std::array slow_commands{
    SlowCommand{"mend box-slabs ", "test_mend.cpp, on fewer pixels"},
    SlowCommand{"mend instance-far.sphere ", "test_mend.cpp"},
    SlowCommand{"report rtg-fig-7-3-4100-oblique near-benign ", "test_report.cpp, and tests/browser"},
    SlowCommand{"report mine.toml sphere-distance ", "the same"},
    SlowCommand{"report sphere-height box-boundary ", "the same"},
    SlowCommand{"report near-benign --mend ", "test_report.cpp"},
    SlowCommand{"sweep mesh-edges --worst ", "test_same_bytes.cpp and test_shards.cpp"},
    SlowCommand{"sweep mesh-census --worst -f f32 ", "the command of docs/meshes.md, with two forms"},
    SlowCommand{"sweep exhaustive-mesh-edge ", "test_mesh_floats.cpp"},
    SlowCommand{"sweep data/sweeps/sdf-", "test_march.cpp"},
    SlowCommand{"sweep instance-distance-sphere ", "test_spaces.cpp"},
    SlowCommand{"sweep sphere-distance -i sphere.schoolbook --steps 14 ", "tests/measure/metric"},
    SlowCommand{"trade --shape box ", "test_trade.cpp"},
    SlowCommand{"trade near-benign ", "test_trade.cpp"},
    SlowCommand{"check --profile timing", "test_check.cpp"},
    SlowCommand{"check --profile libraries --device all ", "test_shader_devices"},
    SlowCommand{"docs/your-own-form.md c++ -shared ", "tests/package compiles the same file"},
    SlowCommand{"plugin check geometric.so", "tests/package checks it"},
    SlowCommand{"explain sphere-distance --ranges --at-step 128 ", "the page has it at 4 too"},
    SlowCommand{"mend data/dumps/far-sphere.csv ", "test_mend.cpp"},
    SlowCommand{"mend rtg-fig-7-3-4100-oblique -i sphere.half_b --bits 16 --size 32x32 ",
                "test_mend.cpp, without words"},
    SlowCommand{"map rtg-fig-7-3-4100-oblique --shader halved.glsl ",
                "test_shader_devices, on the bits of mended forms"},
    SlowCommand{"docs/shards.md map ", "test_shards.cpp"},
    SlowCommand{"docs/shards.md merge parts ", "test_shards.cpp"},
    SlowCommand{"docs/shards.md diff ", "test_shards.cpp"},
    SlowCommand{"sweep nearest --worst ", "test_paste.cpp has a search"},
    SlowCommand{"sweep sphere-distance -i sphere.schoolbook -i sphere.hearn_baker ", "test_sweep.cpp"},
    SlowCommand{"sweep sphere-distance -i sphere.schoolbook -f f32 --seeds 4 ", "test_sweep.cpp"},
    SlowCommand{"sweep sphere-distance --metric culprit ", "test_sweep.cpp"},
    SlowCommand{"report -o out", "test_report.cpp"},
    SlowCommand{"report near-benign --choose ", "test_report.cpp"},
    SlowCommand{"trade -o out", "test_trade.cpp"},
};

}  // namespace lostbits::test
