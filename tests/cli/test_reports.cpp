// The committed reports, and the output in the README and docs/sweep.md, are what the program writes now.
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "catch.hpp"
#include "counts.hpp"
#include "output/image/image.hpp"
#include "program.hpp"
#include "scene/check/claims_file.hpp"

namespace test_reports {

using namespace lostbits::test;

namespace {

/// Claims that only the long tests measure, 64 % of the time of all claims, and the claims that the short tests measure
/// in their place.
struct SlowClaim {
    const char *ids, *instead;
};
constexpr std::array slow_claims{
    SlowClaim{"attribution.far.pbrt-interval.*", "attribution.far.pbrt-factored.*"},
    SlowClaim{"attribution.far.kahan.*", "attribution.far.hearn-baker.*"},
    SlowClaim{"backward.[!hb]*", "backward.hearn_baker-*, backward.half_b-*"},
    SlowClaim{"backward.box-[!s]*", "backward.box-signs-*"},
    SlowClaim{"bound.gamma5-search", "bound.own-search"},
    SlowClaim{"bound.slabs-ize-search", "bound.slabs-ize, hierarchy.ize-harm"},
    SlowClaim{"derivative.near-unified", "derivative.near-schoolbook"},
    SlowClaim{"ellipsoid.*-search-*", "cylinder.distance-search-innocence"},
    SlowClaim{"mend.mesh-cracks", "mend.box-faces"},
    SlowClaim{"mend.cylinder-wrong", "mend.schoolbook-wrong"},
    SlowClaim{"offset.*-earth*", "offset.*-contact"},
    SlowClaim{"offset.*-world", "offset.*-near"},
    SlowClaim{"offset.*-far*", "offset.*-tiny"},
    SlowClaim{"prediction.statistical-interval", "prediction.statistical-near"},
    SlowClaim{"stability.*-grazing-backward", "stability.hearn_baker-4100-backward"},
    SlowClaim{"stability.[!h]*-4100-backward", "stability.hearn_baker-4100-backward"},
};

/// The ids of the claims about results; in the short tests without the slow ones.
std::set<std::string> measured_ids() {
    std::set<std::string> ids;
    std::set<const char*> used;
    using lostbits::scene::check::Claim;
    for (const auto& file : lostbits::scene::check::list_claim_files(LOSTBITS_DATA_DIR "/claims")) {
        for (const Claim& claim : lostbits::scene::check::read_claims(file)) {
            if (claim.profile != Claim::Profile::results) continue;
            const auto found = std::ranges::find_if(slow_claims, [&](const SlowClaim& slow_claim) {
                return ::fnmatch(slow_claim.ids, claim.id.c_str(), 0) == 0;
            });
            if (found != slow_claims.end()) used.insert(found->ids);
            if (found == slow_claims.end() || is_long()) ids.insert(claim.id);
        }
    }
    CHECK(used.size() == slow_claims.size());
    return ids;
}

/// The committed table, with the rows of these claims.
std::string committed_table(const std::set<std::string>& ids) {
    std::istringstream lines(contents(LOSTBITS_REPORTS_DIR "/claims.csv"));
    std::string table, line;
    std::getline(lines, table);
    table += "\n";
    while (std::getline(lines, line))
        if (is_long() || ids.contains(line.substr(0, line.find(',')))) table += line + "\n";
    return table;
}

/// The document without the output for several draws: their spread, and the option that made them.
std::string of_one_draw(const std::string& document) {
    static const std::regex spread(
        R"re( \((in each of|[-+.e0-9]+ to [-+.e0-9]+ over) [0-9]+ draws\)| --seeds [0-9]+)re");
    return std::regex_replace(document, spread, "");
}

/// One small subject of each kind: numbers, a scene, a march, sweeps, cases, a search, every float, two questions, next
/// rays, a picture.
constexpr std::string_view kinds[] = {"arithmetic",           "box-one",
                                      "sdf-by-hand.miss",     "sphere-impact",
                                      "hard/padding",         "padding, searched",
                                      "exhaustive-impact",    "box-far, consistency",
                                      "offset-tiny, offsets", "raycast-acne.ulp1, render"};

/// The sections of the document, each from its heading on.
std::set<std::string> sections(const std::string& document) {
    std::set<std::string> all;
    for (auto at = document.find("\n## "); at != std::string::npos;) {
        const auto next = document.find("\n## ", at + 1);
        std::string section = document.substr(at + 1, next == std::string::npos ? next : next - at - 1);
        section.erase(section.find_last_not_of('\n') + 1);
        all.insert(section);
        at = next;
    }
    return all;
}

/// ` --filter ID` of each claim in the sections of `kinds`.
std::string one_of_each_kind() {
    static const std::regex id(R"re(\| `([^`\n]+)` \|(\n|$))re");
    std::string filters;
    for (const std::string& section : sections(contents(LOSTBITS_REPORTS_DIR "/README.md"))) {
        if (std::ranges::find(kinds, section.substr(3, section.find('\n') - 3)) == std::end(kinds)) continue;
        for (std::sregex_iterator m(section.begin(), section.end(), id), end; m != end; ++m)
            filters += " --filter '" + (*m)[1].str() + "'";
    }
    return filters;
}

}  // namespace

TEST_CASE("every claim measures as stated, with the slow ones and more draws in long tests") {
    if (under_sanitizer) {  // which looks for faults: a further draw runs the code of the first
        must("check");
        return;
    }
    const Scratch scratch;
    const std::string json = (scratch / "claims.json").string(), csv = (scratch / "claims.csv").string();
    const auto ids = measured_ids();
    std::string words = "check --seeds 3";
    if (!is_long()) {
        words = "check --filter ";
        for (const std::string& id : ids) words += id + ",";
        words.pop_back();
    }
    must(words + " --export-csv '" + csv + "' --export-json '" + json + "'");
    int drawn = 0;
    const auto measured = nlohmann::json::parse(contents(json));
    CHECK(measured.size() == ids.size());
    for (const auto& claim : measured) {
        INFO(claim["id"]);
        // Every random claim has an interval that comes from many draws.
        const bool random = claim["samples"] > 0;
        CHECK(claim["further_draws"].size() == (random && is_long() ? 3 : 0));
        CHECK((random ? claim["interval_draws"] >= 32 : claim["interval_draws"] == 0));
        drawn += random;
    }
    CHECK(drawn > 50);
    // Compared by content: sentences, sources, numbers, worst rays.
    const std::string committed = scratch.write("committed.csv", committed_table(ids));
    must("diff '" + csv + "' '" + committed + "'" + (is_long() ? "" : " --ignore 'draw*'"));
}

// For its pictures the subjects are measured once more: the short tests have one subject of each kind.
TEST_CASE("the committed report is current: all of it in long tests, else one section of each kind") {
    draw_pictures();
    const Scratch scratch;
    const std::string made = (scratch / "reports").string();
    if (under_sanitizer) {  // which looks for faults, and takes ten times as long
        must("check --filter 'float.*' --report '" + made + "'");
        CHECK(has(contents(made + "/README.md"), "\n## "));
        return;
    }
    fs::create_directories(made);
    fs::copy(LOSTBITS_REPORTS_DIR "/screenshots", made + "/screenshots",
             fs::copy_options::recursive);  // whose names the document has
    must((is_long() ? "check --seeds 3" : "check" + one_of_each_kind()) + " --report '" + made + "'");
    const std::string document = contents(made + "/README.md"), committed = contents(LOSTBITS_REPORTS_DIR "/README.md");
    if (is_long()) CHECK(document == committed);
    const std::set<std::string> there = sections(of_one_draw(committed)), here = sections(of_one_draw(document));
    CHECK(here.size() == (is_long() ? there.size() : std::size(kinds)));
    for (const std::string& section : here) {
        INFO(section);
        CHECK(there.contains(section));
    }
    for (const auto& picture : fs::directory_iterator(made + "/pictures")) {
        const std::string name = picture.path().filename().string();
        must("diff --strict '" + picture.path().string() + "' '" LOSTBITS_REPORTS_DIR "/pictures/" + name + "'");
    }
    if (!is_long()) return;
    must("diff --strict '" + made + "/pictures' '" LOSTBITS_REPORTS_DIR "/pictures'");
}

TEST_CASE("the picture and the table of the README are current output") {
    draw_pictures();
    const Scratch scratch;
    must("map rtg-fig-7-3-4100-oblique" + into(scratch, ""));
    const auto made = scratch / "rtg-fig-7-3-4100-oblique";
    const fs::path kept = LOSTBITS_REPORTS_DIR "/readme";
    CHECK(contents(made / "summary.csv") == contents(kept / "summary.csv"));
    auto& backend = lostbits::output::image::image_backend();
    const auto now = backend.read_png(made / "contact.png"), then = backend.read_png(kept / "contact.png");
    CHECK(now.width == then.width);
    CHECK(now.height == then.height);
    // Pixels, not bytes: another zlib packs the same picture differently.
    CHECK((now.pixels == then.pixels));

    if (!is_long()) return;  // 8 s
    must("sweep sphere-distance -f f32" + into(scratch, ""));
    const auto plot = backend.read_png(scratch / "sphere-distance/lost_bits_p50.f32.png"),
               kept_plot = backend.read_png(kept / "lost_bits_p50.f32.png");
    CHECK((plot.pixels == kept_plot.pixels));
}

TEST_CASE("the scene in the tutorial can be mapped as printed") {
    const std::string page = contents(LOSTBITS_REPORTS_DIR "/../docs/first-hour.md");
    const auto begin = page.find("```toml\n") + 8;
    REQUIRE(begin != std::string::npos + 8);
    const Scratch scratch;
    const std::string file = scratch.write("mine.toml", page.substr(begin, page.find("```", begin) - begin));
    must("map '" + file + "' --size 24x24 -i sphere.press -f f32" + into(scratch, ""));
    CHECK(std::stod(read_csv(scratch / "mine/summary.csv").front().at("agree_hit")) > 100);
}

}  // namespace test_reports
