// `lostbits map --bits` and `--envelope` from the outside.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "output/map/bits_needed_files.hpp"
#include "output/map/map_colour.hpp"
#include "pictures.hpp"
#include "program.hpp"

namespace test_map_needed {

using namespace lostbits::test;
using namespace lostbits::output;
using namespace lostbits::output::image;
using namespace lostbits::output::map;

namespace {

Rgb8 preview(const ExrImage& exr, std::size_t i) {
    const auto byte = [&](const char* c) {
        return srgb_byte(static_cast<std::uint16_t>(std::lround(samples<float>(exr, c)[i] * 65535.0F)));
    };
    return {byte("R"), byte("G"), byte("B")};
}

}  // namespace

TEST_CASE("picture, EXR, pixels and table of bits needed agree") {
    draw_pictures();
    const Scratch scratch;
    const auto r = must(
        "map rtg-fig-7-3-2000-oblique --size 48x40 -i sphere.schoolbook -i sphere.unit_half_b -f f32 --bits "
        "45 --pixels csv --exr -v" +
        into(scratch, ""));
    const auto folder = scratch / "rtg-fig-7-3-2000-oblique";
    CHECK(has(r.out, (folder / "needed.csv").string()));
    const auto table = read_csv(folder / "needed.csv");
    REQUIRE(table.size() == 2);
    double beyond_in_all = 0;
    for (const auto& row : table) {
        const std::string stem = row.at("form") + ".needed";
        INFO(stem);
        const auto pixels = read_csv(folder / (stem + ".csv"));
        const ExrImage exr = read_part(folder / "rtg-fig-7-3-2000-oblique.exr", stem);
        const PngImage png = backend().read_png(folder / (stem + ".png"));
        const ColourScale scale("viridis", backend().ramp("viridis", 256), 2, 53);
        REQUIRE(pixels.size() == 48 * 40);
        std::vector<double> all, hits;
        double hits_beyond = 0, misses_beyond = 0;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const double needed = number_in(pixels[i].at("needed"));
            const bool hit = pixels[i].at("truth") == "hit";
            CHECK(samples<float>(exr, "bits.needed")[i] == static_cast<float>(needed));
            CHECK(samples<std::uint32_t>(exr, "class.truth")[i] == (hit ? 1 : 0));
            CHECK((samples<std::uint32_t>(exr, "class.truth_object")[i] == 1) == hit);
            CHECK(preview(exr, i) == (std::isinf(needed) ? beyond_colour : scale.colour_of_value(needed)));
            if (std::isinf(needed)) {
                CHECK(pixels[i].at("needed") == "inf");
                ++(hit ? hits_beyond : misses_beyond);
                continue;
            }
            all.push_back(needed);
            if (hit) hits.push_back(needed);
        }
        beyond_in_all += hits_beyond;
        // 48 samples across are drawn eight pixels a side; the legend's swatch comes on top.
        CHECK((count_of(png, beyond_colour) > 64 * static_cast<std::size_t>(hits_beyond + misses_beyond)) ==
              (hits_beyond + misses_beyond > 0));
        CHECK(number_in(row.at("bits_asked")) == 45);
        CHECK(number_in(row.at("pixels")) == 48 * 40);
        CHECK(number_in(row.at("hits_beyond_53")) == hits_beyond);
        CHECK(number_in(row.at("misses_beyond_53")) == misses_beyond);
        CHECK(row.at("unresolved") == "0");
        for (const auto& [prefix, values] :
             {std::pair{std::string("needed_"), &all}, {std::string("hit_needed_"), &hits}}) {
            std::ranges::sort(*values);
            if (values->empty()) {
                CHECK(row.at(prefix + "max").empty());
                continue;
            }
            CHECK(number_in(row.at(prefix + "p50")) == (*values)[(values->size() - 1) / 2]);
            CHECK(number_in(row.at(prefix + "max")) == values->back());
        }
        CHECK(attribute(exr, "lostbits:command") ==
              "lostbits map rtg-fig-7-3-2000-oblique -i 'sphere.schoolbook' -i 'sphere.unit_half_b' -f f32 "
              "--bits 45 --exr --size 48x40");
        CHECK(attribute(exr, "lostbits:scene") == "rtg-fig-7-3-2000-oblique");
        CHECK(attribute(exr, "lostbits:form") == row.at("form"));
    }
    CHECK(beyond_in_all > 0);
    const auto package = nlohmann::json::parse(contents(folder / "datapackage.json"));
    std::vector<std::string> described;
    for (const auto& resource : package["resources"]) described.push_back(resource["path"]);
    for (const char* name : {"summary.csv", "needed.csv", "sphere.schoolbook.needed.csv"})
        CHECK(std::ranges::count(described, name) == 1);
}

TEST_CASE("bits needed: a map with them is the same as without") {
    draw_pictures();
    const Scratch scratch;
    // More pixels than a band has, so that rows come in two instalments.
    const std::string what = "map near-benign --size 150x230 -i sphere.schoolbook -f f32 --pixels csv --pictures all";
    const auto out = [&](const char* name) { return " -o '" + (scratch.path() / name).string() + "'"; };
    must(what + " --bits 12 --exr" + out("one"));
    must(what + out("plain"));
    std::size_t needed = 0, others = 0;
    for (const auto& name : scratch.files()) {
        if (name.rfind("one/", 0) != 0) continue;
        INFO(name);
        const std::string rest = name.substr(4), bytes = contents(scratch.path() / name);
        CHECK_FALSE(bytes.empty());
        if (rest.ends_with(".exr")) continue;
        if (rest.find("needed") != std::string::npos) {
            CHECK_FALSE(fs::exists(scratch / "plain" / rest));
            ++needed;
        } else if (!rest.ends_with(".json")) {
            // A picture says which command made it, and the commands differ.
            if (rest.ends_with(".png")) must("diff 'one/" + rest + "' 'plain/" + rest + "'", scratch.path());
            else CHECK(bytes == contents(scratch / "plain" / rest));
            ++others;
        }
    }
    CHECK(needed == 1 + 2);
    CHECK(others == 2 + 2);
}

TEST_CASE("bits needed: forms that exist in one format only are left out with a note") {
    const Scratch scratch;
    const std::string scene = "'" + scratch.write("scene.toml", good_scene) + "'";
    const std::string out = " --bits 12 --exr" + into(scratch);
    const auto both = must("map " + scene + " -i sphere.double_inside -i sphere.unified" + out);
    CHECK(has(both.err, "sphere.double_inside"));
    CHECK_FALSE(has(both.err, "sphere.unified"));
    const auto parts = backend().exr_parts(scratch / "out/scene/scene.exr");
    CHECK(std::ranges::count(parts, "sphere.unified.needed") == 1);
    CHECK(std::ranges::count(parts, "sphere.double_inside.needed") == 0);
    CHECK(std::ranges::count(parts, "sphere.double_inside.f32") == 1);
    CHECK_FALSE(fs::exists(scratch / "out/scene/sphere.double_inside.needed.png"));
    CHECK(run("map " + scene + " -q -i sphere.double_inside -i sphere.unified" + out).err.empty());
    for (const char* bits : {"1", "52"})  // the fewest and the most
        must("map " + scene + " -i sphere.unified -f f32 --bits " + bits + into(scratch));
}

TEST_CASE("the envelope makes lost bits paler exactly where the problem explains them") {
    draw_pictures();
    const Scratch scratch;
    const std::string what =
        "map grazing --size 96x96 -i sphere.schoolbook -f f32 -f f64 --metric lost_bits --metric excess_bits --exr "
        "--pictures all -o '";
    must(what + (scratch / "with").string() + "' --envelope");
    must(what + (scratch / "without").string() + "'");
    // Half of the bits of a format, by its square root.
    const ColourScale scale("viridis", backend().ramp("viridis", 256), 0, 24, Spacing::root);
    const Rgb8 swatch = make_paler(scale.colour_of_value(12));
    for (const char* format : {"f32", "f64"}) {
        INFO(format);
        const std::string stem = std::string("grazing/sphere.schoolbook.") + format;
        const std::string part = std::string("sphere.schoolbook.") + format;
        const ExrImage with = read_part(scratch / "with/grazing/grazing.exr", part),
                       without = read_part(scratch / "without/grazing/grazing.exr", part);
        std::size_t inside = 0, lossy_outside = 0;
        for (std::size_t i = 0; i < 96 * 96; ++i) {
            const float lost = samples<float>(with, "bits.lost")[i],
                        excess = samples<float>(with, "condition.excess")[i];
            const bool in = lost >= 1 && excess < 1;
            CHECK(preview(with, i) == (in ? make_paler(preview(without, i)) : preview(without, i)));
            inside += in;
            lossy_outside += lost >= 1 && !in;
        }
        CHECK(inside > 100);
        if (std::string(format) == "f32") CHECK(lossy_outside > 100);
        // The picture shows it, and says so; that of another metric stays as it was.
        const auto picture = [&](const char* folder, const char* metric) {
            return backend().read_png(scratch.path() / folder / (stem + "." + metric + ".png"));
        };
        CHECK(count_of(picture("with", "lost_bits"), swatch) >= 100);
        CHECK(count_of(picture("without", "lost_bits"), swatch) == 0);
        CHECK(picture("with", "excess_bits").pixels == picture("without", "excess_bits").pixels);
    }
    CHECK(count_of(backend().read_png(scratch / "with/grazing/contact.png"), swatch) >= 100);
    CHECK(contents(scratch / "with/grazing/summary.csv") == contents(scratch / "without/grazing/summary.csv"));
}

TEST_CASE("a long map with --bits reports how long it will take") {
    const Scratch scratch;
    // Interrupted as soon as it has said so.
    const auto r =
        run("map grazing --size 3000x3000 -i sphere.unified -f f32 --bits 20 -o out 2>said & child=$!; "
            "while ! grep -q 'bits will take about' said && kill -0 $child; do sleep 0.2; done; kill -TERM "
            "$child; wait $child; exit $?",
            scratch.path(), "set -m; ");
    CHECK(r.code == 130);
    CHECK(has(contents(scratch / "said"), "lostbits: grazing --bits will take about "));
}

}  // namespace test_map_needed
