// Tapes written as GLSL, with wider operations in double and in pairs of floats, have the bits of the tapes on drivers.
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"
#include "counts.hpp"
#include "measure/answer/answers.hpp"
#include "measure/choose/candidates.hpp"
#include "measure/rows.hpp"
#include "measure/tape/tape_form.hpp"
#include "output/repair/form_code.hpp"
#include "scene/file/scene.hpp"

namespace test_mended {

using namespace lostbits;
using namespace lostbits::test;
namespace tape = measure::tape;

namespace {

/// All of its bits.
std::string hex_of(float x) { return std::to_string(std::bit_cast<std::uint32_t>(x)); }

/// A tape that is to be compared with its text, and the expected answers.
struct Case {
    std::string name;
    std::vector<std::string> answers;
};

std::vector<std::string> answers_of(const Tape& made, const intersect::table::Intersector& form,
                                    const scene::file::Scene& scene) {
    const measure::tape::TapeForm row(form, *find_format("f32"), made, "tape", "");
    const measure::truth::Band band(scene, 0, scene.height);
    const auto inputs = band.inputs_for(*find_format("f32"), *form.info);
    const auto found = measure::answer::evaluate(row.form(), inputs);
    std::vector<std::string> all;
    for (std::size_t i = 0; i < found.t.size(); ++i)
        all.push_back(found.hit[i] == 0 ? "" : hex_of(static_cast<float>(found.t[i])));
    return all;
}

/// Every operation wider, every second one, or none.
std::vector<NodeId> sample_rays(const Tape& made, int every) {
    const auto all = tape::find_widenable_operations(made);
    std::vector<NodeId> some;
    for (std::size_t k = 0; every > 0 && k < all.size(); k += static_cast<std::size_t>(every)) some.push_back(all[k]);
    return some;
}

}  // namespace

TEST_CASE("shader bits: a mended form on the driver has the bits of its tape", "[shader-device]") {
    for (const auto& [name, scene_name, forms] :
         {std::tuple("sphere", "rtg-fig-7-3-4100-oblique",
                     std::vector{"sphere.half_b", "sphere.unit_half_b", "sphere.kahan_discriminant"}),
          std::tuple("box", "box-slabs", std::vector{"box.baseline"}),
          std::tuple("triangle", "triangle-far", std::vector{"triangle.undivided"})}) {
        const auto scene = test::load(scene_name, 40, 30);
        const Scratch folder;
        std::vector<Case> cases;
        std::string words;
        for (const char* const form_name : forms) {
            if (!is_long() && std::string(form_name) != "sphere.half_b") continue;  // all of them take half a minute
            const auto& form = test::form_named(form_name);
            const Tape plain = tape::record_tape(form, *find_format("f32"));
            for (const auto& [arithmetic, wider] :
                 {std::pair("plain", binary32), std::pair("double", binary64), std::pair("pair", tape::two_floats)}) {
                for (const int every : {1, 2}) {
                    if (wider == binary32 && every == 2) continue;
                    const bool fma = std::string(form_name) == "sphere.kahan_discriminant";
                    const bool is_half_b = std::string(form_name) == "sphere.half_b";
                    // A driver compiles functions within functions, and takes seconds for a form of nothing else.
                    if (wider == tape::two_floats && every == 1 && !is_half_b) continue;
                    if (fma && wider == binary64) continue;  // GLSL's own fma of doubles rounds as drivers like
                    const Tape made = tape::widen_operations(
                        plain, wider == binary32 ? sample_rays(plain, 0) : sample_rays(plain, every),
                        wider == binary32 ? binary64 : wider);
                    std::string id = std::string(form_name).substr(std::string(form_name).find('.') + 1);
                    id += std::string("_") + arithmetic + std::to_string(every);
                    const std::string file = folder.write(
                        id + ".glsl", output::repair::shader_code(
                                          made, form, {.name = id, .title = id, .source = {}, .head_lines = {}}));
                    words += " --shader " + file;
                    cases.push_back({id, answers_of(made, form, scene)});
                }
            }
        }
        if (cases.empty()) continue;
        must(std::string("map ") + scene_name + " --size 40x30 --pixels csv -o out --device all -i 'shader.*' -f f32" +
                 words,
             folder.path());
        int hits = 0, compared = 0;
        for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "out" / scene_name)) {
            const std::string file = entry.path().filename().string();
            for (const Case& one : cases) {
                if (!file.starts_with("shader." + one.name + ".") || !file.ends_with(".f32.csv")) continue;
                INFO(file);
                std::vector<std::string> theirs;
                for (const auto& pixel : read_csv(entry.path())) {
                    const std::string& t = pixel.at("t_hex");
                    theirs.push_back(t.empty() ? "" : hex_of(std::strtof(t.c_str(), nullptr)));
                    hits += t.empty() ? 0 : 1;
                }
                CHECK(theirs == one.answers);
                ++compared;
            }
        }
        INFO(name);
        CHECK(hits > 100);
        CHECK(compared >= static_cast<int>(cases.size()));
    }
}

TEST_CASE("shader bits: a function that GLSL lacks is refused with a replacement", "[shader-device]") {
    const auto& form = test::form_named("sphere.kahan_discriminant");
    const Tape plain = tape::record_tape(form, *find_format("f32"));
    const auto code = [&](const Tape& made) {
        return output::repair::shader_code(made, form, {.name = "f", .title = "f", .source = {}, .head_lines = {}});
    };
    CHECK_THROWS_WITH(code(tape::widen_operations(plain, sample_rays(plain, 1), binary64)),
                      Catch::Contains("fma of doubles"));
    CHECK_THROWS_WITH(code(tape::record_tape(form, *find_format("f64"))),
                      Catch::Contains("a shader computes in floats"));
}

}  // namespace test_mended
