// Tapes written as GLSL, with operations wider in double and in two floats, have on drivers the bits of the tapes.
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
#include "measure/answer/answers.hpp"
#include "measure/choice/candidates.hpp"
#include "measure/rows.hpp"
#include "measure/tape/tape_form.hpp"
#include "output/mend/shader_code.hpp"
#include "scene/file/scene.hpp"

namespace test_mended {

using namespace lostbits;
using namespace lostbits::test;
namespace tape = measure::tape;

namespace {

/// All of its bits.
std::string hex_of(float x) { return std::to_string(std::bit_cast<std::uint32_t>(x)); }

/// A tape that is to be compared with its text, and what the answers are.
struct Case {
    std::string name;
    std::vector<std::string> answers;
};

std::vector<std::string> answers_of(const Tape& made, const intersect::table::Intersector& form,
                                    const scene::file::Scene& scene) {
    const measure::tape::TapeForm row(form, *find_format("f32"), made, "tape", "");
    const measure::truth::Band band(scene, 0, scene.height);
    const auto inputs =
        band.inputs(*find_format("f32"), measure::choice::needs_of({.form = &form, .format = *find_format("f32")}));
    const auto found = measure::answer::evaluate(row.row(), inputs);
    std::vector<std::string> all;
    for (std::size_t i = 0; i < found.t.size(); ++i)
        all.push_back(found.hit[i] == 0 ? "" : hex_of(static_cast<float>(found.t[i])));
    return all;
}

/// Every operation wider, every second one, none.
std::vector<NodeId> some_of(const Tape& made, int every) {
    const auto all = tape::rounded_operations(made);
    std::vector<NodeId> some;
    for (std::size_t k = 0; every > 0 && k < all.size(); k += static_cast<std::size_t>(every)) some.push_back(all[k]);
    return some;
}

}  // namespace

TEST_CASE("shader bits: what GLSL has not is refused with what has it", "[shader-device]") {
    const auto& form = testing::form_named("sphere.kahan_discriminant");
    const Tape plain = tape::tape_of(form, *find_format("f32"));
    const auto code = [&](const Tape& made) {
        return output::mend::shader_code(made, form, {.name = "f", .title = "f", .source = {}, .comment = {}});
    };
    CHECK_THROWS_WITH(code(tape::widened(plain, some_of(plain, 1), binary64)), Catch::Contains("fma of doubles"));
    CHECK_THROWS_WITH(code(tape::tape_of(form, *find_format("f64"))), Catch::Contains("a shader computes in floats"));
}

}  // namespace test_mended
