// In a locale that writes 0.5 as 0,5 and 1000 as 1.000 the program reads and writes the same bytes as elsewhere, even
// where a library sets that locale for the whole program.
#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"

namespace test_locale {

using namespace lostbits::test;
namespace fs = std::filesystem;

namespace {

const std::string comma_library = std::string(LOSTBITS_LIBRARIES) + "/comma.so";

const std::string claims = make_claim_file({{"comma", "scene = \"camera-inside\"\n" + form_keys("sphere.unit_half_b"),
                                             metric_keys("false_miss_fraction", "[0.5, 1.5]")}});

/// Numbers that are read digit by digit, in plain text and as hex floats; a comma inside would end a cell.
const std::string rays =
    "ox,oy,oz,dx,dy,dz,hit,t\n0.25,0,-1234.5,0,0,1,1,1233.53175\n0x1.8p-2,-.5e-1,-5,0,0,1.5,1,2.7\n";

/// All files that the commands leave in the folder, and their output, without the times of a run.
using Left = std::map<std::string, std::string>;

/// A small run of each command, in a locale; every form in `more` comes from the library.
Left work_in(const std::string& locale, const Scratch& locales, const std::string& more, const std::string& library) {
    const Scratch folder;
    static_cast<void>(folder.write("small.toml", small_sweep));
    static_cast<void>(folder.write("claims.toml", claims));
    static_cast<void>(folder.write("rays.csv", rays));
    const std::string here = "export LC_ALL=" + locale + " LOCPATH='" + locales.path().string() + "';";
    const std::string forms = " -i sphere.schoolbook" + more + " -f f32" + library;
    Left left;
    for (const std::string& command :
         {"map near-benign --size 32x24" + forms + " --pixels csv --exr -o map",
          "sweep small.toml --seeds 1" + forms + " -o sweep",
          "judge rays.csv --answer-format f32 --sphere 0.5,0,0,1.25" + forms + " -o judge",
          "check claims.toml --export-csv claims.csv --export-json claims.json --junit claims.xml" + library,
          "report near-benign small.toml --size 32x24 --claims 'rtg7.fig6.schoolbook-near-*'" + forms + " -o page",
          "explain near-benign --pixel 16,12 -i sphere.schoolbook -f f32" + library,
          "explain --sphere=0.5,0,0,1.25 --ray=0.25,0,-1234.5,0,0,1 -i sphere.schoolbook -f f32" + library}) {
        const Outcome o = must(command, folder.path(), here);
        left["printed by " + command] = o.out;
    }
    const std::regex time_of_run("time=\"[0-9]+\\.[0-9]+\"");
    for (const std::string& name : folder.files()) {
        left[name] = contents(folder.path() / name);
        if (name == "claims.xml") left[name] = std::regex_replace(left[name], time_of_run, "");
    }
    return left;
}

void require_same(const Left& a, const Left& b) {
    REQUIRE(a.size() == b.size());
    for (const auto& [name, bytes] : a) {
        INFO(name);
        REQUIRE(b.contains(name));
        CHECK(b.at(name) == bytes);
    }
    // The files include those that each command is for.
    for (const char* name : {"map/near-benign/summary.csv", "sweep/small/onsets.csv", "judge/rays/summary.csv",
                             "claims.csv", "claims.json", "claims.xml", "page/index.html"}) {
        INFO(name);
        CHECK((a.contains(name) && a.at(name).size() > 100));
    }
}

/// The requested locale, built for this test.
void make_locale(const Scratch& locales) {
    INFO("localedef -i de_DE -f UTF-8: on Debian, the package `locales` has what it takes");
    const std::string made = (locales.path() / "de_DE.UTF-8").string();
    static_cast<void>(std::system(("localedef -i de_DE -f UTF-8 '" + made + "' >/dev/null 2>&1").c_str()));
    REQUIRE(fs::exists(fs::path(made) / "LC_NUMERIC"));
}

}  // namespace

TEST_CASE("a locale of decimal commas changes no byte") {
    const Scratch locales;
    make_locale(locales);
    require_same(work_in("C", locales, "", ""), work_in("de_DE.UTF-8", locales, "", ""));
}

TEST_CASE("a library that takes a locale of decimal commas for the whole program changes no byte") {
    const Scratch locales;
    make_locale(locales);
    const std::string with = " --plugin " + comma_library, form = " -i example.schoolbook";
    require_same(work_in("C", locales, form, with), work_in("de_DE.UTF-8", locales, form, with));
}

TEST_CASE("a library in a child process may also set its locale") {
    const Scratch locales;
    make_locale(locales);
    const Scratch folder;
    for (const std::string locale : {"C", "de_DE.UTF-8"}) {
        must("map near-benign --size 32x24 -i example.schoolbook -f f32 --pixels csv --isolate -o " + locale +
                 " --plugin " + comma_library,
             folder.path(), "export LC_ALL=" + locale + " LOCPATH='" + locales.path().string() + "';");
    }
    const std::string name = "near-benign/example.schoolbook.f32.csv";
    CHECK(contents(folder.path() / "C" / name).size() > 10'000);
    CHECK(contents(folder.path() / "C" / name) == contents(folder.path() / "de_DE.UTF-8" / name));
}

}  // namespace test_locale
