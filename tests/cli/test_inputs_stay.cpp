// A run writes over none of its inputs and keeps other people's files, whatever their names, links or --force.
#include <filesystem>
#include <fstream>

#include "catch.hpp"
#include "program.hpp"

namespace test_inputs_stay {

using namespace lostbits::test;

namespace {

constexpr const char* one_ray = "ox,oy,oz,dx,dy,dz,hit,t\n0,0,-5,0,0,1,1,4\n";

/// A folder with a scene, a claim about it, a ray and a shader, none of which a run may change.
class Inputs {
public:
    Inputs() {
        keep("mine.toml", good_scene);
        keep("claims.toml", one_claim);
        keep("rays.csv", one_ray);
        keep("form.glsl", "bool intersect(vec3 o, vec3 d, vec3 c, float r, out float t) { t = 1.0; return true; }\n");
    }
    [[nodiscard]] fs::path operator/(const std::string& name) const { return scratch_.path() / name; }

    void refused(const std::string& words, const std::string& says) const {
        const auto r = run(words, scratch_.path());
        INFO(words << "\n" << r.out << r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err, says));
        for (const auto& [name, text] : kept_) {
            INFO(name);
            CHECK(contents(scratch_.path() / name) == text);
        }
    }

private:
    void keep(const std::string& name, const std::string& text) {
        scratch_.write(name, text);
        kept_[name] = text;
    }

    Scratch scratch_;
    std::map<std::string, std::string> kept_;
};

const std::string taken = "is read by this run, and its results would overwrite it";

}  // namespace

TEST_CASE("check never writes over one of its inputs") {
    const Inputs inputs;
    for (const char* option : {"--junit", "--export-csv", "--export-json"}) {
        for (const char* file : {"claims.toml", "mine.toml", "./claims.toml"})
            inputs.refused(std::string("check claims.toml ") + option + " " + file, taken);
    }
    // The same file under other names.
    fs::create_hard_link(inputs / "claims.toml", inputs / "hard.toml");
    fs::create_symlink("claims.toml", inputs / "soft.toml");
    inputs.refused("check claims.toml --junit hard.toml", taken);
    inputs.refused("check claims.toml --junit soft.toml", taken);
    inputs.refused("check soft.toml --junit claims.toml", taken);
    inputs.refused("check claims.toml --shader form.glsl:intersect --junit form.glsl", "form.glsl");
}

TEST_CASE("a folder of results that holds an input is not replaced") {
    const Inputs inputs;
    must("map mine.toml -i sphere.press,sphere.unified -f f32 --pixels csv -o a", inputs / "");
    const std::string before = contents(inputs / "a/mine/summary.csv");
    // If results were written into one of the two, that one would be removed first.
    inputs.refused("diff a/mine a/mine --draw a/mine", taken);
    CHECK(contents(inputs / "a/mine/summary.csv") == before);
    // Results of an earlier run are removed before the next ones are written, unless the next run reads one of them.
    must("judge rays.csv --sphere 0,0,0,1 -i sphere.press --rows -o b", inputs / "");
    fs::path table;
    for (const auto& entry : fs::directory_iterator(inputs / "b/rays")) {
        if (entry.path().extension() == ".csv" && entry.path().filename() != "summary.csv") table = entry.path();
    }
    REQUIRE(!table.empty());
    const std::string rows = contents(table);
    const fs::path place = table.parent_path().parent_path() / table.stem();
    fs::rename(table.parent_path(), place);
    inputs.refused("judge " + (place / table.filename()).string() + " --sphere 0,0,0,1 -i sphere.press -o b", taken);
    CHECK(contents(place / table.filename()) == rows);
}

TEST_CASE("files that the program did not write stay under --force, links and their targets included") {
    const Inputs inputs;
    const std::string words = "map mine.toml -i sphere.press -f f32 -o out --force";
    const fs::path folder = inputs / "out/mine";
    fs::create_directories(folder);
    const auto write = [](const fs::path& file) { std::ofstream(file) << "precious"; };
    const auto refused_for = [&](const char* name, const char* says) {
        inputs.refused(words, std::string(name) + ": " + says);
        CHECK(contents(folder / name) == "precious");
        fs::remove(folder / name);
    };
    write(folder / "summary.csv");
    refused_for("summary.csv", "is not in the manifest.json of its folder");
    write(folder / "manifest.json");
    refused_for("manifest.json", "is not a list of results");
    write(inputs / "elsewhere");
    fs::create_symlink(inputs / "elsewhere", folder / "contact.png");
    refused_for("contact.png", "is a link, or is reached through one");
    CHECK(contents(inputs / "elsewhere") == "precious");
    write(folder / "mine.txt");
    must(words, inputs / "");
    CHECK(contents(folder / "mine.txt") == "precious");
    // A result that was since replaced by a link belongs to somebody else, too.
    fs::remove(folder / "summary.csv");
    fs::create_symlink(inputs / "elsewhere", folder / "summary.csv");
    refused_for("summary.csv", "is a link, or is reached through one");
    CHECK(contents(inputs / "elsewhere") == "precious");
    must(words, inputs / "");
    fs::remove_all(folder);
    fs::create_directories(folder);
    write(folder / "datapackage.json");
    refused_for("datapackage.json", "is not in the manifest.json of its folder");
    // Without --force, any result that is not in a list blocks the run.
    write(folder / "older.png");
    inputs.refused("map mine.toml -i sphere.press -f f32 -o out",
                   "holds results that are not in its manifest.json: older.png");
    must(words, inputs / "");
    CHECK(contents(folder / "older.png") == "precious");
}

TEST_CASE("a report does not replace an existing README or page") {
    const Inputs inputs;
    std::ofstream(inputs / "README.md") << "precious";
    std::ofstream(inputs / "index.html") << "precious";
    inputs.refused("check claims.toml --report .", "README.md: is not in the manifest.json of its folder");
    inputs.refused("report mine.toml -i sphere.press -f f32 --no-claims -o .",
                   "index.html: is not in the manifest.json");
    CHECK(contents(inputs / "README.md") + contents(inputs / "index.html") == "preciousprecious");
}

TEST_CASE("a missing TMPDIR is named") {
    const Inputs inputs;
    for (const char* words :
         {"map mine.toml -i sphere.press -f f32 -o -", "report mine.toml -i sphere.press -f f32 --no-claims -o page"}) {
        const auto r = run(words, inputs / "", "TMPDIR=" + (inputs / "nowhere").string());
        INFO(words << "\n" << r.err);
        CHECK(r.code == 3);
        CHECK(has(r.err, "TMPDIR=" + (inputs / "nowhere").string() + ": no folder can be made there"));
    }
}

TEST_CASE("a line break in an argument is shown on one line") {
    const Inputs inputs;
    inputs.refused("list forms --isa '5\nx'", "--isa 5\\nx: is not one of scalar, 128, 256, 512");
    inputs.refused("map 'near\nx' -o out", "no scene \"near\\nx\" in ");
    inputs.refused("map mine.toml -j '4\n' -o out", "4\\n: is not a number from 1 to 1024");
    inputs.refused("map mine.toml --set 'a\nb=1' -o out", "--set a\\nb=1: unknown key a\\nb");
}

TEST_CASE("a wrong input for an axis is refused with its place in the file") {
    const Inputs inputs;
    const auto refused_by = [&](const std::string& what, const std::string& by, const std::string& says) {
        std::ofstream(inputs / "s.toml") << replace_text(small_sweep, what, by);
        inputs.refused("sweep s.toml -i sphere.press -f f32 -o out", says);
    };
    const std::string set = small_sweep.substr(small_sweep.find("set = "));
    const std::string line = set.substr(0, set.find('\n'));
    refused_by(line, "set = [\"gap_radii\"]", "s.toml:16:7: unknown key sphere_rays.gap_radii; known here");
    refused_by("1048576\nsteps = 20\n" + line, "1e60\nsteps = 20\nset = [\"radius\"]",
               "s.toml:16:7: sphere_rays.radius must lie between 1.1754943508222875e-38 and 8.507059173023462e+37");
}

TEST_CASE("an image module that runs out of memory reports it") {
    if (under_sanitizer) return;  // which takes terabytes of addresses
    draw_pictures();
    const Inputs inputs;
    const auto r = run("map mine.toml -i sphere.press -f f32 -o out", inputs / "", "ulimit -v 250000;");
    CHECK(r.code == 3);
    CHECK(has(r.err, "raise `ulimit -v`"));
    CHECK_FALSE(has(r.err, "install OpenImageIO"));
}

}  // namespace test_inputs_stay
