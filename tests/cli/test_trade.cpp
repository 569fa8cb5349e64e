// `lostbits trade` from the outside. Times are not asserted.
#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "catch.hpp"
#include "program.hpp"

using namespace lostbits::test;

namespace {

double number(const std::string& cell) { return std::strtod(cell.c_str(), nullptr); }

const std::string same_family = R"(schema = "lostbits-sweep/1"
title = "The easy rays and those far away"
source = "-"

[family]
projection = "parallel"
impact_to = 0.9

[[axis]]
name = "distance_radii"
spacing = "log2"
from = 4
to = 4096
steps = 2
set = ["distance"]
)";

const char* const quick = "trade --quick --repetitions 2 ";

}  // namespace

TEST_CASE("trade times every kernel on every load and judges it on every set") {
    const Scratch scratch;
    const auto r = run(quick + std::string("-i sphere.schoolbook -i sphere.unified -i sphere.double_inside -o '") +
                       scratch.path().string() + "'");
    INFO(r.err);
    REQUIRE(r.code == 0);
    const auto folder = scratch.path() / "sphere";
    const auto times = read_csv(folder / "trade.csv"), standings = read_csv(folder / "pareto.csv");
    std::set<std::string> kernels, isas;
    for (const auto& row : times) {
        kernels.insert(row.at("form") + row.at("format") + row.at("isa"));
        isas.insert(row.at("isa"));
        CHECK(number(row.at("time_ns")) > 0);
        CHECK(number(row.at("time_ns_q1")) <= number(row.at("time_ns_q3")));
        CHECK(number(row.at("rays_per_second")) > 0);
        CHECK(number(row.at("working_set_bytes")) > number(row.at("working_set_rays")));
        CHECK(row.at("ops_sqrt") == "1");
    }
    CHECK(isas.contains("scalar"));
    CHECK(isas.contains("128"));
    CHECK(times.size() == kernels.size() * 9);
    CHECK(kernels.size() >= 5 * isas.size());
    CHECK(standings.size() == kernels.size() * 4);
    for (const char* set : {"easy", "far-small", "near-huge", "grazing"}) {
        CHECK(std::filesystem::exists(folder / (std::string(set) + ".png")));
        const auto of_set = [set](const auto& row) { return row.at("ray_set") == set; };
        CHECK(
            std::ranges::any_of(standings, [&](const auto& row) { return of_set(row) && row.at("dominated") == "0"; }));
        CHECK(r.out.find(std::string("\n") + set + ": ") != std::string::npos);
    }
    CHECK(r.out.find(
              "the cheapest form that keeps at least 20 bits (p99) on this set with no wrong decision is sphere.") !=
          std::string::npos);
    CHECK(r.out.starts_with(contents(folder / "trade.txt")));
    const auto package = nlohmann::json::parse(contents(folder / "datapackage.json"));
    CHECK(package["resources"].size() == 2);
    CHECK(package["resources"][0]["schema"]["fields"].size() == times.front().size());
    CHECK(package["resources"][1]["schema"]["fields"].size() == standings.front().size());
}

TEST_CASE("the accuracy of a trade is that of a sweep over the same rays") {
    const Scratch scratch;
    const std::string forms = " -i '*press*' -i sphere.unit_half_b -o '" + scratch.path().string() + "'";
    REQUIRE(run(quick + forms).code == 0);
    REQUIRE(run("sweep '" + scratch.write("s.toml", same_family) + "'" + forms).code == 0);
    const auto standings = read_csv(scratch.path() / "sphere/pareto.csv"),
               samples = read_csv(scratch.path() / "s/samples.csv");
    std::size_t compared = 0;
    for (const auto& row : standings) {
        const std::string distance = row.at("ray_set") == "easy" ? "4" : row.at("ray_set") == "far-small" ? "4096" : "";
        const auto sample = std::ranges::find_if(samples, [&](const auto& s) {
            return s.at("form") == row.at("form") && s.at("format") == row.at("format") &&
                   s.at("distance_radii") == distance;
        });
        if (distance.empty() || row.at("form").find('+') != std::string::npos) continue;
        REQUIRE(sample != samples.end());
        for (const char* column : {"rays", "lost_bits_p50", "lost_bits_p99", "excess_bits_p99", "false_hit_fraction",
                                   "false_miss_fraction"}) {
            INFO(row.at("form") << " " << column);
            CHECK(row.at(column) == sample->at(column));
        }
        ++compared;
    }
    CHECK(compared >= 2 * 2 * 2 * 2);  // forms, formats, distances, and at least two widths
}

TEST_CASE("boxes have a trade of their own") {
    const Scratch scratch;
    const auto r = run(quick + std::string("--shape box -f f32 -i box.signs -i box.pbrt_padded -q -o '") +
                       scratch.path().string() + "'");
    INFO(r.err);
    REQUIRE(r.code == 0);
    CHECK(r.out.empty());
    const auto standings = read_csv(scratch.path() / "box/pareto.csv");
    // A padded box has no false miss at its edges; what that costs is false hits.
    for (const auto& row : standings) {
        CHECK(row.at("format") == "f32");
        if (row.at("form") == "box.pbrt_padded" && row.at("ray_set") == "edge-grazing")
            CHECK(row.at("false_miss_fraction") == "0");
    }
    CHECK(std::filesystem::exists(scratch.path() / "box/edge-grazing.png"));
}

TEST_CASE("a trade that makes no sense is refused, and nothing is written") {
    struct Case {
        const char* options;
        int code;
        const char* says;
    };
    const Case cases[] = {{"-f bf16", 2, "only f32 and f64"},
                          {"-f f31", 2, "f32"},
                          {"--shape torus", 2, "torus"},
                          {"-i box.signs", 4, "sphere.*"},
                          {"--shape box -i 'sphere.*'", 4, "box.*"},
                          {"-i sphere.unifed", 2, "sphere.unified"},
                          {"--repetitions 0", 2, "repetitions"},
                          {"-f f64 -i sphere.double_inside", 4, "exists"}};
    for (const Case& c : cases) {
        const Scratch scratch;
        INFO(c.options);
        const auto r =
            run(std::string("trade --quick ") + c.options + " -o '" + (scratch.path() / "out").string() + "'");
        INFO(r.err);
        CHECK(r.code == c.code);
        CHECK(r.err.find(c.says) != std::string::npos);
        CHECK(scratch.files().empty());
    }
    CHECK(run("trade --quick -o ''").code == 2);
    CHECK(run("trade --quick").code == 2);
    CHECK(run("trade --quick -i sphere.press -o /dev/null/here").code == 3);
}
