// Scene files, their variants, and overrides.
#include <unistd.h>

#include "catch.hpp"
#include "number/real.hpp"
#include "scene/scene_text.hpp"

namespace test_scene_file {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::file;
using namespace lostbits::scene::test;
using namespace lostbits::scene::toml;

namespace {

const std::string two_variants =
    good_scene +
    "[[variant]]\nname = \"small\"\nset = { \"sphere[0].radius\" = 0.5 }\n"
    "[[variant]]\nname = \"big\"\nset = { \"sphere[0].radius\" = 2, \"camera.eye\" = [1, 2, 3] }\n";

LoadOptions variant(const std::string& name) {
    LoadOptions options;
    options.variant = name;
    return options;
}

LoadOptions set(const std::string& assignment) {
    LoadOptions options;
    options.overrides.push_back(parse_override(assignment));
    return options;
}

std::string set_error(const std::string& assignment) {
    return error_of([&] { load_text(good_scene, set(assignment)); });
}

}  // namespace

TEST_CASE("omitted keys of a scene have their defaults") {
    std::string text = good_scene;
    for (const std::string line :
         {"note = \"nothing\"\n", "inputs = \"shared\"\n", "size = [8, 4]\n", "up = [0, 1, 0]\n"})
        text = replace_text(text, line, "");
    const Scene s = load_text(text);
    CHECK(s.note.empty());
    CHECK(s.inputs == InputRounding::shared);
    CHECK(s.width == 256);
    CHECK(s.height == 256);
    CHECK(s.camera.up.y == 1);
    CHECK(s.camera.shift_right == 0);
    CHECK(s.camera.shift_up == 0);
    CHECK(s.camera.normalise);
}

TEST_CASE("numbers keep their exact decimal value in every notation") {
    const Scene s =
        load_text(replace_text(good_scene, "centre = [0, 0, -10]", "centre = [0.1, \"0.1\", \"0x1.8p+3\"]"));
    CHECK(s.listed[0].sphere().centre.x == real("0.1"));
    CHECK(s.listed[0].sphere().centre.x == s.listed[0].sphere().centre.y);
    CHECK(s.listed[0].sphere().centre.z == 12);
}

TEST_CASE("a file gives one scene per variant in order, or one scene without variants") {
    const std::vector<Scene> all = load_scenes(two_variants);
    REQUIRE(all.size() == 2);
    CHECK(all[0].id == "scene.small");
    CHECK(all[1].id == "scene.big");
    CHECK(all[0].listed[0].sphere().radius == Real(0.5));
    CHECK(all[0].camera.eye.x == 0);  // one variant does not affect the next
    CHECK(all[1].listed[0].sphere().radius == 2);
    CHECK(all[1].camera.eye.z == 3);
}

TEST_CASE("one variant can be chosen by name") {
    const std::vector<Scene> one = load_scenes(two_variants, variant("big"));
    REQUIRE(one.size() == 1);
    CHECK(one[0].id == "scene.big");
    CHECK(scene_error(two_variants, variant("bog")) == "scene.toml: no variant \"bog\"; did you mean \"big\"?");
    CHECK(scene_error(good_scene, variant("big")) == "scene.toml: no variant \"big\"; the file has none");
}

TEST_CASE("scenes are listed by name") {
    const Scratch data;
    CHECK(has(error_of([&] { list_scene_files(data.path()); }),
              (data / "scenes").string() + ": this folder does not exist"));
    CHECK(has(error_of([&] { list_scene_files(data.write("file", "")); }), ": this folder does not exist"));
    data.write("scenes/b.toml", good_scene);
    data.write("scenes/a.toml", good_scene);
    data.write("scenes/readme.md", "");
    const auto files = list_scene_files(data.path());
    REQUIRE(files.size() == 2);
    CHECK(files[0].filename() == "a.toml");
    CHECK(files[1].filename() == "b.toml");
}

TEST_CASE("a scene is found by path, id or id and variant") {
    const Scratch data;
    const fs::path near = data.write("scenes/near.toml", good_scene);
    const fs::path far = data.write("scenes/far-2.5.toml", two_variants);
    CHECK(find_scene("near", data.path()).path == near);
    CHECK_FALSE(find_scene("near", data.path()).variant);
    CHECK(find_scene("near.toml", data.path()).path == near);
    CHECK(find_scene(near.string(), data.path()).path == near);
    CHECK(find_scene("./elsewhere.toml", data.path()).path == "./elsewhere.toml");
    CHECK(find_scene("far-2.5", data.path()).path == far);
    CHECK_FALSE(find_scene("far-2.5", data.path()).variant);
    CHECK(find_scene("far-2.5.big", data.path()).path == far);
    CHECK(find_scene("far-2.5.big", data.path()).variant == "big");
    // A path that exists is left to its reader, which reports the fault, since no scene can have that name.
    fs::create_directory(data.path() / "folder.toml");
    const fs::path before = fs::current_path();
    fs::current_path(data.path());
    CHECK(find_scene("folder.toml", data.path()).path == "folder.toml");
    data.write("hello.txt", "");
    CHECK(error_of([&] { find_scene("hello.txt", data.path()); }) ==
          "hello.txt: is not a scene: a scene is a .toml file");
    fs::current_path(before);
    const std::string folder = (data.path() / "scenes").string();
    CHECK(error_of([&] { find_scene("neer", data.path()); }) ==
          "no scene \"neer\" in " + folder +
              "; did you mean \"near\"? (a path to a .toml file works too; `lostbits list scenes` lists all names)");
    CHECK(has(error_of([&] { find_scene("neer.big", data.path()); }), "did you mean \"near\"?"));
    CHECK(has(error_of([&] { find_scene("zzzzzz", data.path()); }), "known here: \"far-2.5\", \"near\""));
}

TEST_CASE("an override changes one number, vector, element or name") {
    CHECK(load_text(good_scene, set("sphere[0].radius=1e3")).listed[0].sphere().radius == 1000);
    CHECK(load_text(good_scene, set(" sphere[0].radius = 0x1.8p+1 ")).listed[0].sphere().radius == 3);
    CHECK(load_text(good_scene, set("sphere[0].radius=\"0.1\"")).listed[0].sphere().radius == real("0.1"));
    CHECK(load_text(good_scene, set("sphere[0].radius=0.1")).listed[0].sphere().radius == real("0.1"));
    CHECK(load_text(good_scene, set("sphere[0].centre=[1, 2, -30]")).listed[0].sphere().centre.z == -30);
    const Scene moved = load_text(good_scene, set("sphere[0].centre[2]=-30"));
    CHECK(moved.listed[0].sphere().centre.z == -30);
    CHECK(moved.listed[0].sphere().centre.x == 0);
    CHECK(load_text(good_scene, set("inputs=own")).inputs == InputRounding::own);
    CHECK(load_text(good_scene, set("title=plain words")).title == "plain words");
}

TEST_CASE("overrides apply in order, after the variant's, and the size last") {
    LoadOptions options = set("sphere[0].radius=2");
    options.overrides.push_back(parse_override("sphere[0].radius=3"));
    options.overrides.push_back(parse_override("size=[9, 9]"));
    options.size = {64, 32};
    const std::string text =
        good_scene + "[[variant]]\nname = \"v\"\nset = { \"sphere[0].radius\" = 7, \"camera.width\" = 5 }\n";
    const Scene result = load_text(text, options);
    CHECK(result.listed[0].sphere().radius == 3);
    CHECK(result.camera.width == 5);
    CHECK(result.width == 64);
    CHECK(result.height == 32);
}

TEST_CASE("one parsed file can be read under many overrides") {
    const Scratch folder;
    const SceneFile file(folder.write("scene.toml", good_scene));
    CHECK(file.load(set("sphere[0].radius=2")).at(0).listed[0].sphere().radius == 2);
    CHECK(file.load(set("camera.width=3")).at(0).listed[0].sphere().radius == 1);
}

TEST_CASE("an override of an unknown path lists the known ones") {
    CHECK(
        set_error("sphre[0].radius=2") ==
        R"(--set sphre[0].radius=2: unknown path "sphre[0].radius": the file has no "sphre"; did you mean "sphere"?)");
    CHECK(set_error("camra.eye=[1,1,1]") ==
          R"(--set camra.eye=[1,1,1]: unknown path "camra.eye": the file has no "camra"; did you mean "camera"?)");
    CHECK(set_error("sphere[0].raduis=2") ==
          R"(--set sphere[0].raduis=2: unknown key sphere[0].raduis; did you mean "radius"?)");
    CHECK(set_error("sphere[1].radius=2") ==
          R"(--set sphere[1].radius=2: unknown path "sphere[1].radius": sphere is an array of 1; )"
          R"(indices go from 0 to 0)");
    CHECK(
        set_error("sphere.radius=2") ==
        R"(--set sphere.radius=2: unknown path "sphere.radius": sphere is an array of 1; say which: sphere[0].radius)");
    CHECK(
        set_error("camera.eye.y=2") ==
        R"(--set camera.eye.y=2: unknown path "camera.eye.y": camera.eye is an array of 3; say which: camera.eye[1])");
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

TEST_CASE("a malformed override is refused with the right syntax") {
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

TEST_CASE("primitives of all shapes are numbered in the order of the file") {
    const std::string scene = replace_text(good_scene, good_scene.substr(good_scene.find("[[sphere]]")), "");
    const std::string text =
        scene + "[[box]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\n[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\n" +
        "[[triangle]]\na = [0, 0, 0]\nb = [1, 0, 0]\nc = [0, 1, 0]\n[[sphere]]\ncentre = [0, 0, 0]\nradius = 2\n" +
        "[[box]]\nlo = [0, 0, 0]\nhi = [2, 2, 2]\n";
    const auto shapes_of = [](const Scene& read) {
        std::vector<Shape> shapes;
        for (const auto& primitive : read.listed) shapes.push_back(primitive.shape);
        return shapes;
    };
    const std::vector written{Shape::box, Shape::sphere, Shape::triangle, Shape::sphere, Shape::box};
    const Scene s = load_text(text);
    CHECK(shapes_of(s) == written);
    CHECK(s.listed[1].sphere().radius == 1);
    CHECK(s.listed[3].sphere().radius == 2);
    // Paths count within a kind, and a changed number does not move its primitive.
    const Scene changed = load_text(text, set("sphere[1].radius=7"));
    CHECK(shapes_of(changed) == written);
    CHECK(changed.listed[3].sphere().radius == 7);
    // Primitives that are written again keep their index; those of a new kind come last.
    CHECK(shapes_of(load_text(text, set("sphere=[{centre=[0,0,0],radius=3}]"))) ==
          std::vector{Shape::box, Shape::sphere, Shape::triangle, Shape::box});
    CHECK(shapes_of(load_text(text, set("plane=[{through=[0,0,0],normal=[0,0,1]}]"))).back() == Shape::plane);
}

TEST_CASE("plain tables in a variant's set extend the path") {
    const std::string text =
        good_scene + "[[variant]]\nname = \"v\"\nset = { camera.width = 7, \"sphere[0]\".radius = 2 }\n";
    CHECK(load_text(text).camera.width == 7);
    CHECK(load_text(text).listed[0].sphere().radius == 2);
}

TEST_CASE("a variant's overrides apply in the order of writing") {
    const std::string wide_last =
        good_scene +
        "[[variant]]\nname = \"v\"\nset = { \"sphere[0].centre[0]\" = 9, \"sphere[0].centre\" = [1, 1, 1] }\n";
    CHECK(load_text(wide_last).listed[0].sphere().centre.x == 1);
    const std::string narrow_last =
        good_scene +
        "[[variant]]\nname = \"v\"\nset = { \"sphere[0].centre\" = [1, 1, 1], \"sphere[0].centre[0]\" = 9 }\n";
    CHECK(load_text(narrow_last).listed[0].sphere().centre.x == 9);
}

TEST_CASE("a range can be given to the rays of any scene") {
    CHECK(load_text(good_scene).range.is_whole());
    LoadOptions options;
    options.overrides.push_back(parse_override("rays.tmin=4.5"));
    const auto scene = load_text(good_scene, options);
    CHECK(scene.range.tmin == 4.5);
    CHECK(std::isinf(scene.range.tmax));
    options.overrides.push_back(parse_override("rays.tmim=4.5"));
    CHECK(has(error_of([&] { load_text(good_scene, options); }), "did you mean \"tmin\""));
}

}  // namespace test_scene_file
