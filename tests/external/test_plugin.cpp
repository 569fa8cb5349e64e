// Libraries of intersectors, from the outside: the same bits as the forms they copy, and an error with a name for every
// way in which foreign code can fail.
#include <array>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"
#include "external/libraries.hpp"

namespace test_plugin {

using namespace lostbits::test;

namespace {

/// A small map with one form of the library of odd forms.
Outcome map_by(const std::string& form, const Scratch& folder, const std::string& more = "") {
    return run("map near-benign --size 32x24 -i " + form + " -f f32 -o out" + plugin("odd_plugin") + more,
               folder.path());
}

}  // namespace

TEST_CASE("plugin: the schoolbook formula has the bits of sphere.schoolbook, in both formats", "[external]") {
    const Scratch folder;
    for (const std::string scene : {"near-benign", "rtg-fig-7-3-4100-oblique"}) {
        for (const std::string option : {"", " --isolate"}) {
            INFO(scene << option);
            must("map " + scene +
                     " --size 96x64 -i example.schoolbook -i sphere.schoolbook -f f32 -f "
                     "f64 --pixels csv -o out" +
                     plugin("schoolbook") + option,
                 folder.path());
            const auto out = folder.path() / "out" / scene;
            for (const std::string format : {"f32", "f64"}) {
                const std::string ours = contents(out / ("sphere.schoolbook." + format + ".csv"));
                CHECK(ours.size() > 100'000);
                CHECK(ours == contents(out / ("example.schoolbook." + format + ".csv")));
                auto a = row_of(out / "summary.csv", "sphere.schoolbook", format),
                     b = row_of(out / "summary.csv", "example.schoolbook", format);
                for (auto* row : {&a, &b}) {
                    row->erase("form");
                    std::erase_if(*row, [](const auto& cell) { return cell.first.ends_with("_explain"); });
                }
                CHECK(a.size() > 20);
                CHECK(a == b);
            }
        }
    }
}

TEST_CASE("plugin: a form without t is judged by its decisions alone", "[external]") {
    const Scratch folder;
    REQUIRE(map_by("odd.predicate", folder).code == 0);
    auto row = row_of(folder.path() / "out/near-benign/summary.csv", "odd.predicate", "f32");
    CHECK(row["not_a_number"] == "0");
    CHECK(row["false_hit"] == "0");
    CHECK(row["false_miss"] == "0");
    CHECK(std::stoi(row["agree_hit"]) > 100);
    CHECK(row["wrong_primitive"] == "0");
    CHECK((row["ulp_error_max"].empty() || row["ulp_error_max"] == "nan"));
}

TEST_CASE("plugin: its forms are measured without -i, and where -i names others the output says so", "[external]") {
    const Scratch folder;
    const std::string with = " --size 24x16 -f f32 -o out" + plugin("schoolbook"),
                      said = "example.schoolbook is loaded";
    const Outcome offsets = must("offsets offset-tiny" + with, folder.path());
    CHECK(!has(offsets.err, said));
    CHECK(row_of(folder.path() / "out/offset-tiny/summary.csv", "example.schoolbook", "f32").size() > 10);
    must("render raycast-acne --variant none" + with, folder.path());
    CHECK(row_of(folder.path() / "out/raycast-acne.none/summary.csv", "example.schoolbook", "f32").size() > 5);
    for (const std::string words : {"-i sphere.unified", "-i 'box.*,sphere.unified' --against sphere.press"}) {
        const Outcome other = must("map near-benign " + words + with, folder.path());
        CHECK(has(other.err, "lostbits: " + said + " but not selected; add -i example.schoolbook"));
        CHECK(!has(run("map near-benign -q " + words + with, folder.path()).err, said));
    }
    for (const std::string words : {"", "-i 'exam*'", "-i sphere.unified --against example.schoolbook",
                                    "-i example.schoolbook+box.signs", "-i 'example.*@ray-pbrt'"})
        CHECK(!has(run("map near-benign " + words + with, folder.path()).err, said));
}

TEST_CASE("plugin: a form whose shape is not in the scene is reported as left out", "[external]") {
    const Scratch folder;
    const std::string with = " -o out" + plugin("odd_plugin");
    for (const std::string words :
         {"map near-benign --size 16x16 -i odd.first -i sphere.unified -f f64",
          "map box-one --size 16x16 -i odd.first -i box.baseline -f f32",
          "sweep sphere-distance --steps 3 -i odd.first -i sphere.unified -f f64",
          "offsets offset-tiny --size 16x16 -i odd.first -i sphere.unified -f f64",
          "consistency near-benign --size 16x16 -i odd.first -i sphere.unified -f f64",
          "render raycast-acne --variant none --size 16x16 -i odd.first -i sphere.unified -f f64",
          "report near-benign --size 16x16 --no-claims -i odd.first -i sphere.unified -f f64",
          "trade --quick --repetitions 1 -i odd.first -i sphere.unified -f f64"}) {
        const Outcome other = must(words + with, folder.path());
        CHECK(has(other.err, "lostbits: left out: odd.first: the selection has no spheres in f32\n"));
        CHECK_FALSE(has(run(words + " -q" + with, folder.path()).err, "left out"));
    }
    for (const std::string words : {"map box-one --size 16x16 -f f32", "offsets offset-tiny --size 16x16 -f f64"})
        CHECK(has(run(words + with, folder.path()).err, "left out: odd.right, odd.first, odd.predicate, "));
    // Named in full, a form of the catalogue is like any other; named by a pattern, it is one of many.
    const std::string box = "map box-one --size 16x16 -f f32 -o out -i box.baseline -i ";
    CHECK(
        has(run(box + "sphere.unified", folder.path()).err, "left out: sphere.unified: the selection has no spheres"));
    CHECK_FALSE(has(run(box + "'sphere.uni*'", folder.path()).err, "left out"));
    CHECK_FALSE(has(map_by("odd.first", folder).err, "left out"));
}

TEST_CASE("plugin: other commands accept its forms too", "[external]") {
    const Scratch folder;
    const std::string with = plugin("odd_plugin");
    must("sweep sphere-distance -i odd.first -f f32 -o out" + with, folder.path());
    CHECK(read_csv(folder.path() / "out/sphere-distance/samples.csv").size() > 10);
    must("trade --quick --repetitions 1 -i odd.first -f f32 -o out" + with, folder.path());
    CHECK(has(contents(folder.path() / "out/sphere/pareto.csv"), "odd.first,f32,scalar,"));
    // The user's forms come first on the page, and a form without a title still has a caption.
    const std::string report =
        "report near-benign --size 16x16 --no-claims -f f32 -i sphere.unified -i odd.first -o page";
    must(report + with, folder.path());
    const std::string page = contents(folder.path() / "page/index.html");
    CHECK(page.find("\"form\":\"odd.first\"") < page.find("\"form\":\"sphere.unified\""));
    CHECK_FALSE(has(page, "\"title\":\"\""));
    const Outcome listed = run("list intersectors" + with, folder.path());
    CHECK(has(listed.out, "odd.predicate"));
    folder.write("claims.toml", make_claim_file({{"right", "scene = \"near-benign\"\n" + form_keys("odd.right"),
                                                  metric_keys("false_miss_fraction", "[0, 0]")}}));
    must("check claims.toml" + with, folder.path());
}

TEST_CASE("plugin: every failure ends with a name, exit status 3 and no files", "[external]") {
    struct Fault {
        const char *form, *says;
        bool isolated = true;  ///< an error with a name in a process of its own, too
    };
    for (const Fault& fault : {Fault{"odd.crash", "crashed: it read or wrote memory that is not its own (SIGSEGV)"},
                               Fault{"odd.overflow", "used up its stack", false}, Fault{"odd.throws", "no bananas"},
                               Fault{"odd.aborts", "gave up: it called abort()"}, Fault{"odd.exits", "called exit()"},
                               Fault{"odd.hangs", "has not answered a batch within the time limit"},
                               Fault{"odd.throws_through", "threw an exception through its C interface", false},
                               Fault{"odd.refuses", "it is "}, Fault{"odd.lazy", "did not write `hit`"},
                               Fault{"odd.garbage", "wrote 7 to `hit`; it must be 1 or 0"},
                               Fault{"odd.half", "did not write both near and far"}}) {
        for (const std::string option : {"", " --isolate"}) {
            if (!option.empty() && !fault.isolated) continue;
            const Scratch folder;
            const Outcome o = map_by(fault.form, folder, " --time-limit 1" + option);
            INFO(fault.form << option << ": " << o.err);
            CHECK(o.code == 3);
            if (option.empty()) CHECK(has(o.err, fault.says));
            CHECK(has(o.err, "odd_plugin.so"));
            CHECK(has(o.err, fault.form));
            CHECK_FALSE(has(o.err, "\033"));
            CHECK(folder.files().empty());
        }
    }
}

TEST_CASE("plugin: an interrupt during an endless batch ends the program", "[external]") {
    const Scratch folder;
    const Outcome o = run(
        "map near-benign --size 32x24 -i odd.hangs -f f32 -o out --time-limit 60" + plugin("odd_plugin"), folder.path(),
        "sh -c 'while ! grep -q begins /proc/self/fd/2 && kill -0 $PPID; do sleep 0.1; done; "
        "kill -INT $PPID' &");
    CHECK(o.code == 130);
    CHECK(has(o.err, "odd.hangs"));
    CHECK(has(o.err, "interrupted"));
    CHECK(folder.files().empty());
}

TEST_CASE("plugin: explain tries the forms of isolated or named libraries as a better form for a ray", "[external]") {
    const std::string what =
        "explain rtg-fig-7-3-4100-oblique --pixel 128,40 -i sphere.schoolbook -f f32 --json" + plugin("odd_plugin");
    const Scratch folder;
    const auto by = [&](const std::string& more) { return run(what + more, folder.path()); };
    const auto lists = [](const Outcome& outcome, const std::string& form) {
        return has(outcome.out, "\"" + form + "\"");
    };
    const Outcome isolated = by(" --isolate --time-limit 1");
    INFO(isolated.err);
    CHECK(isolated.code == 0);
    CHECK(lists(isolated, "odd.right"));
    CHECK(lists(isolated, "sphere.unified"));
    CHECK(lists(isolated, "odd.far_first"));  // on other rays around it, it does better
    for (const std::string form : {"odd.crash", "odd.hangs", "odd.exits", "odd.refuses"}) {
        CHECK_FALSE(lists(isolated, form));
        CHECK(has(isolated.err, form));
    }
    CHECK_FALSE(has(isolated.err, "not asked for"));
    const Outcome here = by("");
    CHECK(here.code == 0);
    CHECK_FALSE(lists(here, "odd.right"));
    CHECK(lists(here, "sphere.unified"));
    const Outcome named = by(" --beside odd.right");
    CHECK(named.code == 0);
    CHECK(lists(named, "odd.right"));
    CHECK_FALSE(lists(named, "odd.first"));
    CHECK(by(" --beside odd.crash").code == 3);
    CHECK(by(" --beside odd.rihgt").code == 2);
}

TEST_CASE("plugin: it runs in a child process, and its prints do not mix with the program's output", "[external]") {
    const Scratch folder;
    CHECK(map_by("odd.right", folder, " --isolate").code == 0);
    const Outcome talks = map_by("odd.talks", folder, " --isolate");
    CHECK(talks.code == 0);
    CHECK(has(talks.err, "hello"));
    CHECK_FALSE(has(talks.out, "hello"));
}

TEST_CASE("plugin: a file that is not a library of forms is refused with advice", "[external]") {
    const Scratch folder;
    const auto refused = [&](const std::string& name, const std::string& says) {
        const Outcome o = run("list intersectors --plugin " + name, folder.path());
        INFO(name << ": " << o.err);
        CHECK(o.code == 2);
        CHECK(has(o.err, says));
    };
    refused("no-such-library", "no such file; looked in the current folder");
    refused("./no-such-library.so", "./no-such-library.so: no such file");
    refused(folder.write("text.so", "hello"), "is not a library; give one that a compiler made (c++ -O2");
    refused(folder.write("mine.c", "hello"), "is not a library; compile it first: c++ -O2 -shared -fPIC mine.c -o");
    refused(folder.write("mine.cpp", "#include <lostbits_form.hpp>\n"),
            "compile it first: c++ -shared mine.cpp -o mine.so @build/form.flags");
    refused(folder.write("cut.so",
                         "\x7f"
                         "ELF"),
            "cannot be loaded");
    refused(library("no_forms"), "exports no lostbits_forms");
    refused("''", "no such file");
    const Outcome twice = run("list intersectors" + plugin("odd_plugin") + plugin("odd_plugin"), folder.path());
    CHECK(twice.code == 2);
    CHECK(has(twice.err, "odd.right"));
    CHECK(run("list intersectors --isolate", folder.path()).code == 2);
}

TEST_CASE("plugin: an impossible contract is refused by name", "[external]") {
    const Scratch folder;
    for (const auto& [word, says] : std::initializer_list<std::array<std::string, 2>>{
             {"no_name", "the name of a form is NULL"},
             {"name", "must begin with a letter"},
             {"no_dot", "a name is LIBRARY.FORM"},
             {"ours", "belong to the forms that ship"},
             {"shape", "shape is 99; it must be from 0 to 10"},
             {"format", "format is 16; it must be 32 (float) or 64 (double)"},
             {"roots", "roots is -1"},
             {"flags", "flags has bits that this version does not know"},
             {"line", "line needs roots = both or near"},
             {"title", "title must be one line"},
             {"run", "run is NULL"},
             {"twice", "is defined twice in binary32"},
             {"none", "states 0 forms"},
             {"version", "has no forms for version 1"}}) {
        const Outcome o = run("list intersectors" + plugin("wrong_contracts"), folder.path(), "ODD_CONTRACT=" + word);
        INFO(word << ": " << o.err);
        CHECK(o.code == 2);
        CHECK(has(o.err, says));
        CHECK(has(o.err, "wrong_contracts.so"));
    }
    must("list intersectors" + plugin("wrong_contracts"), folder.path());
}

TEST_CASE("plugin: a library can be written in plain C", "[external]") {
    const Scratch folder;
    CHECK(run("plugin check " + library("plugin_in_c"), folder.path()).code == 1);  // a NaN in a face is a miss there
    must("map box-axis --size 64x48 -i c.slabs -i box.divide -f f64 -o out" + plugin("plugin_in_c"), folder.path());
    const auto summary = folder.path() / "out/box-axis/summary.csv";
    CHECK(row_of(summary, "c.slabs", "f64")["agree_hit"] == row_of(summary, "box.divide", "f64")["agree_hit"]);
}

TEST_CASE("plugin: a reader that closes the pipe early is not blamed on the library", "[external]") {
    for (const std::string& words : {"plugin check " + library("schoolbook"),
                                     "map near-benign --size 32x24 -i odd.right -f f32 -o out" + plugin("odd_plugin"),
                                     "trade --quick -i example.schoolbook -f f32 -o out" + plugin("schoolbook")}) {
        const Scratch folder;
        const Outcome o = run(words + "); echo $? >&2; } | true", folder.path(), "{ (");
        INFO(words << ": " << o.err);
        CHECK(o.err == "141\n");  // of SIGPIPE, in silence
    }
}

TEST_CASE("plugin check: it names the broken property and says what to write", "[external]") {
    const Scratch folder;
    const Outcome o = must("plugin check " + library("schoolbook"), folder.path());
    CHECK(has(o.out, "example.schoolbook in binary32, a sphere: keeps its contract"));
    // The test above covers the forms that crash: forms are tried in the order of the library.
    const Outcome odd = run("plugin check " + library("odd_plugin") + " --time-limit 2", folder.path());
    CHECK(odd.code == 3);
    const auto finding = [&odd](const std::string& form) { return find_output_of(odd, form); };
    CHECK(has(finding("odd.right"), "keeps its contract"));
    CHECK(has(finding("odd.first"), "keeps its contract"));
    CHECK(has(finding("odd.predicate"), "keeps its contract"));
    CHECK(has(finding("odd.unit"), "keeps its contract"));
    CHECK(has(finding("odd.distance"), "say LB_UNIT"));
    CHECK(has(finding("odd.squared"), "the form expects the square of the radius"));
    CHECK(has(finding("odd.far_first"), "the far root comes first"));
    CHECK(has(finding("odd.both_ways"), "say LB_LINE"));
    CHECK(has(odd.err, "odd.crash"));
}

}  // namespace test_plugin
