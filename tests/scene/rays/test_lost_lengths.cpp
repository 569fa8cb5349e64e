#include "scene/rays/lost_lengths.hpp"

#include "catch.hpp"
#include "scene/scene_text.hpp"

namespace test_lost_lengths {

using namespace lostbits;
using namespace lostbits::scene::test;
using scene::rays::LostLengths;

namespace {

using Lines = std::vector<std::string>;

FloatFormat shape_of(const char* name) { return find_format(name).value().shape; }

Lines lost(const std::vector<Solid<double>>& solids, const char* format) {
    LostLengths all(shape_of(format));
    for (std::size_t i = 0; i < solids.size(); ++i) all.add(solids[i], [i] { return "solid " + std::to_string(i); });
    return all.lines();
}

Solid<double> ball(double x, double radius) { return Sphere<double>{{x, 0, 0}, radius}; }

}  // namespace

TEST_CASE("a radius is lost from half of the smallest number down, and from half an ulp above the largest up") {
    // Halves: the smallest is 2^-24, and 2^-25 ties to 0; the largest is 65504, and 65520 ties to infinity.
    CHECK(lost({ball(0, 0x1p-24), ball(0, std::nextafter(0x1p-25, 1.0))}, "fp16").empty());
    CHECK(lost({ball(0, 65504), ball(0, std::nextafter(65520.0, 0.0))}, "fp16").empty());
    CHECK(lost({ball(0, 0x1p-25)}, "fp16") == Lines{"radius = 2.98023e-08 rounds to 0 (solid 0)"});
    CHECK(lost({ball(0, 1), ball(0, 65520)}, "fp16") == Lines{"radius = 65520 rounds to infinity (solid 1)"});
    CHECK(lost({ball(0, 1e-9), ball(0, 1), ball(0, 2e-9), ball(0, 1e6)}, "fp16") ==
          Lines{"radius = 1e-09 rounds to 0 (solid 0; 2 in all)", "radius = 1e+06 rounds to infinity (solid 3)"});
    for (const char* format : {"f32", "f64", "bf16", "tf32", "p8"})
        CHECK(lost({ball(0, 1e-9), ball(0, 1e6)}, format).empty());
    CHECK(lost({ball(0, 1e-42)}, "bf16") == Lines{"radius = 1e-42 rounds to 0 (solid 0)"});
    CHECK(lost({ball(0, 1e-42)}, "f32").empty());
}

TEST_CASE("a coordinate is lost at infinity, not at 0, a box where it has no thickness left") {
    CHECK(lost({ball(1e-9, 1)}, "fp16").empty());
    CHECK(lost({ball(-1e6, 1)}, "fp16") == Lines{"a coordinate of centre = -1e+06 rounds to infinity (solid 0)"});
    const auto box = [](double lo, double hi) { return Solid<double>(Box<double>{{0, lo, 0}, {1, hi, 1}}); };
    CHECK(lost({box(1, 1.125)}, "fp16").empty());
    CHECK(lost({box(1, 1.0001)}, "fp16") == Lines{"thickness = 0.0001 rounds to 0 (solid 0)"});
    CHECK(lost({box(1, 1)}, "fp16").empty());  // it had none before
    CHECK(lost({box(0, 1e6)}, "fp16") == Lines{"a coordinate of hi = 1e+06 rounds to infinity (solid 0)"});
    CHECK(lost({box(1e6, 1e6 + 1)}, "fp16") == Lines{"a coordinate of lo = 1e+06 rounds to infinity (solid 0)",
                                                     "a coordinate of hi = 1e+06 rounds to infinity (solid 0)"});
}

TEST_CASE("the lengths of a scene: its solids, its eye, in the words of --set") {
    const auto of = [](const std::string& text, const char* format) {
        return scene::rays::lost_lengths(loaded(text), shape_of(format));
    };
    const std::string tiny = replaced(good_scene, "radius = 1", "radius = 1e-9");
    REQUIRE(tiny != good_scene);
    CHECK(of(good_scene, "fp16").empty());
    CHECK(of(tiny, "fp16") == Lines{"radius = 1e-09 rounds to 0 (sphere[0])"});
    CHECK(of(tiny, "f32").empty());
    CHECK(of(tiny, "f64").empty());
    CHECK(of(replaced(good_scene, "eye = [0, 0, 0]", "eye = [0, 1e6, 0]"), "fp16") ==
          Lines{"a coordinate of the eye = 1e+06 rounds to infinity (camera)"});
    // Own inputs are rounded to each format from what the file says, and binary32 has no part in it.
    const std::string own = replaced(tiny, "inputs = \"shared\"", "inputs = \"own\"");
    CHECK(of(own, "fp16") == Lines{"radius = 1e-09 rounds to 0 (sphere[0])"});
    const std::string beyond = replaced(own, "radius = 1e-9", "radius = \"1e-60\"");
    CHECK(of(beyond, "f32") == Lines{"radius = 1e-60 rounds to 0 (sphere[0])"});
    CHECK(of(beyond, "f64").empty());
    CHECK(of(replaced(own, "radius = 1e-9", "radius = \"1e-400\""), "f64") ==
          Lines{"radius less than 5e-324 rounds to 0 (sphere[0])"});
}

}  // namespace test_lost_lengths
