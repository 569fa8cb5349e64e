// Libraries of forms over any number type, from the outside. Every measurement of a form of the catalogue gives the
// same result for its copy in a library.
#include <array>
#include <filesystem>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"
#include "external/libraries.hpp"

namespace test_formulas {

using namespace lostbits::test;

namespace {

const std::string own = plugin("own_forms");

std::string replace_text(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
    return text;
}

struct Pair {
    const char *ours, *copy;
};

}  // namespace

TEST_CASE("formulas: a form and its copy have the same map in every format", "[external]") {
    struct Case {
        Pair forms;
        const char* scene;
        const char* how = " -f f32 -f f64 -f fp16 -f p20 --bits 12";
    };
    for (const auto& [forms, scene, how] :
         {Case{{"sphere.unified", "own.unified"}, "rtg-fig-7-3-4100-oblique"},
          Case{{"sphere.double_inside", "own.double_inside"}, "near-benign", " -f f32"},
          Case{{"box.inclusive", "own.inclusive"}, "box-axis"},
          Case{{"sdf.secant_refined", "own.secant_refined"}, "sdf-sphere"}}) {
        const Scratch folder;
        const std::string ours(forms.ours), copy(forms.copy);
        must("map " + std::string(scene) + " --size 48x32 -i " + ours + " -i " + copy + how +
                 " --pixels csv --metric lost_bits --metric model_error --metric "
                 "rounding_error --metric culprit --metric condition --metric residual --exr -o out" +
                 own,
             folder.path());
        const auto out = folder.path() / "out" / scene;
        std::size_t compared = 0;
        for (const std::string& name : folder.files()) {
            const auto file = std::filesystem::path(name).filename().string();
            if (!file.starts_with(ours) || file.ends_with(".png")) continue;
            INFO(name);
            const auto twin = out / (copy + file.substr(ours.size()));
            REQUIRE(std::filesystem::exists(twin));
            CHECK(contents(out / file) == contents(twin));
            ++compared;
        }
        CHECK(compared >= (std::string(how) == " -f f32" ? 1 : 4));
        std::map<std::string, std::map<std::string, std::string>> first, second;
        for (auto& row : read_csv(out / "summary.csv")) {
            std::erase_if(row, [](const auto& cell) { return cell.first.ends_with("_explain"); });
            auto& place = (row["form"] == ours ? first : second)[row["format"]];
            row.erase("form");
            place = row;
        }
        CHECK(first.size() == (std::string(scene) == "sdf-sphere" ? 4 : first.size()));
        CHECK(first == second);
    }
}

TEST_CASE("formulas: the comparison that makes a form wrong without rounding is named", "[external]") {
    const Outcome o = must("explain --sphere 0,0,5,1 --ray 0.9999,0,0,0,0,1 -f f64 -i own.gives_up" + own);
    CHECK(has(o.out, "the form misses even without rounding."));
    CHECK(has(o.out, "Without rounding disc < 1/1000 holds, where disc is 0.000199989"));
    CHECK_FALSE(has(o.out, "root < h"));
    const Outcome right = run("explain --sphere 0,0,5,1 --ray 0.5,0,0,0,0,1 -f f64 -i own.gives_up" + own);
    CHECK_FALSE(has(right.out, "Without rounding disc"));
}

TEST_CASE("formulas: a wrong assumption of a form is not blamed on an operation that also rounds", "[external]") {
    const Outcome o = must("explain rtg-fig-7-3-4100 --pixel 128,128 -f f32 -i own.twice" + own);
    CHECK(has(o.out, "No operation is to blame: rounding inside the form causes "));
    CHECK(has(o.out, "the rest comes from what the form assumes"));
    CHECK_FALSE(has(o.out, "The culprit is"));
    const Outcome once = run("explain rtg-fig-7-3-4100 --pixel 128,128 -f f32 -i sphere.schoolbook");
    CHECK(has(once.out, "The culprit is"));
}

TEST_CASE("formulas: a form is explained in any format, with the same text", "[external]") {
    const auto explain = [](const std::string& form, const std::string& how) {
        const Outcome o = must("explain rtg-fig-7-3-4100 --pixel 128,128 -i " + form + how + own);
        return o.out;
    };
    for (const std::string how : {" -f f32", " -f fp16", " -f f32 --json", " -f f32 --fpcore", " -f f64 --c"}) {
        const std::string ours = explain("sphere.unified", how);
        CHECK(ours.size() > 200);
        CHECK(replace_text(explain("own.unified", how), "own.unified", "sphere.unified").size() > 200);
    }
    CHECK(has(explain("own.unified", " -f f32"), "disc"));
}

TEST_CASE("formulas: the cost is measured in packs of every width, with operation counts", "[external]") {
    const Scratch folder;
    must("trade --quick --repetitions 1 -i own.unified -i sphere.unified -f f32 -o out" + own, folder.path());
    std::map<std::string, std::vector<std::string>> widths, adds;
    for (auto& row : read_csv(folder.path() / "out/sphere/trade.csv")) {
        if (row["form"] != "own.unified" && row["form"] != "sphere.unified") continue;
        auto& seen = widths[row["form"]];
        if (seen.empty() || seen.back() != row["isa"]) seen.push_back(row["isa"]);
        adds[row["form"]].push_back(row["ops_add"]);
    }
    CHECK(widths["own.unified"].size() > 1);
    CHECK(widths["own.unified"] == widths["sphere.unified"]);
    CHECK(adds["own.unified"] == adds["sphere.unified"]);
    CHECK_FALSE(adds["own.unified"].front() == "0");
}

TEST_CASE("formulas: the bits are the same for every register width, and through the C interface", "[external]") {
    const Scratch folder;
    const std::string map = "map near-benign --size 50x30 -i own.unified -f f32 -f f64 --pixels csv --metric lost_bits";
    must(map + " --isa scalar -o scalar" + own, folder.path());
    std::size_t widths = 0;
    for (const std::string more : {" --isa 128", " --isa 256", " --isa 512", " --isolate"}) {
        const Outcome o = run(map + more + " -o out" + own, folder.path());
        if (has(o.err, "this processor has no registers of that width")) continue;
        INFO(more << ": " << o.err);
        REQUIRE(o.code == 0);
        ++widths;
        for (const std::string format : {"f32", "f64"}) {
            const std::string pixels = "near-benign/own.unified." + format + ".csv";
            CHECK(contents(folder.path() / "scalar" / pixels).size() > 10'000);
            CHECK(contents(folder.path() / "scalar" / pixels) == contents(folder.path() / "out" / pixels));
        }
    }
    CHECK(widths >= 2);
}

TEST_CASE("formulas: plugin check tests t, near and far of a hit", "[external]") {
    const Outcome o = run("plugin check --time-limit 2" + own.substr(own.find("--plugin") + 8));
    CHECK(o.code == 3);  // one of its forms hangs
    const auto finding = [&o](const std::string& form) {
        const auto at = o.out.find("own." + form + " in binary32");
        REQUIRE(at != std::string::npos);
        return o.out.substr(at, o.out.find("\nown.", at) - at);
    };
    for (const std::string form : {"unified", "double_inside", "inclusive"}) {
        INFO(finding(form));
        CHECK(has(finding(form), "keeps its contract"));
        CHECK(has(finding(form), "the t beside near and far is the root that counts, in every probe"));
    }
    INFO(finding("size_of_near"));
    CHECK(has(finding("size_of_near"), "fails 2 probes"));
    CHECK(has(finding("size_of_near"),
              "BROKEN inside       the t beside near and far: a ray from inside is answered with the near root without "
              "its sign"));
    CHECK_FALSE(has(finding("size_of_near"), "in every probe"));
}

TEST_CASE("formulas: a crash or a hang in any arithmetic ends the program with the form's name", "[external]") {
    for (const auto& [form, says] : std::initializer_list<std::array<std::string, 2>>{
             {"own.crashes", "SIGSEGV"},
             {"own.throws", "threw an exception: no bananas"},
             {"own.hangs", "has not answered a batch within the time limit"}}) {
        const Scratch folder;
        const Outcome o = run("map near-benign --size 32x24 -i " + form +
                                  " -f f32 -f f64 --metric model_error --time-limit 1 -o out" + own,
                              folder.path());
        INFO(o.err);
        CHECK(o.code == 3);
        CHECK(has(o.err, form));
        CHECK(has(o.err, says));
        CHECK(has(o.err, "own_forms.so"));
        CHECK(folder.files().empty());
    }
}

TEST_CASE("formulas: a library may have marching forms only, and its commands can be pasted", "[external]") {
    const Scratch folder;
    const std::string march = plugin("only_march");
    must("map sdf-sphere --size 32x24 -i mylib.half -f f32 -o out" + march, folder.path());
    auto row = read_csv(folder.path() / "out/sdf-sphere/summary.csv").front();
    CHECK(row["form"] == "mylib.half");
    CHECK(std::stoi(row["agree_hit"]) > 50);
    const std::string pasted = row["worst_explain"];
    CHECK(has(pasted, "only_march.so"));
    REQUIRE(pasted.starts_with("lostbits "));
    must(pasted.substr(9), folder.path());
}

TEST_CASE("formulas: a library that rounds a*b + c once is refused", "[external]") {
    if (!std::filesystem::exists(library("contracting"))) return;  // x86-64 alone
    const Outcome o = run("list intersectors" + plugin("contracting"));
    CHECK((o.code == 2 || has(o.err, "SIGILL")));
    CHECK((has(o.err, "-ffp-contract=off") || has(o.err, "SIGILL")));
}

TEST_CASE("formulas: a library compiled with other headers is refused before it is used", "[external]") {
    const Outcome o = run("list intersectors" + plugin("other_build"));
    CHECK(o.code == 2);
    CHECK(has(o.err, "compiled with the headers of lostbits 0.0.7-cafe"));
    CHECK(has(o.err, "compile it again"));
}

TEST_CASE("formulas: the example is the code in the documents", "[external]") {
    const std::string source = LOSTBITS_SOURCE_DIR;
    const std::string page = contents(source + "/docs/your-own-form.md");
    for (const std::string file : {"geometric.cpp", "CMakeLists.txt"}) {
        const std::string text = contents(source + "/examples/form/" + file);
        CHECK(text.size() > 100);
        CHECK(has(page, text));
    }
}

}  // namespace test_formulas
