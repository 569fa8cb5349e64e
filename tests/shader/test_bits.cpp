// Bits of shaders on the available drivers, compared with the forms of the catalogue.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"
#include "counts.hpp"

namespace test_bits {

using namespace lostbits::test;

namespace {

const std::string examples = std::string(LOSTBITS_SOURCE_DIR) + "/examples/shaders/";

/// The drivers, with the order of each one's dot product.
std::vector<std::pair<std::string, std::string>> drivers() {
    std::vector<std::pair<std::string, std::string>> all;
    const Outcome o = must("devices --json");
    for (const auto& device : nlohmann::json::parse(o.out)) {
        INFO(device.dump());
        REQUIRE_FALSE(device.contains("missing"));
        all.emplace_back(device["device"], device["f32.dot"]);
    }
    return all;
}

/// A map with one row per pixel; the tables by the name of their row.
std::filesystem::path map_of(const Scratch& folder, const std::string& scene, const std::string& words) {
    must("map " + scene + " --size 96x72 --pixels csv -o out --device all " + words, folder.path());
    return folder.path() / "out" / scene;
}

/// The answers of a table of pixels, its column t_hex.
std::vector<std::string> answers_of(const std::filesystem::path& table) {
    std::vector<std::string> all;
    for (const auto& row : read_csv(table)) all.push_back(row.at("t_hex"));
    return all;
}

/// The outcomes and answers of a table of pixels.
std::vector<std::string> hex_of(const std::filesystem::path& table) {
    std::vector<std::string> all;
    for (const auto& row : read_csv(table)) all.push_back(row.at("outcome") + " " + row.at("t_hex"));
    return all;
}

}  // namespace

TEST_CASE("shader bits: the analytic sphere with explicit sums has the bits of sphere.unit_half_b", "[shader-device]") {
    const auto all = drivers();
    for (const std::string scene : {"rtg-fig-7-3-4100-oblique", "near-benign", "camera-inside"}) {
        const Scratch folder;
        const auto out = map_of(folder, scene,
                                "--shader " + examples +
                                    "sphere_in_order.glsl -i 'shader.*' -i sphere.unit_half_b "
                                    "-f f32 -f f64");
        for (const std::string format : {"f32", "f64"}) {
            const std::filesystem::path ours = out / ("sphere.unit_half_b." + format + ".csv");
            CHECK(contents(ours).size() > 50'000);
            for (const auto& [device, dot] : all) {
                INFO(scene << " on " << device << " in " << format);
                const std::filesystem::path theirs = out / ("shader.sphere_in_order." + device + "." + format + ".csv");
                // From inside, a shader of the near root is right to miss; a row of the catalogue is judged by the
                // exit.
                if (scene == "camera-inside") CHECK(answers_of(theirs) == answers_of(ours));
                else CHECK(contents(theirs) == contents(ours));
            }
        }
    }
}

TEST_CASE("shader bits: dot differs only in the order of its sum", "[shader-device]") {
    const Scratch folder;
    const std::string text =
        replace_text(contents(examples + "sphere_in_order.glsl"), "(f.x * f.x + f.y * f.y + f.z * f.z)",
                     "(f.x * f.x + (f.y * f.y + f.z * f.z))");
    const std::string from_the_right = folder.write(
        "from_the_right.glsl",
        replace_text(text, "rd.x * f.x + rd.y * f.y + rd.z * f.z", "rd.x * f.x + (rd.y * f.y + rd.z * f.z)"));
    const std::string scene = "rtg-fig-7-3-4100-oblique";
    const auto out = map_of(folder, scene,
                            "--shader " + examples + "sphere.glsl --shader " + from_the_right +
                                " -i 'shader.*' -i sphere.unit_half_b -f f32");
    const auto table = [&](const std::string& row) { return contents(out / (row + ".f32.csv")); };
    CHECK(table("shader.from_the_right.opengl") != table("sphere.unit_half_b"));
    for (const auto& [device, dot] : drivers()) {
        INFO(device << " adds " << dot);
        if (dot == "(x+y)+z") CHECK(table("shader.sphere." + device) == table("sphere.unit_half_b"));
        if (dot == "x+(y+z)") CHECK(table("shader.sphere." + device) == table("shader.from_the_right." + device));
        // These two are Mesa's, on which CI runs.
        CHECK((dot == "(x+y)+z" || dot == "x+(y+z)"));
    }
}

TEST_CASE("shader bits: a march of a field has the t of sdf.sphere_trace", "[shader-device]") {
    const Scratch folder;
    const auto out =
        map_of(folder, "sdf-sphere", "--shader " + examples + "field.glsl -i 'shader.*' -i sdf.sphere_trace -f f32");
    const auto ours = hex_of(out / "sdf.sphere_trace.f32.csv");
    CHECK(std::set<std::string>(ours.begin(), ours.end()).size() > 500);
    for (const auto& [device, dot] : drivers()) CHECK(hex_of(out / ("shader.field." + device + ".f32.csv")) == ours);
}

TEST_CASE("shader bits: every example keeps its contract, and boxes have the bits of the catalogue",
          "[shader-device]") {
    const Scratch folder;
    const auto all = drivers();
    std::set<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(examples)) files.insert(entry.path());
    std::size_t turn = 0;
    for (const auto& file : files) {
        // The short tests run each on one driver, in turns; one driver accepts HLSL.
        const std::string device = is_long() || file.extension() == ".hlsl" ? "all" : all.at(turn++ % all.size()).first;
        const Outcome o = run("plugin check --device " + device + " --shader " + file.string(), folder.path());
        // Down to a threshold of its own, 0.001 of a unit.
        const bool traces = file.filename() == "sphere_tracer.glsl" || file.filename() == "field.glsl";
        INFO(file << o.out << o.err);
        CHECK(o.code == (traces ? 1 : 0));
        CHECK(has(o.out, traces ? "BROKEN scale        where all lengths are 2^-" : "keeps its contract"));
        CHECK(static_cast<bool>(has(o.out, "BROKEN")) == traces);
    }
    const auto out = map_of(folder, "box-one", "--shader " + examples + "box.glsl -i 'shader.*' -i box.signs -f f32");
    for (const auto& row : read_csv(out / "summary.csv")) {
        INFO(row.at("form"));
        CHECK(row.at("false_hit") == "0");
        CHECK(row.at("false_miss") == "0");
    }
}

TEST_CASE("shader bits: shaders that depend on the order of operations need precise", "[shader-device]") {
    const Scratch folder;
    const auto map_by = [&](const std::string& scene, std::initializer_list<const char*> shaders) {
        std::string words = "-i 'shader.*' -i sphere.kahan_discriminant -i sphere.filtered -f f32";
        for (const std::string name : shaders) words += " --shader " + examples + name + ".glsl";
        return map_of(folder, scene, words);
    };
    const auto near = map_by("near-benign", {"kahan_fma", "kahan_split", "kahan_split_precise", "filtered_precise"}),
               far = map_by("rtg-fig-7-3-4100-oblique", {"filtered", "two_words", "two_words_precise"});
    const auto fault = [&](const std::string& form, const std::string& which) {
        for (const auto& row : read_csv(far / "summary.csv"))
            if (row.at("form") == form) return std::stoi(row.at(which));
        return -1;
    };
    const auto bits = [&](const std::string& form) { return hex_of(near / (form + ".f32.csv")); };
    for (const auto& [device, dot] : drivers()) {
        INFO(device);
        const auto on = [&device = device](const std::string& name) { return "shader." + name + "." + device; };
        CHECK(bits(on("kahan_split_precise")) == bits("sphere.kahan_discriminant"));
        CHECK(bits(on("filtered_precise")) == bits("sphere.filtered"));
        CHECK(fault(on("two_words_precise"), "false_hit") == 0);
        CHECK(fault(on("two_words_precise"), "false_miss") == 0);
        CHECK(fault(on("filtered"), "false_hit") == 0);
        if (!has(run("devices --json").out, "Mesa 22.3.6")) continue;
        // This driver rewrites these expressions, and its fma rounds twice.
        CHECK(bits(on("kahan_fma")) != bits("sphere.kahan_discriminant"));
        CHECK(bits(on("kahan_split")) != bits(on("kahan_split_precise")));
        CHECK(fault(on("two_words"), "false_hit") > 1000);
    }
}

TEST_CASE("shader bits: a march that uses length differs only in the order of its sum", "[shader-device]") {
    const Scratch folder;
    std::string text = contents(examples + "sphere_tracer.glsl");
    const std::string distance_text = "length(p - sphere.xyz) - sphere.w";
    REQUIRE(has(text, distance_text));
    const std::string square = "(p.@ - sphere.@) * (p.@ - sphere.@)";
    const auto of = [&square](char axis) {
        std::string s = square;
        for (char& c : s)
            if (c == '@') c = axis;
        return s;
    };
    text.replace(text.find(distance_text), distance_text.size(),
                 "sqrt(" + of('x') + " + (" + of('y') + " + " + of('z') + ")) - sphere.w");
    const auto out =
        map_of(folder, "sdf-sphere",
               "--shader " + examples + "sphere_tracer.glsl --shader " + folder.write("from_the_right.glsl", text) +
                   " -i 'shader.*' -i sdf.sphere_trace -f f32");
    const auto table = [&](const std::string& row) { return hex_of(out / (row + ".f32.csv")); };
    CHECK(table("shader.from_the_right.opengl") != table("sdf.sphere_trace"));
    for (const auto& [device, dot] : drivers()) {
        INFO(device << " adds " << dot);
        const std::string other = dot == "x+(y+z)" ? "shader.from_the_right." + device : "sdf.sphere_trace";
        CHECK(table("shader.sphere_tracer." + device) == table(other));
    }
}

TEST_CASE("shader bits: claims about published shaders hold on the named drivers", "[shader-device]") {
    std::string command = "check --profile libraries --device all --filter 'shader.*' -v";
    for (const auto& entry : std::filesystem::directory_iterator(examples))
        command += " --shader " + entry.path().string();
    const Outcome o = must(command);
    CHECK(has(o.out, " 0 failed"));
    const bool named = has(run("devices --json").out, "Mesa 22.3.6");
    for (const std::string claim : {"sphere.opengl", "two_words.opengl", "kahan.fma", "march.order"})
        CHECK(has(o.out, "ok       shader." + claim) == named);
    CHECK(has(o.out, "does not run on Mesa 22.3.6") == !named);
}

TEST_CASE("shader bits: every file names the driver and how it rounds", "[shader-device]") {
    const Scratch folder;
    const Outcome devices = run("devices --json");
    const auto first = nlohmann::json::parse(devices.out).at(0);
    must("map near-benign --size 16x12 --exr -i shader.sphere -f f32 --pictures all -o out --shader " + examples +
             "sphere.glsl",
         folder.path());
    const auto out = folder.path() / "out" / "near-benign";
    const std::string words = first["renderer"].get<std::string>() + ", " + first["version"].get<std::string>() +
                              ", arithmetic " + first["digest"].get<std::string>();
    for (const std::string file :
         {"datapackage.json", "manifest.json", "shader.sphere.f32.png", "contact.png", "near-benign.exr"}) {
        INFO(file);
        CHECK(has(contents(out / file), words));
    }
    CHECK(nlohmann::json::parse(contents(out / "datapackage.json"))["lostbits"]["forms"]["shader.sphere"] ==
          "sphere.glsl:5 on " + words);
}

}  // namespace test_bits
