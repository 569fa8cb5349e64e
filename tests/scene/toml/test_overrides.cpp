#include "catch.hpp"
#include "scene/scene_text.hpp"

namespace test_overrides {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::file;
using namespace lostbits::scene::toml;
using namespace lostbits::scene::test;

namespace {

scene::file::LoadOptions set(const std::string& assignment) {
    LoadOptions options;
    options.overrides.push_back(parse_override(assignment));
    return options;
}

std::string set_error(const std::string& assignment) {
    return error_of([&] { loaded(good_scene, set(assignment)); });
}

}  // namespace

TEST_CASE("an override changes one number, vector, element or name") {
    CHECK(loaded(good_scene, set("sphere[0].radius=1e3")).listed[0].sphere().radius == 1000);
    CHECK(loaded(good_scene, set(" sphere[0].radius = 0x1.8p+1 ")).listed[0].sphere().radius == 3);
    CHECK(loaded(good_scene, set("sphere[0].radius=\"0.1\"")).listed[0].sphere().radius == real("0.1"));
    CHECK(loaded(good_scene, set("sphere[0].radius=0.1")).listed[0].sphere().radius == real("0.1"));
    CHECK(loaded(good_scene, set("sphere[0].centre=[1, 2, -30]")).listed[0].sphere().centre.z == -30);
    const scene::file::Scene moved = loaded(good_scene, set("sphere[0].centre[2]=-30"));
    CHECK(moved.listed[0].sphere().centre.z == -30);
    CHECK(moved.listed[0].sphere().centre.x == 0);
    CHECK(loaded(good_scene, set("inputs=own")).inputs == scene::file::Inputs::own);
    CHECK(loaded(good_scene, set("title=plain words")).title == "plain words");
}

TEST_CASE("an override may give an optional key that the file leaves out") {
    const scene::file::Scene shifted = loaded(good_scene, set("camera.shift=[0.25, -1]"));
    CHECK(shifted.camera.shift_right == Real(0.25));
    CHECK(shifted.camera.shift_up == -1);
}

TEST_CASE("overrides apply in order, after the variant's, and the size last") {
    scene::file::LoadOptions options = set("sphere[0].radius=2");
    options.overrides.push_back(scene::toml::parse_override("sphere[0].radius=3"));
    options.overrides.push_back(parse_override("size=[9, 9]"));
    options.size = {64, 32};
    const std::string text =
        good_scene + "[[variant]]\nname = \"v\"\nset = { \"sphere[0].radius\" = 7, \"camera.width\" = 5 }\n";
    const scene::file::Scene result = loaded(text, options);
    CHECK(result.listed[0].sphere().radius == 3);
    CHECK(result.camera.width == 5);
    CHECK(result.width == 64);
    CHECK(result.height == 32);
}

TEST_CASE("an exact number makes an override, for the axes of sweeps") {
    const Real x = real("0.1");
    scene::file::LoadOptions options;
    options.overrides.push_back(
        {"sphere[0].radius", scene::toml::Node::of_number(x, {"a sweep", 0, 0}), {"a sweep", 0, 0}});
    CHECK(loaded(good_scene, options).listed[0].sphere().radius == x);
}

TEST_CASE("a file is parsed once and interpreted under many overrides") {
    const Scratch folder;
    const scene::file::SceneFile file(folder.write("scene.toml", good_scene));
    CHECK(file.load(set("sphere[0].radius=2")).at(0).listed[0].sphere().radius == 2);
    CHECK(file.load(set("camera.width=3")).at(0).listed[0].sphere().radius == 1);
}

TEST_CASE("an override of an unknown path says what is there") {
    CHECK(
        set_error("sphre[0].radius=2") ==
        R"(--set sphre[0].radius=2: unknown path "sphre[0].radius": the file has no "sphre"; did you mean "sphere"?)");
    CHECK(set_error("camra.eye=[1,1,1]") ==
          R"(--set camra.eye=[1,1,1]: unknown path "camra.eye": the file has no "camra"; did you mean "camera"?)");
    CHECK(set_error("sphere[0].raduis=2") ==
          R"(--set sphere[0].raduis=2: unknown key sphere[0].raduis; did you mean "radius"?)");
    CHECK(set_error("camera.wdth=2") == R"(--set camera.wdth=2: unknown key camera.wdth; did you mean "width"?)");
    CHECK(set_error("titel=x") == R"(--set titel=x: unknown key titel; did you mean "title"?)");
    CHECK(set_error("sphere[1].radius=2") ==
          R"(--set sphere[1].radius=2: unknown path "sphere[1].radius": sphere is an array of 1; )"
          R"(indices go from 0 to 0)");
    CHECK(
        set_error("sphere.radius=2") ==
        R"(--set sphere.radius=2: unknown path "sphere.radius": sphere is an array of 1; say which: sphere[0].radius)");
    CHECK(set_error("camera[0].eye=2") ==
          R"(--set camera[0].eye=2: unknown path "camera[0].eye": camera is a table, which has no )"
          R"(indices; leave [...] out)");
    CHECK(set_error("title.x=2") ==
          R"(--set title.x=2: unknown path "title.x": title is the string "A test", which has no )"
          R"(keys; end the path there)");
    CHECK(set_error("sphere[0].centre[3]=2") ==
          R"(--set sphere[0].centre[3]=2: unknown path "sphere[0].centre[3]": sphere[0].centre is an )"
          R"(array of 3; indices go from 0 to 2)");
}

TEST_CASE("a malformed override says how one is written") {
    const std::string advice = "; write path=value, as in sphere[0].radius=1e3";
    CHECK(set_error("radius") == "--set radius: is not an assignment" + advice);
    CHECK(set_error("=3") == "--set =3: is not an assignment" + advice);
    CHECK(set_error("camera.eye=") == "--set camera.eye=: has no value after =" + advice);
    const std::string keys = "; write keys and indices from 0, as in sphere[0].radius";
    CHECK(set_error("camera..eye=1") == "--set camera..eye=1: the path \"camera..eye\" has an empty key" + keys);
    CHECK(set_error("camera.=1") == "--set camera.=1: the path \"camera.\" has an empty key" + keys);
    CHECK(set_error("[0].radius=1") == "--set [0].radius=1: the path \"[0].radius\" has an empty key" + keys);
    CHECK(set_error("sphere[x].radius=1") ==
          "--set sphere[x].radius=1: the path \"sphere[x].radius\" has an index that is not a whole number" + keys);
    CHECK(set_error("sphere[-1].radius=1") ==
          "--set sphere[-1].radius=1: the path \"sphere[-1].radius\" has an index that is not a whole number" + keys);
    CHECK(set_error("sphere[0=1") ==
          "--set sphere[0=1: the path \"sphere[0\" has an index that is not a whole number" + keys);
    CHECK(set_error("sphere[0]radius=1") ==
          "--set sphere[0]radius=1: the path \"sphere[0]radius\" continues after an index without a dot" + keys);
}

TEST_CASE("a value that the scene refuses is refused in the option's name") {
    CHECK(set_error("sphere[0].radius=-1") ==
          "--set sphere[0].radius=-1: sphere[0].radius must be greater than 0; write a positive number");
    CHECK(set_error("sphere[0].radius=abc")
              .starts_with("--set sphere[0].radius=abc: sphere[0].radius = \"abc\" is not a number; write"));
    CHECK(set_error("sphere[0].centre=[1, 2")
              .starts_with("--set sphere[0].centre=[1, 2: sphere[0].centre is the string \"[1, 2\", but an array"));
    CHECK(set_error("camera.kind=pinhol") ==
          "--set camera.kind=pinhol: camera.kind is \"pinhol\", which is not known; did you mean \"pinhole\"?");
}

TEST_CASE("plain tables in a variant's set extend the path") {
    const std::string text =
        good_scene + "[[variant]]\nname = \"v\"\nset = { camera.width = 7, \"sphere[0]\".radius = 2 }\n";
    CHECK(loaded(text).camera.width == 7);
    CHECK(loaded(text).listed[0].sphere().radius == 2);
}

TEST_CASE("a variant's overrides apply in the order of writing") {
    const std::string wide_last =
        good_scene +
        "[[variant]]\nname = \"v\"\nset = { \"sphere[0].centre[0]\" = 9, \"sphere[0].centre\" = [1, 1, 1] }\n";
    CHECK(loaded(wide_last).listed[0].sphere().centre.x == 1);
    const std::string narrow_last =
        good_scene +
        "[[variant]]\nname = \"v\"\nset = { \"sphere[0].centre\" = [1, 1, 1], \"sphere[0].centre[0]\" = 9 }\n";
    CHECK(loaded(narrow_last).listed[0].sphere().centre.x == 9);
}

TEST_CASE("a range can be given to the rays of any scene, of all rays that lie ahead before") {
    using scene::test::good_scene;
    CHECK(scene::test::loaded(good_scene).range.is_whole());
    LoadOptions options;
    options.overrides.push_back(parse_override("rays.tmin=4.5"));
    const auto scene = scene::test::loaded(good_scene, options);
    CHECK(scene.range.tmin == 4.5);
    CHECK(std::isinf(scene.range.tmax));
    options.overrides.push_back(parse_override("rays.tmim=4.5"));
    CHECK(scene::test::error_of([&] { scene::test::loaded(good_scene, options); }).find("did you mean \"tmin\"") !=
          std::string::npos);
}

}  // namespace test_overrides
