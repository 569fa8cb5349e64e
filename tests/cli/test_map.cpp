// `lostbits map` from the outside: files, and agreement between them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <set>
#include <span>

#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/metric/metrics.hpp"
#include "pictures.hpp"
#include "program.hpp"

namespace test_map {

using namespace lostbits::test;
using lostbits::output::image::ExrImage;

namespace {

/// The outcomes that the summary of a scene without a mesh has.
const auto without_mesh =
    std::span(lostbits::measure::answer::outcome_names).first(lostbits::measure::answer::outcome_count_without_mesh);

/// A double from its two words.
double exact(const ExrImage& exr, const std::string& number, std::size_t i) {
    return std::bit_cast<double>(std::uint64_t{samples<std::uint32_t>(exr, number + ".word1")[i]} << 32 |
                                 samples<std::uint32_t>(exr, number + ".word0")[i]);
}

}  // namespace

TEST_CASE("map writes every file of every form and format") {
    const Scratch scratch;
    const std::string scene = scratch.write("scene.toml", good_scene);
    const auto r = must("map '" + scene + "' -i 'sphere.*' -f f32 -f f64 -f bf16 --pictures all" + into(scratch, ""));
    CHECK(r.out.starts_with("scene: 384 rays\n  form "));
    CHECK(r.out.ends_with("\n" + (scratch / "scene/contact.png").string() + "\n"));
    std::size_t rows = 0;
    for (const auto& form : lostbits::intersect::table::intersectors(lostbits::Shape::sphere)) {
        for (const char* format : {"f32", "f64", "bf16"}) {
            const std::string stem = std::string(form.info->name) + "." + format;
            const bool expected = form.exists_in(*lostbits::find_format(format));
            rows += expected;
            CHECK(fs::exists(scratch / "scene" / (stem + ".png")) == expected);
        }
    }
    const auto summary = read_csv(scratch / "scene/summary.csv");
    CHECK(summary.size() == rows);
    for (const auto& row : summary) {
        CHECK(row.at("rays") == "384");
        double sum = 0;
        for (const auto name : without_mesh) sum += number_in(row.at(std::string(name)));
        CHECK(sum == 384);
        CHECK(row.at("unresolved") == "0");
    }
    // scene.toml, a picture a row, contact sheet, summary, data package, manifest: and nothing else, hidden or not.
    CHECK(scratch.files().size() == 1 + rows + 4);
    const auto package = nlohmann::json::parse(contents(scratch / "scene/datapackage.json"));
    CHECK(package["resources"][0]["schema"]["fields"].size() == summary.front().size());
    const auto both = must("map near-benign --size 6x4 -i sphere.press -f f32 --figure png,svg" + into(scratch, ""));
    const std::string sheet = (scratch / "near-benign/contact.").string();
    CHECK(both.out.ends_with("\n" + sheet + "png\n" + sheet + "svg\n"));
}

TEST_CASE("the EXR of a scene has one part per row and its truth once, however it is requested") {
    const Scratch scratch;
    const std::string what =
        "map near-benign --size 32x24 -i sphere.schoolbook -i sphere.unit_half_b -i "
        "sphere.schoolbook_strict -f f32 -f f64 --exr" +
        into(scratch, "");
    must(what);
    const auto file = scratch / "near-benign/near-benign.exr";
    std::vector<std::string> expected;
    for (const auto& row : read_csv(scratch / "near-benign/summary.csv"))
        expected.push_back(row.at("form") + "." + row.at("format"));
    const std::size_t rows = expected.size();
    REQUIRE(rows == 6);
    const auto names = backend().exr_parts(file);
    REQUIRE(names.size() > rows);
    CHECK(std::equal(expected.begin(), expected.end(), names.begin()));
    std::set<std::string> truths;
    for (const auto& name : expected) truths.insert(attribute(read_part(file, name), "lostbits:truth"));
    CHECK(truths == std::set<std::string>{"truth", "truth.distance", "truth.open"});
    CHECK((truths == std::set<std::string>(names.begin() + static_cast<std::ptrdiff_t>(rows), names.end())));
    const auto channels = [&](const std::string& name) {
        std::string all;
        for (const auto& channel : read_part(file, name).channels) all += channel.name + " ";
        return all;
    };
    CHECK(channels("sphere.schoolbook.f32") == "B G R bits.lost class.object class.outcome t.hi ");
    CHECK(channels("sphere.schoolbook.f64") == "B G R bits.lost class.object class.outcome t.hi t.lo t.word0 t.word1 ");
    CHECK(channels("truth") == "class.truth class.truth_object truth.hi truth.lo truth.word0 truth.word1 ");
    CHECK(
        attribute(read_part(file, "truth"), "lostbits:command") ==
        "lostbits map near-benign -i 'sphere.schoolbook' -i 'sphere.unit_half_b' -i 'sphere.schoolbook_strict' -f f32 "
        "-f f64 --exr --size 32x24");
    CHECK(has(attribute(read_part(file, "truth"), "lostbits:objects"), "1 is primitive 0"));
    CHECK(scratch.files().size() == 5);  // no picture but the sheet, unless it is asked for
}

TEST_CASE("EXR, pixel CSV and summary agree") {
    const Scratch scratch;
    must(
        "map rtg-fig-7-3-2000-oblique --size 48x48 -i sphere.schoolbook -i sphere.unit_half_b -f f64 -f f32 --metric "
        "'*' --pixels csv --exr" +
        into(scratch, ""));
    const auto folder = scratch / "rtg-fig-7-3-2000-oblique";
    for (const auto& summary : read_csv(folder / "summary.csv")) {
        const std::string stem = summary.at("form") + "." + summary.at("format");
        INFO(stem);
        const auto pixels = read_csv(folder / (stem + ".csv"));
        const auto file = folder / "rtg-fig-7-3-2000-oblique.exr";
        const ExrImage exr = read_part(file, stem), true_exr = read_part(file, attribute(exr, "lostbits:truth"));
        const bool in_float = summary.at("format") == "f32";
        REQUIRE(pixels.size() == 48 * 48);
        std::map<std::string, std::size_t> counts;
        std::vector<double> ulps;
        std::size_t layers = 0;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const auto& pixel = pixels[i];
            ++counts[pixel.at("outcome")];
            CHECK(lostbits::measure::answer::outcome_names[samples<std::uint32_t>(exr, "class.outcome")[i]] ==
                  pixel.at("outcome"));
            const double t = in_float ? samples<float>(exr, "t.hi")[i] : exact(exr, "t", i);
            if (!in_float && std::isfinite(t)) {  // for viewers: 48 bits of it
                const double near = double{samples<float>(exr, "t.hi")[i]} + double{samples<float>(exr, "t.lo")[i]};
                CHECK(near == Approx(t).epsilon(0x1p-47).margin(0));
            }
            CHECK(samples<std::uint32_t>(exr, "class.object")[i] ==
                  (pixel.at("object").empty() ? 0 : std::stoul(pixel.at("object")) + 1));
            CHECK((pixel.at("t_hex").empty() ? std::isnan(t) : t == number_in(pixel.at("t_hex"))));
            CHECK((pixel.at("t").empty() || number_in(pixel.at("t")) == t));
            const double truth = exact(true_exr, "truth", i);
            CHECK(samples<std::uint32_t>(true_exr, "class.truth")[i] == (pixel.at("truth_hex").empty() ? 0 : 1));
            CHECK((samples<std::uint32_t>(true_exr, "class.truth_object")[i] > 0) == !pixel.at("truth_hex").empty());
            CHECK((pixel.at("truth_hex").empty() ? std::isnan(truth) : truth == number_in(pixel.at("truth_hex"))));
            const std::string cell = pixel.at("ulp_error");
            for (const auto& metric : lostbits::measure::metric::metrics()) {
                const auto* channel = exr.find(metric.layer);
                if (channel == nullptr || pixel.count(std::string(metric.name)) == 0) continue;
                if (metric.depends_on_forms) continue;  // the table has a word for it
                const float layer = std::get<std::vector<float>>(channel->samples)[i];
                const std::string& of_metric = pixel.at(std::string(metric.name));
                ++layers;
                if (!metric.categories.empty() && !of_metric.empty()) {  // the layer has its place in the list
                    CHECK(metric.categories[static_cast<std::size_t>(layer)] == of_metric);
                    continue;
                }
                CHECK((of_metric.empty() ? std::isnan(layer) : layer == static_cast<float>(number_in(of_metric))));
            }
            if (pixel.at("outcome") != "agree_hit") continue;
            ulps.push_back(std::fabs(number_in(cell)));
            // The three-way split is a split: its parts sum to the whole, to the rounding of the sum.
            const double parts = number_in(pixel.at("input_error")) + number_in(pixel.at("model_error")) +
                                 number_in(pixel.at("rounding_error"));
            CHECK(parts == Approx(number_in(cell)).margin(1e-6).epsilon(1e-9));
            CHECK(number_in(pixel.at("lost_bits")) + number_in(pixel.at("correct_bits")) ==
                  Approx(summary.at("format") == "f32" ? 24 : 53));
        }
        for (const auto name : without_mesh)
            CHECK(number_in(summary.at(std::string(name))) == static_cast<double>(counts[std::string(name)]));
        CHECK(layers >= 12 * pixels.size());
        std::ranges::sort(ulps);
        REQUIRE_FALSE(ulps.empty());
        CHECK(number_in(summary.at("ulp_error_max")) == ulps.back());
        CHECK(number_in(summary.at("ulp_error_p50")) == Approx(ulps[(ulps.size() - 1) / 2]).epsilon(0x1p-10));
        const auto worst =
            static_cast<std::size_t>(number_in(summary.at("worst_y")) * 48 + number_in(summary.at("worst_x")));
        CHECK(std::fabs(number_in(pixels[worst].at("ulp_error"))) == ulps.back());
        CHECK(summary.at("worst_t_hex") == pixels[worst].at("t_hex"));
    }
}

TEST_CASE("variants, --variant, --set and --size choose what is mapped") {
    const Scratch scratch;
    const std::string out = " -i sphere.press -f f32" + into(scratch, "");
    must("map rtg-fig-7-4 --size 40x30" + out);
    for (const char* id : {"r1e3", "r1e4", "r1e5", "r1e6", "r6371000"})
        CHECK(fs::exists(scratch / (std::string("rtg-fig-7-4.") + id) / "summary.csv"));
    must("map rtg-fig-7-4 --variant r1e3 --size 20x10" + out);
    CHECK(read_csv(scratch / "rtg-fig-7-4.r1e3/summary.csv").front().at("rays") == "200");
    CHECK(read_csv(scratch / "rtg-fig-7-4.r1e4/summary.csv").front().at("rays") == "1200");
    const std::string scene = scratch.write("scene.toml", good_scene);
    must("map '" + scene + "'" + out);
    const auto before = read_csv(scratch / "scene/summary.csv").front().at("agree_hit");
    must("map '" + scene + "' --set 'sphere[0].radius=0.25'" + out);
    const auto after = read_csv(scratch / "scene/summary.csv").front().at("agree_hit");
    CHECK(number_in(after) > 0);
    CHECK(number_in(after) < number_in(before));
    // The file's title may tell of the numbers that were changed.
    const auto title = [&](const char* id) {
        return nlohmann::json::parse(contents(scratch.path() / id / "datapackage.json"))["title"].get<std::string>();
    };
    CHECK(title("scene").ends_with(", with sphere[0].radius=0.25"));
    CHECK_FALSE(has(title("rtg-fig-7-4.r1e3"), "with"));
}

TEST_CASE("own inputs and narrow formats show input error, and shared inputs in f32 and f64 do not") {
    const Scratch scratch;
    must(
        "map world-offset world-offset-own --size 48x48 -i sphere.unified -f f32 -f f64 -f bf16 --metric "
        "input_error --metric model_error" +
        into(scratch, ""));
    const auto worst = [&](const char* scene, const char* format) {
        for (const auto& row : read_csv(scratch.path() / scene / "summary.csv")) {
            if (row.at("format") == format) return number_in(row.at("input_error_max"));
        }
        return std::nan("");
    };
    CHECK(worst("world-offset", "f32") == 0);
    CHECK(worst("world-offset", "f64") == 0);
    CHECK(worst("world-offset-own", "f32") > 1);
    CHECK(worst("world-offset-own", "f64") > 0);
}

TEST_CASE("an interrupted run stops within a band, however many spheres there are") {
    // bf16 makes nearly all of the 66,431 spheres candidates: one band of rows takes minutes. Where it goes
    // on, the limit of its processor time ends it.
    const Scratch scratch;
    const auto r = run("map sphereflake-far -f bf16 -i sphere.schoolbook -q" + into(scratch) + end_after(3, "TERM"),
                       ".", "set -m; ulimit -t $((3 + 40 * $(nproc))); ");
    CHECK(r.code == 130);
    CHECK(scratch.files().empty());
}

}  // namespace test_map
