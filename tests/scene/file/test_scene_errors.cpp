#include "catch.hpp"
#include "scene/scene_text.hpp"

namespace test_scene_errors {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::file;
using namespace lostbits::scene::test;

namespace {

/// The error when one line of the good scene is replaced.
std::string broken(const std::string& from, const std::string& to) {
    return scene_error(replace_text(good_scene, from, to));
}

std::string pinhole(const std::string& line) {
    return replace_text(replace_text(good_scene, "kind = \"orthographic\"", "kind = \"pinhole\""), "width = 2.5", line);
}

}  // namespace

TEST_CASE("the scene that the error cases start from is valid") { CHECK(scene_error(good_scene) == "no error"); }

TEST_CASE("a radius must be positive, also in binary32 when inputs are shared") {
    CHECK(broken("radius = 1", "radius = 0") ==
          "scene.toml:15:10: sphere[0].radius must be greater than 0; write a positive number");
    CHECK(broken("radius = 1", "radius = -1e-3") ==
          "scene.toml:15:10: sphere[0].radius must be greater than 0; write a positive number");
    CHECK(broken("radius = 1", "radius = 1e-46") ==
          "scene.toml:15:10: sphere[0].radius becomes 0 in binary32, to which inputs = \"shared\" rounds; write at "
          "least 1.5e-45, or inputs = \"own\"");
    CHECK(broken("radius = 1", "radius = 1e39") ==
          "scene.toml:15:10: sphere[0].radius overflows binary32, to which inputs = \"shared\" rounds; write at most "
          "3.4e38, or inputs = \"own\"");
    const std::string own = replace_text(good_scene, "\"shared\"", "\"own\"");
    CHECK(load_text(replace_text(own, "radius = 1", "radius = 1e-46")).listed[0].sphere().radius > 0);
    CHECK(load_text(replace_text(own, "radius = 1", "radius = 1e39")).listed[0].sphere().radius > 0);
}

TEST_CASE("every other number must be finite, in binary32 too when inputs are shared") {
    CHECK(broken("centre = [0, 0, -10]", "centre = [0, 0, -1e39]")
              .starts_with("scene.toml:14:10: sphere[0].centre overflows binary32"));
    CHECK(broken("eye = [0, 0, 0]", "eye = [0, 4e38, 0]").starts_with("scene.toml:9:7: camera.eye overflows binary32"));
    CHECK(broken("look_at = [0, 0, -1]", "look_at = [0, 0, -4e38]")
              .starts_with("scene.toml:10:11: camera.look_at overflows binary32"));
    CHECK(broken("up = [0, 1, 0]", "up = [0, 4e38, 0]").starts_with("scene.toml:11:6: camera.up overflows binary32"));
    CHECK(broken("width = 2.5", "width = 4e38").starts_with("scene.toml:12:9: camera.width overflows binary32"));
    CHECK(broken("width = 2.5", "width = 2.5\nshift = [0, 4e38]")
              .starts_with("scene.toml:13:9: camera.shift overflows binary32"));
}

TEST_CASE("a camera needs a view direction and an up vector that is not parallel to it") {
    CHECK(broken("look_at = [0, 0, -1]", "look_at = [0, 0, 0]") ==
          "scene.toml:10:11: camera.look_at equals camera.eye, which gives no direction; move one of them");
    CHECK(broken("up = [0, 1, 0]", "up = [0, 0, 7]") ==
          "scene.toml:11:6: camera.up is parallel to the direction of view, look_at - eye; write another, such as "
          "[0, 0, 1] or [0, 1, 0]");
    CHECK(has(broken("up = [0, 1, 0]", "up = [1e-13, 0, 1]"), "is parallel to the direction of view"));
    CHECK(broken("up = [0, 1, 0]", "up = [1e-11, 0, 1]") == "no error");
    CHECK(broken("up = [0, 1, 0]", "up = [0, 0, 0]") ==
          "scene.toml:11:6: camera.up is zero, which is not a direction; write [0, 1, 0]");
    CHECK(broken("up = [0, 1, 0]\n", "") == "no error");
}

TEST_CASE("the size of a camera's window must fit its projection") {
    CHECK(broken("width = 2.5", "width = 0") ==
          "scene.toml:12:9: camera.width must be greater than 0; write a positive number");
    CHECK(broken("width = 2.5", "width = 1e-46").starts_with("scene.toml:12:9: camera.width becomes 0 in binary32"));
    CHECK(broken("width = 2.5", "width = 2.5\nfov_deg = 40") ==
          "scene.toml:13:1: camera.fov_deg has no meaning for an orthographic camera; write width, in world units");
    CHECK(broken("width = 2.5", "width = 2.5\nnormalise = true")
              .starts_with("scene.toml:13:1: camera.normalise has no meaning for an orthographic camera"));
    CHECK(scene_error(pinhole("fov_deg = 40")) == "no error");
    for (const std::string fov : {"0", "180", "-10", "360"})
        CHECK(scene_error(pinhole("fov_deg = " + fov)) ==
              "scene.toml:12:11: camera.fov_deg must lie between 0 and 180 degrees, both excluded; try 40");
    CHECK(scene_error(pinhole("fov_deg = 40\nwidth = 2")) ==
          "scene.toml:13:1: camera.width has no meaning for a pinhole camera; write fov_deg, the vertical field of "
          "view in degrees");
}

TEST_CASE("the size of a picture must be within its limits") {
    CHECK(broken("size = [8, 4]", "size = [0, 4]") ==
          "scene.toml:6:9: size[0] is the integer 0, but a whole number from 1 to 65536 is expected here");
    CHECK(broken("size = [8, 4]", "size = [8, 65537]") ==
          "scene.toml:6:12: size[1] is the integer 65537, but a whole number from 1 to 65536 is expected here");
    CHECK(broken("size = [8, 4]", "size = [54161, 19825]") ==
          "scene.toml:6:8: size is too large: more than 2^30 pixels; make it smaller");
    CHECK(broken("size = [8, 4]", "size = [65536, 16384]") == "no error");
    LoadOptions options;
    options.size = {0, 5};
    CHECK(scene_error(good_scene, options) ==
          "--size 0x5: size[0] is the integer 0, but a whole number from 1 to 65536 is expected here");
}

TEST_CASE("a triangle must have an area") {
    const auto read = [](const char* c) {
        return broken("[[sphere]]\ncentre = [0, 0, -10]\nradius = 1\n",
                      std::string("[[triangle]]\na = [0.1, 0.2, 0.3]\nb = [0.2, 0.4, 0.6]\nc = ") + c + "\n");
    };
    CHECK(read("[0.5, 1, 1.4]") == "no error");
    CHECK(read("[1, 1, 1]") == "no error");
    CHECK(
        read("[0.1, 0.2, 0.3]") ==
        "scene.toml:16:5: triangle[0].c is on one line with a and b; a triangle has an area, so move one of the three");
    // 2^-30 beside 1 is lost in binary32, and the triangle becomes a line.
    const std::string thin = "[[triangle]]\na = [1, 1, 1]\nb = [2, 2, 2]\nc = [3, 3, \"0x1.8000001p1\"]\n";
    const std::string ball = "[[sphere]]\ncentre = [0, 0, -10]\nradius = 1\n";
    CHECK(broken(ball, thin) ==
          "scene.toml:16:5: triangle[0].c lies on one line with a and b in binary32, to which inputs = \"shared\" "
          "rounds, so that no ray meets the triangle; move it off the line, or write inputs = \"own\"");
    const Scratch folder;
    const auto own = folder.write("own.toml", replace_text(replace_text(good_scene, ball, thin), "shared", "own"));
    CHECK(error_of([&] { load_scene(own); }) == "no error");
    const std::string sphere = "[[sphere]]\ncentre = [0, 0, -10]\nradius = 1\n";
    const auto cylinder = [&](const std::string& top) {
        return broken(sphere, "[[cylinder]]\nbase = [1, 0, 0]\ntop = [" + top + ", 0, 0]\nradius = 1\n");
    };
    CHECK(cylinder("2") == "no error");
    CHECK(cylinder("1") ==
          "scene.toml:15:7: cylinder[0].top equals base; a cylinder has a height, so move one of the two");
    CHECK(cylinder("\"1.00000000001\"") ==
          "scene.toml:15:7: cylinder[0].top equals base in binary32, to which inputs = \"shared\" rounds; move one of "
          "the two, or write inputs = \"own\"");
    CHECK(broken(sphere, "[[ellipsoid]]\ncentre = [0, 0, 0]\nradii = [1, 1, \"1e-60\"]\n")
              .starts_with("scene.toml:15:9: ellipsoid[0].radii becomes 0 in binary32"));
    CHECK(broken(sphere, "[[ellipsoid]]\ncentre = [0, 0, 0]\nradii = [1, -1, 1]\n")
              .starts_with("scene.toml:15:9: ellipsoid[0].radii must be greater than 0"));
}

TEST_CASE("a scene needs a camera and a primitive, and unknown keys are refused") {
    CHECK(broken("schema = \"lostbits-scene/1\"", "").starts_with("scene.toml:1:1: schema is missing"));
    CHECK(broken("[camera]", "[camra]") ==
          "scene.toml:7:2: camera is missing, but there is camra; did you mean \"camera\"?");
    CHECK(broken("[[sphere]]", "[[spheres]]") == "scene.toml:13:3: unknown key spheres; did you mean \"sphere\"?");
    CHECK(broken("[[sphere]]\ncentre = [0, 0, -10]\nradius = 1\n", "") ==
          "scene.toml:1:1: the scene has no primitives; write at least one, such as [[sphere]] with centre and radius; "
          "the others are [[box]], [[triangle]], [[ellipsoid]], [[cylinder]], [[capsule]], [[tube]], [[cone]], "
          "[[disc]], [[plane]], [[torus]], [sphereflake] and [[mesh]] (data/README.md)");
    CHECK(broken("[[sphere]]", "[sphere]") ==
          "scene.toml:13:1: sphere is a table, but an array of tables, [[sphere]], is expected here");
    CHECK(broken("radius = 1", "radius = 1\nopacity = 3") ==
          "scene.toml:16:1: unknown key sphere[0].opacity; known here: \"colour\", \"ka\", \"kd\", \"ks\", \"n\", "
          "\"centre\", \"radius\", \"transform\"");
    CHECK(broken("radius = 1", "radius = 1\n" + std::string(99999, 'x') + " = 3") ==
          "scene.toml:16:1: unknown key sphere[0]." + std::string(100, 'x') +
              "... (99999 bytes); known here: \"colour\", \"ka\", \"kd\", \"ks\", \"n\", \"centre\", \"radius\", "
              "\"transform\"");
}

TEST_CASE("variants need unique names that are valid in file names") {
    const auto with = [](const std::string& text) { return scene_error(good_scene + text); };
    CHECK(with("[[variant]]\nname = \"a\"\nset = {}\n") == "no error");
    CHECK(has(with("[[varient]]\nname = \"a\"\nset = {}\n"), "unknown key varient; did you mean \"variant\"?"));
    CHECK(with("[[variant]]\nname = \"a\"\n") ==
          "scene.toml:16:1: variant[0].set is missing; give it a table of that name");
    CHECK(
        with("[[variant]]\nname = \"a/b\"\nset = {}\n") ==
        "scene.toml:17:8: variant[0].name is \"a/b\", but names are part of file names; use letters, digits, - and _");
    CHECK(with("[[variant]]\nname = \"\"\nset = {}\n")
              .starts_with("scene.toml:17:8: variant[0].name is \"\", but names"));
    CHECK(
        with("[[variant]]\nname = \"a\"\nset = {}\n[[variant]]\nname = \"a\"\nset = {}\n") ==
        "scene.toml:20:8: variant[1].name is \"a\", which is also the name of another variant; give each its own name");
    CHECK(with("[[variant]]\nname = \"a\"\nset = 3\n") ==
          "scene.toml:18:7: variant[0].set is the integer 3, but a table is expected here");
    CHECK(with("[[variant]]\nname = \"a\"\nset = {}\nsets = 1\n") ==
          "scene.toml:19:1: unknown key variant[0].sets; did you mean \"set\"?");
    CHECK(with("[variant]\nname = \"a\"\n") ==
          "scene.toml:16:1: variant is a table, but an array of tables, [[variant]], is expected here");
}

TEST_CASE("errors in a variant are reported at the line of the variant") {
    const auto with = [](const std::string& set) {
        return scene_error(good_scene + "[[variant]]\nname = \"a\"\nset = { " + set + " }\n");
    };
    CHECK(with("\"sphere[0].radius\" = -1") ==
          "scene.toml:18:30: sphere[0].radius must be greater than 0; write a positive number");
    CHECK(with("\"sphere[0].raduis\" = 1") ==
          "scene.toml:18:9: unknown key sphere[0].raduis; did you mean \"radius\"?");
    CHECK(with("\"sphere[3].radius\" = 1") ==
          "scene.toml:18:9: unknown path \"sphere[3].radius\": sphere is an array of 1; indices go from 0 to 0");
    CHECK(with("\"camrea.eye\" = 1") ==
          "scene.toml:18:9: unknown path \"camrea.eye\": the file has no \"camrea\"; did you mean \"camera\"?");
    CHECK(with("\"variant[0].name\" = 1")
              .starts_with(
                  "scene.toml:18:9: unknown path \"variant[0].name\": the file has no \"variant\"; known here:"));
}

TEST_CASE("near and far planes must be in front of the eye and in order, in binary32 too") {
    const auto planes = [](const std::string& text) {
        return scene_error(pinhole("fov_deg = 40\n[camera.projection]\n" + text));
    };
    CHECK(planes("near = 0.1\nfar = 1000\ndepth = \"reversed\"") == "no error");
    CHECK(planes("near = 0.1") == "no error");
    CHECK(planes("near = 0") ==
          "scene.toml:14:8: camera.projection.near must be greater than 0; write a positive number");
    CHECK(planes("near = -1").starts_with("scene.toml:14:8: camera.projection.near must be greater than 0"));
    CHECK(planes("near = 1e-46").starts_with("scene.toml:14:8: camera.projection.near becomes 0 in binary32"));
    for (const char* far : {"1", "0.5"})
        CHECK(planes(std::string("near = 1\nfar = ") + far) ==
              "scene.toml:15:7: camera.projection.far is not beyond near, which leaves nothing between; write a larger "
              "number, or leave it out for a plane at infinity");
    CHECK(
        planes("near = 1\nfar = 1.00000001") ==
        "scene.toml:15:7: camera.projection.far equals near in binary32, to which inputs = \"shared\" rounds, and the "
        "matrix is singular; write a larger number, or inputs = \"own\"");
    CHECK(planes("near = 1e30\nfar = \"0x1.00001p100\"") == "no error");
    CHECK(has(planes("near = 3.4e38\nfar = 3.40001e38"), "overflows binary32"));
    CHECK(scene_error(pinhole("fov_deg = 1e-37\n[camera.projection]\nnear = 1"))
              .starts_with("scene.toml:12:11: camera.fov_deg overflows binary32"));
}

TEST_CASE("a ray generator must exist, and needs a centred pinhole camera with planes") {
    const std::string planes = "\n[camera.projection]\nnear = 0.1";
    CHECK(scene_error(pinhole("fov_deg = 40\nrays = \"three\"" + planes)) == "no error");
    CHECK(scene_error(pinhole("fov_deg = 40\nrays = \"thre\"" + planes))
              .starts_with("scene.toml:13:8: camera.rays is \"thre\", which is not a known ray generator; did you mean "
                           "\"three\"?"));
    CHECK(scene_error(pinhole("fov_deg = 40\nrays = \"three\"")) ==
          "scene.toml:13:8: camera.rays needs the planes of a projection; write [camera.projection] with near, and far "
          "unless it is at infinity");
    CHECK(scene_error(pinhole("fov_deg = 40\nnormalise = false\nrays = \"three\"" + planes))
              .starts_with("scene.toml:13:13: camera.normalise is false"));
    CHECK(scene_error(pinhole("fov_deg = 40\nshift = [0.5, 0]" + planes))
              .starts_with("scene.toml:13:9: camera.shift moves the picture to one side"));
    for (const std::string& key : {std::string("rays = \"three\""), planes.substr(1)})
        CHECK(has(broken("width = 2.5", "width = 2.5\n" + key), "belongs to kind = \"pinhole\""));
}

}  // namespace test_scene_errors
