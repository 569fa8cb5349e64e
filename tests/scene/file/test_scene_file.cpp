#include <unistd.h>

#include "catch.hpp"
#include "scene/scene_text.hpp"

namespace test_scene_file {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::file;
using namespace lostbits::scene::test;

namespace {

const std::string two_variants =
    good_scene +
    "[[variant]]\nname = \"small\"\nset = { \"sphere[0].radius\" = 0.5 }\n"
    "[[variant]]\nname = \"big\"\nset = { \"sphere[0].radius\" = 2, \"camera.eye\" = [1, 2, 3] }\n";

scene::file::LoadOptions variant(const std::string& name) {
    LoadOptions options;
    options.variant = name;
    return options;
}

}  // namespace

TEST_CASE("a scene holds what its file says") {
    const scene::file::Scene s = loaded(good_scene);
    CHECK(s.id == "scene");
    CHECK(s.path.filename() == "scene.toml");
    CHECK(s.title == "A test");
    CHECK(s.source == "-");
    CHECK(s.note == "nothing");
    CHECK(s.inputs == scene::file::Inputs::shared);
    CHECK(s.width == 8);
    CHECK(s.height == 4);
    CHECK(s.camera.kind == scene::file::Camera::Kind::orthographic);
    CHECK(s.camera.look_at.z == -1);
    CHECK(s.camera.up.y == 1);
    CHECK(s.camera.width == Real(2.5));
    REQUIRE(s.listed.size() == 1);
    CHECK(s.listed[0].sphere().centre.z == -10);
    CHECK(s.listed[0].sphere().radius == 1);
}

TEST_CASE("what a scene leaves out has its default") {
    std::string text = good_scene;
    for (const std::string line :
         {"note = \"nothing\"\n", "inputs = \"shared\"\n", "size = [8, 4]\n", "up = [0, 1, 0]\n"})
        text = replaced(text, line, "");
    const scene::file::Scene s = loaded(text);
    CHECK(s.note.empty());
    CHECK(s.inputs == scene::file::Inputs::shared);
    CHECK(s.width == 256);
    CHECK(s.height == 256);
    CHECK(s.camera.up.y == 1);
    CHECK(s.camera.shift_right == 0);
    CHECK(s.camera.shift_up == 0);
    CHECK(s.camera.normalise);
}

TEST_CASE("numbers are ideal: decimals as written, in every notation") {
    const scene::file::Scene s =
        loaded(replaced(good_scene, "centre = [0, 0, -10]", "centre = [0.1, \"0.1\", \"0x1.8p+3\"]"));
    CHECK(s.listed[0].sphere().centre.x == real("0.1"));
    CHECK(s.listed[0].sphere().centre.x == s.listed[0].sphere().centre.y);
    CHECK(s.listed[0].sphere().centre.z == 12);
}

TEST_CASE("a file with variants gives a scene for each, in order, and none without") {
    const std::vector<scene::file::Scene> all = all_loaded(two_variants);
    REQUIRE(all.size() == 2);
    CHECK(all[0].id == "scene.small");
    CHECK(all[1].id == "scene.big");
    CHECK(all[0].listed[0].sphere().radius == Real(0.5));
    CHECK(all[0].camera.eye.x == 0);  // one variant leaves the next alone
    CHECK(all[1].listed[0].sphere().radius == 2);
    CHECK(all[1].camera.eye.z == 3);
}

TEST_CASE("one variant can be chosen by name") {
    const std::vector<scene::file::Scene> one = all_loaded(two_variants, variant("big"));
    REQUIRE(one.size() == 1);
    CHECK(one[0].id == "scene.big");
    CHECK(scene_error(two_variants, variant("bog")) == "scene.toml: no variant \"bog\"; did you mean \"big\"?");
    CHECK(scene_error(good_scene, variant("big")) == "scene.toml: no variant \"big\"; the file has none");
}

TEST_CASE("a size override changes the size alone") {
    scene::file::LoadOptions options;
    options.size = {320, 240};
    const scene::file::Scene s = loaded(good_scene, options);
    CHECK(s.width == 320);
    CHECK(s.height == 240);
    CHECK(s.listed[0].sphere().radius == 1);
    const std::string without = replaced(good_scene, "size = [8, 4]\n", "");
    CHECK(loaded(without, options).width == 320);
}

TEST_CASE("scenes are listed by name") {
    const Scratch data;
    CHECK(error_of([&] { scene::file::scene_files(data.path()); }).find("is not a folder of scenes") !=
          std::string::npos);
    data.write("scenes/b.toml", good_scene);
    data.write("scenes/a.toml", good_scene);
    data.write("scenes/readme.md", "");
    const auto files = scene::file::scene_files(data.path());
    REQUIRE(files.size() == 2);
    CHECK(files[0].filename() == "a.toml");
    CHECK(files[1].filename() == "b.toml");
}

TEST_CASE("a scene is found by path, id or id and variant") {
    const Scratch data;
    const fs::path near = data.write("scenes/near.toml", good_scene);
    const fs::path far = data.write("scenes/far-2.5.toml", two_variants);
    CHECK(scene::file::find_scene("near", data.path()).path == near);
    CHECK_FALSE(find_scene("near", data.path()).variant);
    CHECK(find_scene("near.toml", data.path()).path == near);
    CHECK(find_scene(near.string(), data.path()).path == near);
    CHECK(find_scene("./elsewhere.toml", data.path()).path == "./elsewhere.toml");
    CHECK(find_scene("far-2.5", data.path()).path == far);
    CHECK_FALSE(find_scene("far-2.5", data.path()).variant);
    CHECK(find_scene("far-2.5.big", data.path()).path == far);
    CHECK(find_scene("far-2.5.big", data.path()).variant == "big");
    const std::string folder = (data.path() / "scenes").string();
    CHECK(error_of([&] { find_scene("neer", data.path()); }) ==
          "no scene \"neer\" in " + folder + "; did you mean \"near\"? (a path to a .toml file works too)");
    CHECK(error_of([&] { find_scene("neer.big", data.path()); }).find("did you mean \"near\"?") != std::string::npos);
    CHECK(error_of([&] { find_scene("zzzzzz", data.path()); }).find("known here: \"far-2.5\", \"near\"") !=
          std::string::npos);
}

}  // namespace test_scene_file
