// A run that is asked to stop in the middle of a band.
#include "catch.hpp"
#include "measure/map/map.hpp"
#include "measure/rows.hpp"
#include "number/error.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::test::test_interrupted {

TEST_CASE("a map stops at the ray that it was asked to stop at", "[measure][map]") {
    const auto found = scene::file::find_scene("near-benign", LOSTBITS_DATA_DIR);
    const auto scene =
        scene::file::load_scene(found.path, {.variant = found.variant, .size = std::pair{16, 16}}).front();
    static int measured;
    measured = 0;
    const measure::metric::Metric asks{.name = "asks", .value = [](const measure::metric::Sample&) {
                                           ++measured;
                                           asked_to_stop = true;
                                           return 0.0;
                                       }};
    const measure::map::MapRequest request{
        .scene = &scene, .rows = {testing::row("sphere.schoolbook", "f32")}, .metrics = {&asks}};
    CHECK_THROWS_AS(measure::map::run_map(request, {}), Interrupted);
    asked_to_stop = false;
    CHECK(measured == 1);
}

}  // namespace lostbits::test::test_interrupted
