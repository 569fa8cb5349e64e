// Sweeps along axes: the values of an axis.
#include "scene/sweep/sweep_file.hpp"

#include <cmath>

#include "catch.hpp"
#include "scene/scene_text.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/exhaustive_file.hpp"

namespace test_sweep_file {

using namespace lostbits;
using namespace lostbits::scene::sweep;
using namespace lostbits::scene::test;

namespace {

const std::string radius_axis =
    "[[axis]]\nspacing = \"linear\"\nfrom = 1\nto = 2\nsteps = 2\nset = [\"sphere[0].radius\"]\n";

SweepFile along(const std::string& from, const std::string& to) {
    const std::string text = sweep_head + R"(scene = "near-benign"
convention = "open"
[[axis]]
name = "x"
spacing = "every_float"
set = ["sphere[0].centre[0]"]
)";
    return read_as<SweepFile>("s.toml", text + "from = \"" + from + "\"\nto = \"" + to + "\"\n", LOSTBITS_DATA_DIR);
}

}  // namespace

TEST_CASE("steps over every float have distinct values, and both zeros are one") {
    const double least = 0x1p-149;
    const Axis across = along("-0x1p-148", "0x1p-148").axes.front();
    CHECK(across.values == std::vector<double>{-2 * least, -least, 0, least, 2 * least});
    CHECK_FALSE(std::signbit(across.values[2]));
    CHECK(across.middle(-2 * least, 2 * least) == 0);
    CHECK_FALSE(std::signbit(across.middle(-2 * least, 2 * least)));
    const Axis below = along("-0x1.000004p0", "-1").axes.front();
    CHECK(below.values == std::vector<double>{-0x1.000004p0, -0x1.000002p0, -1});
}

TEST_CASE("an axis of powers of two must begin and end above 0") {
    for (const char* from : {"0", "-1"}) {
        std::string axis = replace_text(radius_axis, "linear", "log2") + "name = \"x\"\n";
        axis = replace_text(axis, "from = 1", std::string("from = ") + from);
        CHECK(error_as<SweepFile>("s.toml", sweep_head + "scene = \"near-benign\"\n" + axis, LOSTBITS_DATA_DIR)
                  .starts_with("s.toml:7:8: axis[0].from and to must be positive"));
    }
}

TEST_CASE("the middle of two floats lies between them as long as another float does") {
    const SweepFile sweep = along("1", "0x1.00001p0");
    const Axis& axis = sweep.axes.front();
    CHECK(sweep.convention == intersect::Touching::miss);
    const double next = 0x1.000002p0;
    CHECK(axis.middle(1, 0x1.000004p0) == next);
    CHECK(axis.middle(0x1.000004p0, 1) == next);
    for (const auto& [a, b] :
         {std::pair{1.0, next}, {next, 1.0}, {0.0, 0x1p-149}, {-0x1p-149, 0.0}, {-0.0, 0x1p-149}}) {
        CAPTURE(a, b);
        const double middle = axis.middle(a, b);
        CHECK((middle == a || middle == b));
    }
    CHECK(axis.middle(0x1p-3, 0x1p5) == 2);
}

TEST_CASE("every axis in data has a label, and other labels follow from name and unit") {
    std::size_t axes = 0;
    const auto is_words = [&axes](const AxisName& axis) {
        CAPTURE(axis.name, axis.label);
        ++axes;
        CHECK(axis.label != axis.name);
        CHECK(axis.label.find('_') == std::string::npos);
        // A unit is given in words, after "in"; `r` is not a unit.
        if (!axis.unit.empty()) {
            const std::string unit = axis.unit == "r" ? "radii" : axis.unit;
            CHECK(has(axis.label, ", in " + unit));
        }
    };
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::filesystem::path(LOSTBITS_DATA_DIR) / "sweeps")) {
        if (entry.path().extension() != ".toml") continue;
        INFO(entry.path().string());
        switch (read_sweep_kind(entry.path())) {
            case SweepKind::axes:
                for (const Axis& axis : SweepFile(entry.path(), LOSTBITS_DATA_DIR).axes) is_words(axis);
                break;
            case SweepKind::every_float: is_words(ExhaustiveFile(entry.path(), LOSTBITS_DATA_DIR).axis); break;
            case SweepKind::cases:
            case SweepKind::search:
            case SweepKind::edge_search: break;
        }
    }
    CHECK(axes > 25);

    const auto label = [](const std::string& keys) {
        const std::string text = sweep_head + "scene = \"near-benign\"\n" + radius_axis + keys;
        return read_as<SweepFile>("s.toml", text, LOSTBITS_DATA_DIR).axes.front().label;
    };
    CHECK(label("name = \"distance_radii\"\nunit = \"r\"\n") == "distance, in radii");
    CHECK(label("name = \"gap_sizes\"\nunit = \"sizes\"\n") == "gap, in sizes");
    CHECK(label("name = \"eye_height\"\nunit = \"m\"\n") == "eye height, in m");
    CHECK(label("name = \"hit_eps\"\n") == "hit eps");
    CHECK(label("name = \"scale\"\nunit = \"1\"\n") == "scale");
    CHECK(label("name = \"x\"\nlabel = \"how far, in miles\"\n") == "how far, in miles");
}

TEST_CASE("a sweep over a mesh includes all primitives of its scene") {
    const Scratch folder;
    const std::string mesh = "[[mesh]]\nmake = \"icosphere\"\nlevels = 1\n", march = "[march]\nhit_eps = 1e-4\n";
    const auto group = [&](const std::string& more) {
        folder.write("scene.toml", good_scene + more);
        const auto path =
            folder.write("s.toml", sweep_head + "scene = \"scene.toml\"\n" + radius_axis + "name = \"x\"\n");
        return SweepFile(path, LOSTBITS_DATA_DIR).rays({1}).front();
    };
    const auto alone = group(mesh), flake = group(mesh + "[sphereflake]\nlevels = 1\nradius = 0.5\n"),
               marched = group(mesh + march);
    REQUIRE(alone.mesh);
    CHECK(alone.primitives.size() == 1);
    CHECK(alone.mesh->size() == 80);
    CHECK_FALSE(flake.mesh);
    CHECK(flake.primitives.size() == 1 + 10 + 80);
    CHECK_FALSE(marched.mesh);
    CHECK(marched.primitives.size() == 1 + 80);
}

}  // namespace test_sweep_file
