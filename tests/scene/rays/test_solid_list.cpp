// Many spheres as columns are the spheres that stand in memory one by one.
#include "scene/rays/solid_list.hpp"

#include "catch.hpp"
#include "scene/rays/rays.hpp"
#include "scene/scene_text.hpp"

namespace test_solid_list {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::rays;
using namespace lostbits::scene::test;

namespace {

/// Two spheres and a flake of ninety-one.
file::Scene flake_scene(const std::string& inputs) {
    const Scratch folder;
    const std::string text = replaced(
        good_scene, "[[sphere]]",
        "[sphereflake]\nlevels = 2\nradius = 0.7\ncentre = [0.1, 0.2, 0.3]\n[[sphere]]\ncentre = [0.1, -7, 0]\n"
        "radius = 3.3\n[[sphere]]");
    file::Scene scene = file::load_scene(folder.write("scene.toml", text)).front();
    if (inputs == "own") scene.inputs = file::Inputs::own;
    return scene;
}

template <class T>
void check_columns(const SolidList<double>& list, std::size_t begin, std::size_t count) {
    std::array<std::vector<T>, 4> room;
    const auto columns = list.columns<T>(begin, count, room);
    for (std::size_t k = 0; k < 4; ++k) {
        REQUIRE(columns[k].size() == count);
        for (std::size_t i = 0; i < count; ++i) CHECK(columns[k][i] == static_cast<T>(list[begin + i].numbers[k]));
    }
}

}  // namespace

TEST_CASE("a list with a flake as columns holds the numbers of the solids one by one") {
    for (const char* inputs : {"shared", "own"}) {
        const file::Scene scene = flake_scene(inputs);
        const bool own = scene.inputs == file::Inputs::own;
        const auto ideal = scene.solids();
        const auto shared = shared_solids(scene);
        for (const char* name : {"f32", "f64", "fp16", "p20", "p30"}) {
            const FloatFormat f = find_format(name)->shape;
            INFO(inputs << " in " << name);
            const SolidList<double> list =
                own ? round_solids(ideal_solid_list(scene), f) : round_solids(shared_solid_list(scene), f);
            REQUIRE(list.size() == 93);
            REQUIRE(list.listed().size() == 2);
            CHECK(list.all().size() == 93);
            for (std::size_t i = 0; i < list.size(); ++i) {
                const Solid<double> one = own ? round_solid(ideal[i], f) : round_solid(shared[i], f);
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

TEST_CASE("the copies of a list share the flake, and its columns are read where they stand") {
    const SolidList<double> list = shared_solid_list(flake_scene("shared")), copy = round_solids(list, binary64);
    CHECK(copy.flake() == list.flake());
    std::array<std::vector<float>, 4> room;
    CHECK(copy.columns<float>(10, 64, room)[3].data() == list.flake()->stored<float>()->at(3).data() + 8);
    CHECK(room[0].empty());
    CHECK(list.flake()->stored<double>() == nullptr);
}

}  // namespace test_solid_list
