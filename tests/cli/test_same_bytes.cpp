// The output of a command does not depend on the number of threads or the register width, and is the same when the
// command is repeated.
#include <algorithm>
#include <set>

#include "catch.hpp"
#include "counts.hpp"
#include "every_float.hpp"
#include "intersect/simd/packed.hpp"
#include "program.hpp"

namespace test_same_bytes {

using namespace lostbits::test;
using namespace lostbits;

namespace {

struct Row {
    std::string words;
    std::size_t files = 0;     ///< at least so many are left in out/
    bool every_width = false;  ///< run at each width of the registers
    bool is_long = false;      ///< in the long tests only
};

const Row rows[] = {
    // More pixels than a band has, so that rows come in two instalments.
    {"map near-benign --size 150x230 -i sphere.press -i sphere.unit_half_b -f f32 -f p13 --metric '*' --bits 12 "
     "--pixels csv --exr --pictures all -o out",
     41, false, true},
    {"map near-benign --size 150x230 -i sphere.press -f f32 --metric lost_bits --pixels csv --exr --pictures all -o "
     "out",
     5},
    {"map near-benign --size 18x14 -i sphere.press -i sphere.unit_half_b -f f32 -f p13 --metric '*' --bits 12 "
     "--pixels csv --exr --pictures all -o out",
     41},
    {"map rtg-fig-7-3-4100-oblique box-slabs --size 23x21 -f f32 -f f64 --metric lost_bits --pixels csv -o out", 70,
     true},
    {"map rtg-fig-7-3-4100-oblique box-slabs --size 23x21 -f f32 -f f64 -i sphere.schoolbook "
     "-i sphere.unified_unit -i box.inclusive -i box.divide --metric '*bits' --metric '*error' --metric residual --exr "
     "--pixels csv --pictures all -o out",
     40, true},
    {"map rtg-fig-7-3-4100-oblique -i sphere.schoolbook -i sphere.unified -f f32 --size 48x32 --metric culprit "
     "--metric cancellation --metric contribution:c --pixels csv --pictures all -o out",
     11},
    {"map instance-far.sphere --size 21x17 -i 'sphere.unified@*' -f f32 --metric worst_step --metric step:origin "
     "--pixels csv -o out",
     15, true},
    {"map spheres-on-floor --size 32x16 -i sphere.two_step+box.signs -f f32 -f f64 -f p16 -o out", 4},
    {"map near-benign --size 18x14 -i sphere.press -f f32 --pictures all --figure png,svg,pdf -o out", 7},
    {"sweep distance.toml -i '*press*' -o out", 5},
    {"sweep distance.toml -i '*press*' --figure svg,pdf -o out", 7},
    {"sweep distance.toml --steps 5 --set views=2 -f f32 -f f64 -o out", 3, true},
    {"sweep distance.toml -i sphere.schoolbook -i sphere.unified -f f32 --metric culprit --metric cancellation "
     "--metric cancellation:c --metric contribution:c -o out",
     5},
    {"sweep march.toml -i 'sdf.*' -f f32 -o out", 6},
    {"sweep extremes/not-numbers extremes/scale -i sphere.schoolbook -i '*press*' -f f32 -f fp16 -f p5 -o out", 8},
    {"sweep worst/near --worst -f f32 -f f64 --set starts=40 --set generations=6 -o out", 2, true},
    {"sweep worst/mesh-edges --worst -i triangle.undivided -i triangle.woop -f f32 -f p16 --set rays=2048 -o out", 2,
     true},
    {"sweep every.toml -i sphere.press -i sphere.unified -o out", 5},
    {"render raycast-course.pixels --size 300x200 -i sphere.unified -i sphere.unit_half_b -f f32 -f p20 --pictures all "
     "-o out",
     10},
    {"render raycast-acne.ulp4 --size 60x40 -i sphere.unified -i sphere.unit_half_b -f f32 -f p20 --pictures all -o "
     "out",
     10},
    {"judge far-sphere.csv --answer-format f32 --sphere 0,0,0,1 --size 48x32 --rows -i 'sphere.p*' --metric residual "
     "--metric lost_bits --pictures all -o out",
     11},
    {"judge far-sphere.csv --answer-format f32 --sphere 0,0,0,1 -i 'sphere.p*' --by y --tolerance 0.001 --bits 12 -o "
     "out",
     3},
    {"consistency offset-touching --size 20x15 -i sphere.half_b,sphere.unified -f f32,f64,bf16 --pixels csv --pictures "
     "all -o out",
     8},
    {"consistency spheres-on-floor --size 8x4 -i sphere.two_step+box.signs -f f32 -o out", 4},
    {"offsets offset-touching --size 20x15 -f f32,f64 --pixels csv --pictures all -o out", 5},
    {"offsets spheres-on-floor --size 8x4 -o out", 4},
    {"mend rtg-fig-7-3-4100-oblique --size 24x21 -i sphere.half_b --bits 16 -o out --emit out/half.hpp", 5, true},
    // With every one of these claims it takes 11 s of processor time for each run.
    {"report near-benign sdf-union distance.toml --size 40x30 -i sphere.schoolbook -i sphere.unit_half_b -i "
     "sdf.sphere_trace -f f32 -f p16 --offsets offset-shells.outside --claims 'tilt.*,box.baseline-inside*' -o out",
     2},
    {"check --filter 'float.*' --report out", 1},
    {"explain rtg-fig-7-3-4100-oblique --pixel 100,90 -i sphere.schoolbook -f f32", 0},
};

/// Commands without a row, and the reason.
const std::map<std::string, std::string> others{
    {"choose", "measures time"},      {"completion", "measures nothing"}, {"devices", "measures the machine"},
    {"diff", "measures nothing"},     {"list", "measures nothing"},       {"manual", "measures nothing"},
    {"merge", "see test_shards.cpp"}, {"plugin", "see tests/external"},   {"trade", "measures time"},
};

/// Every file that a command leaves, by name, its output, and its exit status.
std::map<std::string, std::string> made_by(const std::string& words) {
    const Scratch scratch;
    const std::pair<const char*, std::string> files[] = {
        {"scene.toml", good_scene},
        {"distance.toml", small_sweep},
        {"march.toml", march_sweep},
        {"every.toml", every_float_to("0x1.6bp10")},
        {"far-sphere.csv", contents(fs::path(LOSTBITS_DATA_DIR) / "dumps/far-sphere.csv")}};
    for (const auto& [name, text] : files) scratch.write(name, text);
    const auto r = run(words, scratch.path());
    INFO(words << ": " << r.err);
    REQUIRE(r.code <= 1);
    std::map<std::string, std::string> made{{"what it prints", r.out}, {"exit status", std::to_string(r.code)}};
    for (const auto& name : scratch.files()) {
        if (name.starts_with("out/")) made[name] = contents(scratch.path() / name);
    }
    return made;
}

/// Numbers of threads, each with another width of registers: none and the widest, and those between of rows that are
/// run at every width, in the long tests of all rows.
std::vector<std::string> ways(const Row& row) {
    const auto isas = intersect::simd::available_isas();
    const auto way = [](int threads, intersect::simd::Isa isa) {
        return " -j " + std::to_string(threads) + " --isa " + std::string(name_of(isa));
    };
    std::vector<std::string> all{way(1, isas[0]), way(4, isas.back())};
    for (std::size_t i = 1; (row.every_width || is_long()) && i + 1 < isas.size(); ++i)
        all.push_back(way(i == 1 ? 2 : 7, isas[i]));
    return all;
}

std::string command_of(const Row& row) { return row.words.substr(0, row.words.find(' ')); }

/// The rows of which `chosen` is true of the command.
template <class Chosen>
void check_rows(Chosen chosen) {
    REQUIRE(intersect::simd::available_isas().size() >= 2);
    for (const Row& row : rows) {
        if (!chosen(command_of(row)) || (row.is_long && !is_long())) continue;
        std::map<std::string, std::string> first;
        for (const std::string& way : ways(row)) {
            const auto made = made_by(row.words + way);
            if (first.empty()) first = made;
            INFO(row.words << way);
            CHECK(made.size() == first.size());
            for (const auto& [name, bytes] : first) {
                INFO(name);
                REQUIRE(made.contains(name));
                const bool same = made.at(name) == bytes;
                CHECK(same);
            }
        }
        INFO(row.words);
        CHECK(first.size() >= row.files + 2);
        for (const auto& [name, bytes] : first) {
            INFO(name);
            CHECK_FALSE(bytes.empty());
        }
    }
}

}  // namespace

TEST_CASE("a map has the same bytes for any number of threads, at every register width and when repeated") {
    check_rows([](const std::string& command) { return command == "map"; });
}

TEST_CASE("a sweep has the same bytes for any number of threads, at every register width and when repeated") {
    check_rows([](const std::string& command) { return command == "sweep"; });
}

TEST_CASE("every other command writes the same bytes for any number of threads and at every register width") {
    check_rows([](const std::string& command) { return command != "map" && command != "sweep"; });
}

TEST_CASE("every command is tested at every register width or has a reason why not") {
    std::set<std::string> named;
    for (const Row& row : rows) named.insert(command_of(row));
    for (const auto& [name, why] : others) CHECK(named.insert(name).second);
    CHECK(named == commands());
}

TEST_CASE("an unknown register width is refused as bad input, and a missing one as a fault of the machine") {
    const auto unknown = run("list intersectors --isa 1024");
    CHECK(unknown.code == 2);
    CHECK(has(unknown.err, "--isa"));
    CHECK(has(unknown.err, "256"));
    const auto isas = intersect::simd::available_isas();
    for (const intersect::simd::Isa isa : {intersect::simd::Isa::scalar, intersect::simd::Isa::w128,
                                           intersect::simd::Isa::w256, intersect::simd::Isa::w512}) {
        const auto r = run("list intersectors --isa " + std::string(name_of(isa)));
        const bool available = std::ranges::find(isas, isa) != isas.end();
        CHECK(r.code == (available ? 0 : 3));
        CHECK((r.err.find("try one of scalar, 128") != std::string::npos) == !available);
    }
}

}  // namespace test_same_bytes
