// `lostbits trade` from the outside. Times are not asserted.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "catch.hpp"
#include "program.hpp"

namespace test_trade {

using namespace lostbits::test;

namespace {

const char* const quick = "trade --quick --repetitions 2 ";

}  // namespace

TEST_CASE("trade times every kernel on every load and measures its accuracy on every set") {
    const Scratch scratch;
    const auto r = must(quick + std::string("-i sphere.schoolbook -i sphere.unified -i sphere.double_inside -o '") +
                        scratch.path().string() + "'");
    const auto folder = scratch / "sphere";
    const auto times = read_csv(folder / "trade.csv"), standings = read_csv(folder / "pareto.csv");
    std::set<std::string> kernels, isas;
    for (const auto& row : times) {
        kernels.insert(row.at("form") + row.at("format") + row.at("isa"));
        isas.insert(row.at("isa"));
        CHECK(number_in(row.at("time_ns")) > 0);
        CHECK(number_in(row.at("time_ns_q1")) <= number_in(row.at("time_ns_q3")));
        CHECK(number_in(row.at("rays_per_second")) > 0);
        CHECK(number_in(row.at("working_set_bytes")) > number_in(row.at("working_set_rays")));
        CHECK(row.at("ops_sqrt") == "1");
    }
    CHECK(isas.contains("scalar"));
    CHECK(isas.contains("128"));
    CHECK(times.size() == kernels.size() * 9);
    CHECK(kernels.size() >= 5 * isas.size());
    CHECK(standings.size() == kernels.size() * 4);
    for (const char* set : {"easy", "far-small", "near-huge", "grazing"}) {
        CHECK(fs::exists(folder / (std::string(set) + ".png")));
        const auto of_set = [set](const auto& row) { return row.at("ray_set") == set; };
        CHECK(
            std::ranges::any_of(standings, [&](const auto& row) { return of_set(row) && row.at("dominated") == "0"; }));
        CHECK(has("\n" + r.out, std::string("\n") + set + ": "));
    }
    // The table has each form and format once for each set, the fastest first. How it was measured comes after it.
    CHECK(r.out.find("Time per ray: half of the timed rays hit") > r.out.find("\ngrazing: "));
    CHECK(r.out.starts_with("easy: a sphere 4 radii away, hit within 0.9 radii of its middle, 1024 rays\n    form "));
    CHECK(has(r.out, "\n  cheapest form that is never wrong on this set and keeps at least\n    8"));
    CHECK(has(r.out, " bits (p99): sphere."));
    CHECK(r.out.starts_with(contents(folder / "trade.txt")));
    const auto package = nlohmann::json::parse(contents(folder / "datapackage.json"));
    CHECK(package["resources"].size() == 2);
    CHECK(package["resources"][0]["schema"]["fields"].size() == times.front().size());
    CHECK(package["resources"][1]["schema"]["fields"].size() == standings.front().size());
}

TEST_CASE("trade has a table of its own for boxes") {
    const Scratch scratch;
    const auto r = must(quick + std::string("--shape box -f f32 -i box.signs -i box.pbrt_padded -q -o '") +
                        scratch.path().string() + "'");
    CHECK(r.out.empty());
    const auto standings = read_csv(scratch / "box/pareto.csv");
    // A padded box has no false miss at its edges; the price is false hits.
    std::size_t padded = 0;
    for (const auto& row : standings) {
        CHECK(row.at("format") == "f32");
        if (row.at("form") != "box.pbrt_padded" || row.at("ray_set") != "edge-grazing") continue;
        ++padded;
        CHECK(row.at("false_miss_fraction") == "0");
    }
    CHECK(padded > 0);
    CHECK(fs::exists(scratch / "box/edge-grazing.png"));
}

TEST_CASE("trade on a scene times the scene's rays and has the accuracy of its map") {
    const Scratch scratch, maps;
    const std::string what = "near-benign --size 40x30 -i sphere.schoolbook -i sphere.filtered ";
    const auto r = must(quick + std::string("--scene ") + what + "-o '" + scratch.path().string() + "'");
    must("map " + what + "-f f32 -f f64" + into(maps, ""));
    const auto times = read_csv(scratch / "near-benign/trade.csv"),
               standings = read_csv(scratch / "near-benign/pareto.csv"),
               summary = read_csv(maps / "near-benign/summary.csv");
    CHECK(times.size() == standings.size());
    for (const auto& row : times) {
        CHECK(row.at("working_set") == "scene");
        CHECK(row.at("working_set_rays") == "1200");
        CHECK(number_in(row.at("hit_rate")) > 0);
        CHECK(number_in(row.at("hit_rate")) < 1);
        CHECK(number_in(row.at("time_ns")) > 0);
    }
    std::set<std::string> isas, compared;
    for (const auto& row : standings) {
        CHECK(row.at("ray_set") == "near-benign");
        const auto same = std::ranges::find_if(summary, [&row](const auto& s) {
            return s.at("form") == row.at("form") && s.at("format") == row.at("format");
        });
        if (same == summary.end()) continue;  // compiled with other flags: a map does not know it
        isas.insert(row.at("isa"));
        compared.insert(row.at("form") + row.at("format"));
        for (const char* column :
             {"rays", "lost_bits_p50", "lost_bits_p99", "false_hit_fraction", "false_miss_fraction"})
            CHECK(row.at(column) == same->at(column));
        const double wrong = number_in(same->at("false_hit")) + number_in(same->at("false_miss")) +
                             number_in(same->at("not_a_number")) + number_in(same->at("wrong_primitive"));
        CHECK(number_in(row.at("wrong_fraction")) == wrong / 1200);
    }
    CHECK(compared.size() == 4);
    CHECK(isas.size() >= 2);
    CHECK(fs::exists(scratch / "near-benign/near-benign.png"));
    CHECK(has(r.out, "1200 rays of the scene against"));
    CHECK(r.out.starts_with("near-benign: "));
}

}  // namespace test_trade
