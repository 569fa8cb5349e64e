// Text that a stranger wrote, in every output that shows it.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"

namespace test_hostile_text {

using namespace lostbits::test;
using Json = nlohmann::json;

namespace {

// The escapes are TOML's.
const std::string hostile = R"(=SUM(1)|<script>x</script>\n::error::forged\n##[error]forged %0A [link](javascript:x) )"
                            R"(\uFFFF\u202E &amp; \"q\" ' `b` \\| end)";

std::string claim(const std::string& id) {
    const std::string text = claims_of(
        {{id, "scene = \"mine.toml\"\n" + tested("sphere.press"), metric_in("false_miss_fraction", "[0.5, 1]"),
          "note = \"" + hostile + "\"\n", "\"holds\"", hostile}});
    return replaced(text, "A sentence", hostile);
}

bool has_forged_command(const std::string& text) {
    return has(text, "\n::error::forged") || has(text, "##[error]") || has(text, "\xE2\x80\xAE");
}

}  // namespace

TEST_CASE("a claim that a stranger wrote is text wherever it is shown") {
    const Scratch scratch;
    scratch.write("mine.toml", spoilt("\"A test\"", "\"" + hostile + "\""));
    scratch.write("claims.toml", claim(hostile));
    const auto r = run("check claims.toml --annotations github --junit j.xml --export-csv c.csv --export-json c.json",
                       scratch.path());
    REQUIRE(r.code == 1);
    // One line more than there are, and it would be somebody else's command.
    CHECK_FALSE(has_forged_command(r.out));
    CHECK(has(r.out, "\n::error file=claims.toml,line=2,title=="));
    CHECK(has(r.out, "%250A"));

    const std::string junit = contents(scratch / "j.xml");
    CHECK_FALSE(has(junit, "<script>"));
    CHECK_FALSE(has(junit, "\xEF\xBF\xBF"));
    CHECK(has(junit, "&lt;script&gt;"));

    scratch.write("plain.toml", claim("plain"));
    REQUIRE(run("check plain.toml --report report", scratch.path()).code == 1);
    const std::string readme = contents(scratch / "report/README.md");
    CHECK_FALSE(has(readme, " <script>"));
    CHECK_FALSE(has(readme, "|<script>"));
    CHECK_FALSE(has(readme, "\n::error"));
    CHECK_FALSE(has(readme, "[link](javascript"));
    CHECK(has(readme, "\\|\\<script>"));

    CHECK(has(contents(scratch / "c.csv"), "\"'=SUM(1)"));
    const auto json = Json::parse(contents(scratch / "c.json"));
    CHECK(has(json.at(0).at("statement"), "\n::error::forged"));
}

TEST_CASE("titles and names of files are text on a terminal") {
    const Scratch scratch;
    fs::create_directories(scratch / "data/scenes");
    scratch.write("data/scenes/mine.toml", spoilt("\"A test\"", "\"" + hostile + "\""));
    const auto list = must("--data data list scenes", scratch.path());
    CHECK_FALSE(has_forged_command(list.out));
    CHECK(has(run("--data data list scenes --json", scratch.path()).out, "\\n::error::forged"));
    // A column, and a file that is not there.
    scratch.write("a.csv", "\"x\n::error::forged\x1b[31m\"\n1\n");
    scratch.write("b.csv", "\"x\n::error::forged\x1b[31m\"\n2\n");
    for (const std::string words : {"diff a.csv b.csv", "map 'a\n::error::forged\x1b[31m.toml' -o out",
                                    "judge a.csv --sphere 0,0,0,1 -o out", "list '\n::error::forged'"}) {
        const auto r = run(words, scratch.path());
        INFO(words << r.out << r.err);
        CHECK(r.code != 0);
        CHECK_FALSE(has_forged_command(r.out));
        CHECK_FALSE(has_forged_command(r.err));
        CHECK_FALSE(has(r.out + r.err, "\x1b"));
    }
}

TEST_CASE("a column that is named like a formula is text in the table of rays") {
    const Scratch scratch;
    scratch.write("rays.csv", "ox,oy,oz,dx,dy,dz,=cmd()\n0,0,5,0,0,-1,=cmd()\n");
    must("judge rays.csv --sphere 0,0,0,1 -i sphere.unified --rows -o out", scratch.path());
    std::size_t tables = 0;
    for (const std::string& file : scratch.files()) {
        const std::string text = contents(scratch.path() / file);
        if (!file.ends_with(".csv") || file == "rays.csv" || !has(text, "cmd()")) continue;
        ++tables;
        CHECK(has(text, ",'=cmd(),outcome,"));
        CHECK_FALSE(has(text, ",=cmd()"));
    }
    CHECK(tables == 1);
}

TEST_CASE("a file that would have a terminal obey is refused") {
    const Scratch scratch;
    scratch.write("mine.toml", spoilt("\"A test\"", R"("A \u001b[31mtest")"));
    const auto r = run("map mine.toml -o out", scratch.path());
    CHECK(r.code == 2);
    CHECK(has(r.err, "mine.toml:2:9: title holds the control character 27, which a terminal would obey; leave it out"));
    CHECK_FALSE(fs::exists(scratch / "out"));
}

TEST_CASE("a name of a file moves no cursor where two folders differ") {
    const Scratch scratch;
    const std::string name = "x\x1b[31m\n::error::forged\xE2\x80\xAE.csv";
    for (const char* folder : {"a", "b"}) fs::create_directories(scratch.path() / folder);
    scratch.write("a/" + name, "x\n1\n");
    scratch.write("b/" + name, "x\n2\n");
    scratch.write("a/1" + name, "x\n1\n");
    for (const char* words : {"diff --strict a b", "diff --strict -v a b", "diff --strict -v a a"}) {
        const auto r = run(words, scratch.path());
        INFO(words << "\n" << r.out << r.err);
        CHECK(has(r.out, "x\\x1b[31m\\n\\x3a:error::forged\\u{202e}.csv"));
        CHECK_FALSE(has_forged_command(r.out + r.err));
        CHECK_FALSE(has(r.out + r.err, "\x1b"));
    }
}

}  // namespace test_hostile_text
