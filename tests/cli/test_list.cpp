#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "intersect/table.hpp"
#include "measure/metrics.hpp"
#include "program.hpp"

using namespace lostbits;
using test::run;
using test::Scratch;

TEST_CASE("list shows every intersector, as text and as JSON") {
    const auto text = run("list intersectors");
    const auto json = run("list intersectors --json");
    REQUIRE(text.code == 0);
    REQUIRE(json.code == 0);
    const auto array = nlohmann::json::parse(json.out);
    REQUIRE(array.size() == intersectors().size());
    for (std::size_t i = 0; i < array.size(); ++i) {
        const std::string name(intersectors()[i].info->name);
        CHECK(array[i]["name"] == name);
        CHECK_FALSE(array[i]["source"].get<std::string>().empty());
        CHECK(text.out.find("\n" + name + " ") != std::string::npos);
    }
}

TEST_CASE("list metrics is the metric table") {
    const auto array = nlohmann::json::parse(run("list metrics --json").out);
    REQUIRE(array.size() == metrics().size() + 2);
    for (std::size_t i = 0; i < metrics().size(); ++i) {
        CHECK(array[i]["name"] == std::string(metrics()[i].name));
        CHECK(array[i]["layer"] == std::string(metrics()[i].layer));
    }
}

TEST_CASE("the metrics of labels are listed, and every form has labels to map") {
    const auto text = run("list metrics").out;
    for (const char* name : {"contribution:LABEL", "cancellation:LABEL"}) CHECK(text.find(name) != std::string::npos);
    CHECK(text.find("lostbits list labels") != std::string::npos);
    const auto array = nlohmann::json::parse(run("list labels --json").out);
    REQUIRE(array.size() == intersectors().size());
    const Scratch scratch;
    int mapped = 0;
    for (std::size_t i = 0; i < array.size(); ++i) {
        const Intersector& form = intersectors()[i];
        CHECK(array[i]["name"] == std::string(form.info->name));
        const std::string labels = array[i]["labels"];
        INFO(form.info->name << ": " << labels);
        CHECK_FALSE(labels.empty());
        const std::string last = labels.substr(labels.rfind(' ') + 1);
        const char* const scene = form.shape == Shape::sphere ? "near-benign" : form.shape == Shape::box ? "box-one" : "sdf-sphere";
        const auto r = run(std::string("map ") + scene + " --size 8x8 -f f32 -i " + std::string(form.info->name) + " --metric \"contribution:" + last + "\" -q -o out", scratch.path());
        INFO(r.err);
        mapped += r.code == 0;
    }
    CHECK(mapped == static_cast<int>(array.size()));
    for (const auto& o : array) {
        if (o["name"] == "sphere.schoolbook") CHECK(o["labels"] == "a b c disc t");
    }
}

TEST_CASE("list formats and scenes name what map takes") {
    const auto formats = nlohmann::json::parse(run("list formats --json").out);
    CHECK(formats.size() == std::size(format_help));
    const auto scenes = nlohmann::json::parse(run("list scenes --json").out);
    const auto has = [&](const std::string& name) {
        return std::ranges::any_of(scenes, [&](const auto& s) { return s["name"] == name; });
    };
    for (const char* name : {"rtg-fig-7-3-100", "rtg-fig-7-3-2000", "rtg-fig-7-3-4100", "rtg-fig-7-3-8000", "rtg-fig-7-3-100-oblique",
                             "rtg-fig-7-3-2000-oblique", "rtg-fig-7-3-4100-oblique", "rtg-fig-7-3-8000-oblique", "rtg-fig-7-4", "near-benign",
                             "camera-inside", "grazing", "world-offset", "world-offset-own"}) {
        INFO(name);
        CHECK(has(name));
    }
    CHECK(run("list sweeps").code == 0);
    CHECK(run("list claims").code == 0);
}

TEST_CASE("help and version go to stdout and end with 0") {
    for (const char* arguments : {"--help", "map --help", "list --help"}) {
        const auto r = run(arguments);
        CHECK(r.code == 0);
        CHECK(r.out.find("Usage") != std::string::npos);
    }
    CHECK(run("--version").out.find("lostbits ") == 0);
}

TEST_CASE("a full disk behind stdout is an error, not a silence") {
    const auto r = run("list intersectors >/dev/full");
    CHECK(r.code == 3);
    CHECK(r.err.find("standard output") != std::string::npos);
}
