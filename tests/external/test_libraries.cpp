// Claims about the libraries that plugins/ wraps, measured again.
#include <filesystem>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"

namespace test_libraries {

using namespace lostbits::test;

TEST_CASE("libraries: every claim about a built library holds, and the others are skipped by name", "[external]") {
    const Scratch folder;
    std::string loaded;
    int libraries = 0;
    for (const auto& entry : std::filesystem::directory_iterator(LOSTBITS_PLUGINS)) {
        if (entry.path().extension() != ".so") continue;
        loaded += " --plugin " + entry.path().stem().string();
        ++libraries;
    }
    REQUIRE(libraries >= 3);  // the schoolbook, GLM and Boost are always there
    const Outcome all = must("check --profile libraries -v" + loaded, folder.path());
    CHECK(has(all.out, "ok       lib.glm.far"));
    CHECK(has(all.out, "ok       lib.boost.far"));
    CHECK(has(all.out, " 0 failed"));
    const Outcome one = must("check --profile libraries --plugin glm", folder.path());
    CHECK(has(one.out, " confirmed, 0 failed, 80 skipped"));
    CHECK(has(one.out, "no loaded library has openvdb.sphere; add --plugin, --pipe, --shader or --function"));
}

TEST_CASE("libraries: a claim about a missing form is skipped only in the profile without the form", "[external]") {
    const Scratch folder;
    const std::string claim =
        "[[claim]]\nid = \"a\"\nstatement = \"s\"\nsource = \"-\"\nverdict = \"holds\"\n[claim.given]\n"
        "scene = \"near-benign\"\nform = \"mylib.mine\"\nformat = \"f32\"\n[claim.expect]\nmetric = \"false_hit\"\n"
        "in = [0, 0]\n";
    const std::string schema = "schema = \"lostbits-claims/1\"\n";
    const std::string here = folder.write("here.toml", schema + claim);
    const std::string theirs = folder.write("theirs.toml", schema + "profile = \"libraries\"\n" + claim);
    CHECK(run("check " + here, folder.path()).code != 0);
    // The result is unknown if nothing else is measured.
    const Outcome skipped = run("check --profile libraries " + theirs, folder.path());
    CHECK(skipped.code == 4);
    CHECK(has(skipped.err,
              "every claim was skipped, so nothing was checked; the reason of the first: no loaded library"));
    CHECK(run("check " + theirs, folder.path()).code == 4);
}

}  // namespace test_libraries
