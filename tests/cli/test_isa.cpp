// --isa: another speed, the same files.
#include <algorithm>

#include "catch.hpp"
#include "intersect/simd/packed.hpp"
#include "program.hpp"

namespace test_isa {

using namespace lostbits::test;
using namespace lostbits;

namespace {

/// Every file that `command` leaves under each available width has the bytes that `scalar` leaves.
void same_for_every_isa(const Scratch& scratch, const std::string& command, std::size_t least) {
    const auto isas = intersect::simd::available_isas();
    REQUIRE(isas.size() >= 2);
    for (const intersect::simd::Isa isa : isas) {
        const std::string name(name_of(isa));
        const auto r = run(command + " --isa " + name + " -o '" + (scratch.path() / name).string() + "'");
        INFO(name << ": " << r.err);
        REQUIRE(r.code == 0);
    }
    const auto files = scratch.files();
    std::size_t compared = 0;
    for (const std::string& file : files) {
        if (file.rfind("scalar/", 0) != 0) continue;
        const std::string rest = file.substr(7), bytes = contents(scratch.path() / file);
        for (const intersect::simd::Isa isa : isas) {
            INFO(rest << " at " << name_of(isa));
            CHECK(bytes == contents(scratch.path() / std::string(name_of(isa)) / rest));
        }
        ++compared;
    }
    CHECK(compared >= least);
    CHECK(compared * isas.size() == static_cast<std::size_t>(std::ranges::count_if(
                                        files, [](const std::string& f) { return f.find('/') != f.npos; })));
}

}  // namespace

TEST_CASE("map leaves the same bytes at every register width") {
    const Scratch scratch;
    same_for_every_isa(
        scratch,
        "-j 2 map rtg-fig-7-3-4100-oblique box-slabs --size 23x21 -f f32 -f f64 --metric lost_bits --pixels csv", 100);
}

TEST_CASE("sweep leaves the same bytes at every register width") {
    const Scratch scratch;
    const std::string file = scratch.write("s.toml", R"(schema = "lostbits-sweep/1"
title = "A test"
source = "-"

[family]
projection = "parallel"
views = 2
rays = 16

[[axis]]
name = "distance_radii"
spacing = "log2"
from = 2
to = 1048576
steps = 5
set = ["distance"]
)");
    same_for_every_isa(scratch, "sweep '" + file + "' -f f32 -f f64", 3);
}

TEST_CASE("every metric, the EXR and the worst rays are the same bytes at every register width") {
    const Scratch scratch;
    same_for_every_isa(
        scratch,
        "map near-benign rtg-fig-7-3-4100-oblique box-slabs --size 33x29 -f f32 -f f64 -f bf16 -i "
        "sphere.schoolbook -i sphere.unified_unit -i box.inclusive -i box.divide --metric '*bits' --metric "
        "'*error' --metric residual --exr --pixels csv",
        40);
    const Scratch searched;
    const std::string search = searched.write("w.toml", R"(schema = "lostbits-sweep/1"
title = "A test"
source = "-"
[search]
origin = [-8, 8]
direction = [-1, 1]
centre = [-1, 1]
radius = [0.5, 2]
seed = 1
starts = 40
generations = 6
)");
    same_for_every_isa(searched, "sweep '" + search + "' --worst -f f32 -f f64", 2);
}

TEST_CASE("an unknown register width is refused, one that the processor lacks is its fault") {
    const auto unknown = run("list intersectors --isa 1024");
    CHECK(unknown.code == 2);
    CHECK(unknown.err.find("--isa") != std::string::npos);
    CHECK(unknown.err.find("256") != std::string::npos);
    const auto isas = intersect::simd::available_isas();
    for (const intersect::simd::Isa isa : {intersect::simd::Isa::scalar, intersect::simd::Isa::w128,
                                           intersect::simd::Isa::w256, intersect::simd::Isa::w512}) {
        const auto r = run("list intersectors --isa " + std::string(name_of(isa)));
        INFO(r.err);
        const bool available = std::ranges::find(isas, isa) != isas.end();
        CHECK(r.code == (available ? 0 : 3));
        CHECK((r.err.find("try one of scalar, 128") != std::string::npos) == !available);
    }
}

}  // namespace test_isa
