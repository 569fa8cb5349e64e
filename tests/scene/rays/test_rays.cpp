// Rays and primitives rounded to a format, primitives as columns, and lengths that a format cannot hold.
#include <cmath>

#include "catch.hpp"
#include "number/real.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/primitive_list.hpp"
#include "scene/rays/rays.hpp"
#include "scene/rays/unrepresentable_lengths.hpp"
#include "scene/scene_text.hpp"
#include "scene/toml/round.hpp"

namespace test_rays {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::file;
using namespace lostbits::scene::rays;
using namespace lostbits::scene::toml;
using namespace lostbits::scene::test;

namespace {

const std::string pinhole_scene =
    replace_text(replace_text(replace_text(good_scene, "kind = \"orthographic\"", "kind = \"pinhole\""), "width = 2.5",
                              "fov_deg = 40"),
                 "eye = [0, 0, 0]", "eye = [0.1, 0.2, 0.3]");

bool same(const RayBlock& a, const RayBlock& b) {
    return a.ox == b.ox && a.oy == b.oy && a.oz == b.oz && a.dx == b.dx && a.dy == b.dy && a.dz == b.dz;
}

bool all_binary32(const std::vector<double>& v) {
    for (const double x : v)
        if (static_cast<double>(static_cast<float>(x)) != x) return false;
    return true;
}

/// Two spheres and a flake of ninety-one.
file::Scene flake_scene(const std::string& inputs) {
    const std::string text = replace_text(
        good_scene, "[[sphere]]",
        "[sphereflake]\nlevels = 2\nradius = 0.7\ncentre = [0.1, 0.2, 0.3]\n[[sphere]]\ncentre = [0.1, -7, 0]\n"
        "radius = 3.3\n[[sphere]]");
    file::Scene scene = load_text(text);
    if (inputs == "own") scene.inputs = file::InputRounding::own;
    return scene;
}

template <class T>
void check_columns(const PrimitiveList<double>& list, std::size_t begin, std::size_t count) {
    std::array<std::vector<T>, 4> columns_of_spheres;
    const auto columns = list.columns<T>(begin, count, columns_of_spheres);
    for (std::size_t k = 0; k < 4; ++k) {
        REQUIRE(columns[k].size() == count);
        for (std::size_t i = 0; i < count; ++i) CHECK(columns[k][i] == static_cast<T>(list[begin + i].numbers[k]));
    }
}

using Lines = std::vector<std::string>;

FloatFormat shape_of(const char* name) { return find_format(name).value().parameters; }

Lines lost(const std::vector<Primitive<double>>& primitives, const char* format) {
    UnrepresentableLengths all(shape_of(format));
    for (std::size_t i = 0; i < primitives.size(); ++i)
        all.add(primitives[i], [i] { return "solid " + std::to_string(i); });
    return all.lines();
}

Primitive<double> ball(double x, double radius) { return Sphere<double>{{x, 0, 0}, radius}; }

}  // namespace

TEST_CASE("shared rays are the camera's doubles rounded once to binary32") {
    const Scene s = load_text(pinhole_scene);
    const RayBlock block = make_shared_rays(s, 0, s.height);
    REQUIRE(block.size() == 32);
    CHECK(block.width == 8);
    const CameraFrame<double> frame = make_frame<double>(s);
    int rounded = 0;
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 8; ++x) {
            const auto i = static_cast<std::size_t>(y * 8 + x);
            const Ray<double> r = ray(frame, x, y);
            REQUIRE(block.ox[i] == static_cast<double>(static_cast<float>(r.origin.x)));
            REQUIRE(block.dx[i] == static_cast<double>(static_cast<float>(r.direction.x)));
            REQUIRE(block.dy[i] == static_cast<double>(static_cast<float>(r.direction.y)));
            REQUIRE(block.dz[i] == static_cast<double>(static_cast<float>(r.direction.z)));
            rounded += block.dz[i] != r.direction.z;
        }
    }
    CHECK(rounded > 16);
}

TEST_CASE("a band of rows has the rays of that part of the picture") {
    const Scene s = load_text(pinhole_scene);
    const RayBlock whole = make_shared_rays(s, 0, 4);
    const RayBlock band = make_shared_rays(s, 1, 3);
    REQUIRE(band.size() == 16);
    CHECK(band.y0 == 1);
    CHECK(band.y1 == 3);
    for (std::size_t i = 0; i < band.size(); ++i) {
        CHECK(band[i].direction == whole[i + 8].direction);
        CHECK(band[i].origin == whole[i + 8].origin);
    }
    CHECK(make_shared_rays(s, 2, 2).size() == 0);
    CHECK(make_own_rays(s, 1, 3).size() == 16);
}

TEST_CASE("own inputs are the ideal rays rounded once to each format") {
    const Scene s = load_text(pinhole_scene);
    const IdealRayBlock ideal = make_own_rays(s, 0, 4);
    const RayBlock single = round_rays(ideal, binary32);
    const RayBlock half = round_rays(ideal, binary16);
    CHECK(all_binary32(single.dx));
    CHECK(single.ox[0] == static_cast<double>(0.1f));
    CHECK(round_rays(ideal, binary64).ox[0] == 0.1);
    CHECK(half.ox[0] == 0x1.998p-4);
    for (std::size_t i = 0; i < ideal.size(); ++i) {
        REQUIRE(single.dy[i] == round_to_format(ideal.dy[i], binary32));
        REQUIRE(half.dz[i] == round_to_format(ideal.dz[i], binary16));
        REQUIRE(abs(Real(single.dy[i]) - ideal.dy[i]) <= 0x1p-25);
    }
}

TEST_CASE("input rays follow the scene's inputs and the format") {
    const Scene shared = load_text(pinhole_scene);
    const Scene own = load_text(replace_text(pinhole_scene, "\"shared\"", "\"own\""));
    const RayBlock stored = make_shared_rays(shared, 0, 4);
    CHECK(same(make_input_rays(shared, 0, 4, binary32), stored));
    CHECK(same(make_input_rays(shared, 0, 4, binary64), stored));
    CHECK(same(make_input_rays(shared, 0, 4, binary16), round_block(stored, binary16)));
    CHECK_FALSE(same(make_input_rays(shared, 0, 4, binary16), stored));
    CHECK_FALSE(same(make_input_rays(own, 0, 4, binary64), stored));
    CHECK(same(make_input_rays(own, 0, 4, binary64), round_rays(make_own_rays(own, 0, 4), binary64)));
}

TEST_CASE("a block of rays is rounded to a narrower format, also at subnormals and overflow") {
    const RayBlock block{.width = 3,
                         .y0 = 0,
                         .y1 = 1,
                         .ox = {1e6, -1e6, 1},
                         .oy = {0x1p-25, 0x1.8p-24, 0},
                         .oz = {65519, 65520, 1},
                         .dx = {0.1, 1, -1},
                         .dy = {0, 0, 1e-9},
                         .dz = {-1e-9, 1, 1}};
    const RayBlock half = round_block(block, binary16);
    CHECK(half.ox == std::vector<double>{HUGE_VAL, -HUGE_VAL, 1});
    CHECK(half.oy == std::vector<double>{0, 0x1p-23, 0});
    CHECK(half.oz == std::vector<double>{65504, HUGE_VAL, 1});
    CHECK(half.dx == std::vector<double>{0x1.998p-4, 1, -1});
    CHECK(half.dy == std::vector<double>{0, 0, 0});
    CHECK(std::signbit(half.dz[0]));
    CHECK(half.width == 3);
    CHECK(half.y1 == 1);
}

TEST_CASE("a list with a sphereflake in columns holds the same numbers as its single primitives") {
    for (const char* inputs : {"shared", "own"}) {
        const file::Scene scene = flake_scene(inputs);
        const bool own = scene.inputs == file::InputRounding::own;
        const auto ideal = scene.primitives();
        const auto shared = make_shared_primitives(scene);
        for (const char* name : {"f32", "f64", "fp16", "p20", "p30"}) {
            const FloatFormat f = find_format(name)->parameters;
            INFO(inputs << " in " << name);
            const PrimitiveList<double> list = own ? round_primitives(make_ideal_primitive_list(scene), f)
                                                   : round_primitives(make_shared_primitive_list(scene), f);
            REQUIRE(list.size() == 93);
            REQUIRE(list.listed_primitives().size() == 2);
            CHECK(list.all().size() == 93);
            for (std::size_t i = 0; i < list.size(); ++i) {
                const Primitive<double> one = own ? round_primitive(ideal[i], f) : round_primitive(shared[i], f);
                CHECK(list[i].numbers == one.numbers);
                CHECK(list.all()[i].numbers == one.numbers);
            }
            check_columns<double>(list, 0, 93);
            check_columns<double>(list, 40, 20);
            if (f.precision <= binary32.precision) {
                check_columns<float>(list, 1, 5);
                check_columns<float>(list, 2, 91);
            }
        }
    }
}

TEST_CASE("copies of a list share the sphereflake, and its columns are read in place") {
    const PrimitiveList<double> list = make_shared_primitive_list(flake_scene("shared")),
                                copy = round_primitives(list, binary64);
    CHECK(copy.flake() == list.flake());
    std::array<std::vector<float>, 4> columns_of_spheres;
    CHECK(copy.columns<float>(10, 64, columns_of_spheres)[3].data() ==
          list.flake()->stored_columns<float>()->at(3).data() + 8);
    CHECK(columns_of_spheres[0].empty());
    CHECK(list.flake()->stored_columns<double>() == nullptr);
}

TEST_CASE("a radius is lost at half the smallest number and below, and half an ulp above the largest") {
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

TEST_CASE("a coordinate is lost when it becomes infinite, and a box when it has no thickness left") {
    CHECK(lost({ball(1e-9, 1)}, "fp16").empty());
    CHECK(lost({ball(-1e6, 1)}, "fp16") == Lines{"a coordinate of centre = -1e+06 rounds to infinity (solid 0)"});
    const auto box = [](double lo, double hi) { return Primitive<double>(Box<double>{{0, lo, 0}, {1, hi, 1}}); };
    CHECK(lost({box(1, 1.125)}, "fp16").empty());
    CHECK(lost({box(1, 1.0001)}, "fp16") == Lines{"thickness = 0.0001 rounds to 0 (solid 0)"});
    CHECK(lost({box(1, 1)}, "fp16").empty());  // it had none before
    CHECK(lost({box(0, 1e6)}, "fp16") == Lines{"a coordinate of hi = 1e+06 rounds to infinity (solid 0)"});
    CHECK(lost({box(1e6, 1e6 + 1)}, "fp16") == Lines{"a coordinate of lo = 1e+06 rounds to infinity (solid 0)",
                                                     "a coordinate of hi = 1e+06 rounds to infinity (solid 0)"});
}

TEST_CASE("the lengths of a scene are listed by their --set paths: primitives and eye") {
    const auto of = [](const std::string& text, const char* format) {
        return find_unrepresentable_lengths(load_text(text), shape_of(format));
    };
    const std::string tiny = replace_text(good_scene, "radius = 1", "radius = 1e-9");
    REQUIRE(tiny != good_scene);
    CHECK(of(good_scene, "fp16").empty());
    CHECK(of(tiny, "fp16") == Lines{"radius = 1e-09 rounds to 0 (sphere[0])"});
    CHECK(of(tiny, "f32").empty());
    CHECK(of(tiny, "f64").empty());
    CHECK(of(replace_text(good_scene, "eye = [0, 0, 0]", "eye = [0, 1e6, 0]"), "fp16") ==
          Lines{"a coordinate of the eye = 1e+06 rounds to infinity (camera)"});
    // Own inputs are rounded to each format from the numbers of the file, without binary32 in between.
    const std::string own = replace_text(tiny, "inputs = \"shared\"", "inputs = \"own\"");
    CHECK(of(own, "fp16") == Lines{"radius = 1e-09 rounds to 0 (sphere[0])"});
    const std::string beyond = replace_text(own, "radius = 1e-9", "radius = \"1e-60\"");
    CHECK(of(beyond, "f32") == Lines{"radius = 1e-60 rounds to 0 (sphere[0])"});
    CHECK(of(beyond, "f64").empty());
    CHECK(of(replace_text(own, "radius = 1e-9", "radius = \"1e-400\""), "f64") ==
          Lines{"radius less than 5e-324 rounds to 0 (sphere[0])"});
}

}  // namespace test_rays
