// Libraries by name: two builds of one in one run, and commands about their forms that can be pasted.
#include <filesystem>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"
#include "external/libraries.hpp"

namespace test_builds {

using namespace lostbits::test;

TEST_CASE("plugin: explain reports how good an answer is, and nothing more of a compiled form", "[external]") {
    const Scratch folder;
    const std::string ray = "explain --sphere 0,0,0,1 --ray 0.25,0.125,-5,0,0,1 -f f32";
    const Outcome explained = must(ray + " -i example.schoolbook" + plugin("schoolbook"), folder.path());
    CHECK(has(explained.out, "Its operations are not known, because a compiled function is a black box"));
    CHECK(has(explained.out, "radius"));
    // Above the operations, the output has the properties of the form that it copies.
    const Outcome own = run(ray + " -i sphere.schoolbook", folder.path());
    const auto first = [](const std::string& text) {
        const auto begin = text.find("\n\n") + 2;
        return text.substr(begin, text.find('\n', begin) - begin);
    };
    CHECK(first(explained.out) == first(own.out));
    CHECK(has(first(explained.out), "the true t is"));
    const Outcome far = run(ray + " -i odd.far_first" + plugin("odd_plugin"), folder.path());
    CHECK(has(far.out, "Better on this ray and around it:"));
    const Outcome touching =
        run("explain --sphere 0,0,0,3 --ray 3,0,-8,0,0,1 -f f32 -i odd.nothing_ahead" + plugin("odd_plugin"),
            folder.path());
    // x and the radius, both 3, move x² - r² by 12·2^-23, and t = 8 by the root of that: 2^10.3 of its ulps.
    CHECK(has(touching.out,
              "The condition is infinite: half an ulp in each input would cost 11.3 bits; the "
              "formula loses the other 12.7 bits."));
    for (const std::string what : {" --json", " --fpcore", " --c"}) {
        const Outcome refused = run(ray + what + " -i odd.first" + plugin("odd_plugin"), folder.path());
        CHECK(refused.code == 2);
        CHECK(has(refused.err, "its operations are not known"));
        CHECK(has(refused.err, "leave out" + what));
    }
}

TEST_CASE("plugin: explain reports how good a second form's answer is, or only its decision without t", "[external]") {
    const Scratch folder;
    const std::string with = " -f f32" + plugin("odd_plugin");
    const auto explain = [&](const std::string& words) {
        const Outcome o = must("explain " + words + with, folder.path());
        return o.out;
    };
    const std::string ahead = "--sphere 0,0,0,1 --ray 0.25,0.125,-5,0,0,1",
                      inside = "--sphere 0,0,0,1 --ray 0,0,0,0,0,1";
    CHECK(has(explain(ahead + " -i sphere.unified --beside odd.far_first"),
              "odd.far_first does no better on this ray and around it: 22.9 bits lost.\n"));
    CHECK(has(explain(inside + " -i sphere.unified --beside word.misses" + plugin("worded")),
              "word.misses has another contract, so another answer is right for this ray. By its own contract: a "
              "correct miss.\n"));
    CHECK(has(explain(ahead + " -i sphere.unified --beside box.signs"),
              "box.signs is a form for another shape, so it was not tried.\n"));

    CHECK(has(explain(ahead + " -i odd.predicate"), "odd.predicate answers yes, and the ray hits at 4.0"));
    CHECK(has(explain("--sphere 0,0,0,1 --ray 2,0,-5,0,0,1 -i odd.predicate"),
              "odd.predicate answers no, and the ray misses: a correct miss."));
    const Outcome worst = run("explain camera-inside --size 16x12 --worst -i odd.predicate" + with, folder.path());
    CHECK(worst.code == 2);
    CHECK(has(worst.err, "it decides every ray correctly, and it returns no t that could have an error"));
}

TEST_CASE("plugin: two builds of one library run together, each under its own name", "[external]") {
    const Scratch folder;
    std::filesystem::create_directory(folder.path() / "next");
    std::filesystem::copy_file(library("schoolbook"), folder.path() / "next/schoolbook.so");
    const std::string both = plugin("schoolbook") + " --plugin new=next/schoolbook.so";
    for (const std::string option : {"", " --isolate"}) {
        const std::string map = "map near-benign --size 32x24 -f f32 --force -o out" + both + option;
        must(map + " -i '*example.schoolbook'", folder.path());
        auto old = row_of(folder.path() / "out/near-benign/summary.csv", "example.schoolbook", "f32"),
             fresh = row_of(folder.path() / "out/near-benign/summary.csv", "new.example.schoolbook", "f32");
        CHECK(std::stoi(old["agree_hit"]) > 50);
        CHECK(old["lost_bits_max"] == fresh["lost_bits_max"]);
        // Its commands name the library in the same way, and can be pasted.
        const std::string pasted = fresh["worst_explain"];
        CHECK(has(pasted, "-i new.example.schoolbook -f f32 --plugin "));
        CHECK(has(pasted, " --plugin new=next/schoolbook.so"));
        must(pasted.substr(9) + option, folder.path());
    }
    const std::string file = folder.write(
        "rays.csv", "ox,oy,oz,dx,dy,dz,hit,t\n0,0,-5,0,0,1,1,4\n0,0,-6,0,0,1,1,5\n0.5,0,-6,0,0,1,1,5.133975\n");
    for (const std::string& words : std::initializer_list<std::string>{
             "map near-benign --size 16x12 -i new.example.schoolbook --against example.schoolbook -f f32 --force -o "
             "out",
             "judge " + file + " --sphere 0,0,0,1 --answer-format f32 -i '*.schoolbook' -o out",
             "diff near-benign --size 16x12 -i new.example.schoolbook --against example.schoolbook -f f32 -o out"}) {
        const Outcome o = run(words + both, folder.path());
        INFO(words << ": " << o.err);
        CHECK((o.code == 0 || words.starts_with("diff")));
    }
    for (const std::string words :
         {"trade --quick --repetitions 1 -i '*example.schoolbook' -f f32 -o out",
          "choose near-benign --size 16x12 --bits 1 --quick -i '*example.schoolbook' -f f32 -o out"}) {
        must(words + both, folder.path());
    }
    const Outcome twice =
        run("list intersectors" + plugin("schoolbook") + " --plugin next/schoolbook.so", folder.path());
    CHECK(twice.code == 2);
    CHECK(has(twice.err, "--plugin new=next/schoolbook.so calls this form new.example.schoolbook"));
    CHECK(has(twice.err, "first in " + library("schoolbook")));
    std::filesystem::copy_file(library("own_forms"), folder.path() / "next/own_forms.so");
    const Outcome formulas =
        run("list intersectors" + plugin("own_forms") + " --plugin next/own_forms.so", folder.path());
    CHECK(formulas.code == 2);
    CHECK(has(formulas.err, "own.unified: " + library("own_forms") +
                                " and next/own_forms.so both have a form of this "
                                "name; give one library a name: --plugin new=next/own_forms.so"));
    const Outcome bad = run("list intersectors --plugin sphere=next/schoolbook.so", folder.path());
    CHECK(bad.code == 2);
    CHECK(has(bad.err, "belong to the forms that ship"));
    CHECK(has(run("list intersectors --plugin new=none.so", folder.path()).err, "--plugin none.so: no such file"));
    CHECK(has(run("list intersectors --plugin new=", folder.path()).err, "--plugin new=: names no library; "));
}

TEST_CASE("plugin: commands in claims, pages and JUnit can be pasted", "[external]") {
    const Scratch folder;
    std::filesystem::create_directory(folder.path() / "my scenes");
    std::filesystem::copy_file(std::string(LOSTBITS_DATA_DIR) + "/scenes/near-benign.toml",
                               folder.path() / "my scenes/mine.toml");
    const std::string claims = folder.write(
        "my scenes/claims.toml", make_claim_file({{"by-map", "scene = \"mine.toml\"\n" + form_keys("odd.right"),
                                                   metric_keys("false_miss_fraction", "[0.5, 0.6]")}}));
    const Outcome checked =
        run("check '" + claims + "' --junit junit.xml --export-json claims.json" + plugin("odd_plugin"), folder.path());
    CHECK(checked.code == 1);
    const auto in_words = [](const std::string& text, const std::string& before) {
        const auto begin = text.find(before) + before.size();
        return text.substr(begin, text.find_first_of("\n\"", begin) - begin);
    };
    const std::string reproduce_command = in_words(checked.out, "reproduce: lostbits ");
    CHECK(has(reproduce_command, "mine.toml' -i odd.right -f f32 -o out --plugin "));
    must(reproduce_command, folder.path());
    CHECK(has(contents(folder.path() / "junit.xml"), reproduce_command));
    // A command with two libraries names the options once.
    CHECK(reproduce_command.find("--plugin") == reproduce_command.rfind("--plugin"));
    const Outcome page =
        must("report 'my scenes/mine.toml' --size 16x12 -i odd.first -f f32 --no-claims -o page" + plugin("odd_plugin"),
             folder.path());
    const std::string html = contents(folder.path() / "page/index.html");
    CHECK(has(html, "\"named\":\"'my scenes/mine.toml' --size 16x12\""));
    CHECK(has(html, "\"from\":\" --plugin " + library("odd_plugin") + "\""));
}

}  // namespace test_builds
