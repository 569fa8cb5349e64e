// Text that a stranger wrote, in every output that shows it.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "counts.hpp"
#include "extract_code.hpp"
#include "program.hpp"

namespace test_hostile_text {

using namespace lostbits::test;
using Json = nlohmann::json;

namespace {

// The escapes are TOML's.
const std::string hostile = R"(=SUM(1)|<script>x</script>\n::error::forged\n##[error]forged %0A [link](javascript:x) )"
                            R"(\uFFFF\u202E &amp; \"q\" ' `b` \\| end)";

std::string claim(const std::string& id) {
    const std::string text = make_claim_file(
        {{id, "scene = \"mine.toml\"\n" + form_keys("sphere.press"), metric_keys("false_miss_fraction", "[0.5, 1]"),
          "note = \"" + hostile + "\"\n", "\"holds\"", hostile}});
    return replace_text(text, "A sentence", hostile);
}

bool has_forged_command(const std::string& text) {
    return has(text, "\n::error::forged") || has(text, "##[error]") || has(text, "\xE2\x80\xAE");
}

}  // namespace

TEST_CASE("a claim from an untrusted file is shown as plain text everywhere") {
    const Scratch scratch;
    scratch.write("mine.toml", spoil_scene("\"A test\"", "\"" + hostile + "\""));
    scratch.write("claims.toml", claim(hostile));
    const auto r = run("check claims.toml --annotations github --junit j.xml --export-csv c.csv --export-json c.json",
                       scratch.path());
    REQUIRE(r.code == 1);
    // One more line would be a command of the attacker.
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

TEST_CASE("titles and file names are plain text on a terminal") {
    const Scratch scratch;
    fs::create_directories(scratch / "data/scenes");
    scratch.write("data/scenes/mine.toml", spoil_scene("\"A test\"", "\"" + hostile + "\""));
    const auto list = must("--data data list scenes", scratch.path());
    CHECK_FALSE(has_forged_command(list.out));
    CHECK(has(run("--data data list scenes --json", scratch.path()).out, "\\n::error::forged"));
    // A column, and a file that does not exist.
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

TEST_CASE("a column named like a formula is text in the table of rays") {
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

TEST_CASE("a file with terminal control codes is refused") {
    const Scratch scratch;
    scratch.write("mine.toml", spoil_scene("\"A test\"", R"("A \u001b[31mtest")"));
    const auto r = run("map mine.toml -o out", scratch.path());
    CHECK(r.code == 2);
    CHECK(has(r.err, "mine.toml:2:9: title holds the control character 27, which a terminal would obey; leave it out"));
    CHECK_FALSE(fs::exists(scratch / "out"));
}

TEST_CASE("diff escapes control characters in file names") {
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

namespace {

bool there_is(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

/// Splits a command of the program as a shell does: its words, each between two line breaks.
std::string words_in_shell(const std::string& command, const Scratch& scratch) {
    const std::string script = scratch.write(
        "script", "lostbits() { printf '\\n%s\\n' \"$@\"; }\ncd '" + scratch.path().string() + "'\n" + command);
    const std::string said = (scratch / "said").string();
    CHECK(std::system(("sh '" + script + "' >'" + said + "' 2>&1").c_str()) == 0);
    return contents(said);
}

}  // namespace

TEST_CASE("a file name never becomes code in any exported language") {
    const Scratch scratch;
    const std::string flags = fs::path(LOSTBITS_PROGRAM).parent_path() / "form.flags";
    // A name holds no slash, but a path does.
    for (const std::string name :
         {R"(x"}; static inline const int pwned = ::system("id > PWNED"); constexpr Info i2{.source = "y)",
          "*/ int pwned; /*/x", "a\nint pwned;\nb/x", "x\\", "x\?\?/pwned", "$(touch PWNED)", "`touch PWNED`",
          "'; touch PWNED; '", "x lostbits: name=pwned y", ") (pwned", "\\input{pwned}"}) {
        INFO(name);
        fs::create_directories((scratch / (name + ".toml")).parent_path());
        scratch.write(name + ".toml", good_scene);
        std::string word = "'";
        for (const char c : name + ".toml") word += c == '\'' ? "'\\''" : std::string(1, c);
        word += "'";
        const std::string mend =
            "mend " + word + " --size 8x8 -i sphere.half_b --bits 20 --set 'sphere[0].radius=\"0x1p0\"'";
        must(mend + " --emit mended.hpp -o out --force", scratch.path());
        must(mend + " --emit mended.glsl", scratch.path());
        const std::string header = contents(scratch / "mended.hpp"), shader = contents(scratch / "mended.glsl"),
                          explain = "explain " + word + " --pixel 12,8 -i sphere.half_b -f f32 ";
        for (const auto& [text, language] : {std::pair(header, c_code),
                                             {shader, c_code},
                                             {must(explain + "--c", scratch.path()).out, c_code},
                                             {must(explain + "--fpcore", scratch.path()).out, fpcore_code}}) {
            INFO(text);
            CHECK_FALSE(has(extract_code(text, language), "pwned"));
            CHECK_FALSE(has(extract_code(text, language), "PWNED"));
        }
        CHECK(count_in(shader, "lostbits:") == 2);
        const std::string source = "#include \"mended.hpp\"\n";
        scratch.write("mended.cpp", source);
        if (fs::exists(flags) && (is_long() || name.starts_with("x\"")))
            CHECK(std::system(("cd '" + scratch.path().string() + "' && c++ -fsyntax-only mended.cpp @'" + flags +
                               "' >errors 2>&1")
                                  .c_str()) == 0);
        // The command that made it, in the comment and in the list of the folder, is the one that was typed.
        const std::string made = "// Made by ", line = header.substr(header.find(made) + made.size());
        const std::string listed =
            Json::parse(contents(scratch / "out" / fs::path(name).filename() / "manifest.json")).at("command");
        for (const std::string& command : {listed, line.substr(0, line.find('\n'))}) {
            if (command != listed && has(name, "\n")) continue;  // a comment is one line
            INFO(command);
            CHECK(has(words_in_shell(command, scratch), "\n" + name + ".toml\n"));
        }
        CHECK(std::ranges::none_of(scratch.files(), [](const fs::path& file) { return file.filename() == "PWNED"; }));
    }
}

TEST_CASE("shell completion never runs text from file names") {
    const Scratch scratch;
    fs::create_directories(scratch / "data/scenes");
    for (const char* name : {"$(touch${IFS}PWNED)", "`touch${IFS}PWNED`", "';touch${IFS}PWNED;'", "good-one"})
        scratch.write("data/scenes/" + std::string(name) + ".toml", good_scene);
    const std::string before = "cd '" + scratch.path().string() + "'\nexport LOSTBITS_DATA=data\n";
    if (there_is("bash")) {
        scratch.write("script", before + "source <('" LOSTBITS_PROGRAM
                                         "' completion bash)\nCOMP_WORDS=('" LOSTBITS_PROGRAM
                                         "' map '')\nCOMP_CWORD=2\n_lostbits\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
        CHECK(std::system(("bash '" + (scratch / "script").string() + "' >'" + (scratch / "said").string() + "' 2>&1")
                              .c_str()) == 0);
        CHECK(has(contents(scratch / "said"), "good-one\n"));
        CHECK_FALSE(has(contents(scratch / "said"), "touch"));
    }
    if (there_is("fish")) {
        scratch.write("script", before + "'" LOSTBITS_PROGRAM
                                         "' completion fish | source\ncomplete -C '" LOSTBITS_PROGRAM " map '\n");
        static_cast<void>(std::system(
            ("fish '" + (scratch / "script").string() + "' >'" + (scratch / "said").string() + "' 2>&1").c_str()));
        CHECK_FALSE(has(contents(scratch / "said"), "touch"));
    }
    CHECK_FALSE(fs::exists(scratch / "PWNED"));
}

TEST_CASE("a compiler is run directly by any path, without a shell") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    fs::create_directories(scratch / "a b");
    // The path would run `touch` if a shell split it into words. The script prints its arguments and compiles nothing.
    const std::string compiler = scratch.write("a b/c'c;touch PWNED", "#!/bin/sh\nprintf '%s\\n' \"$@\" >&2\nexit 1\n");
    fs::permissions(compiler, fs::perms::owner_all);
    std::string word = "'";
    for (const char c : compiler) word += c == '\'' ? "'\\''" : std::string(1, c);
    const auto r =
        must("mend mine.toml --size 8x8 -i sphere.half_b --bits 20 --price --compiler " + word + "'", scratch.path());
    CHECK(has(r.out, "mended.cpp\n-o\n"));
    CHECK_FALSE(fs::exists(scratch / "PWNED"));
    const auto none = must("mend mine.toml --size 8x8 -i sphere.half_b --bits 20 --price --compiler no-such-compiler",
                           scratch.path());
    CHECK(has(none.out, "no-such-compiler: cannot be started: No such file or directory"));
}

}  // namespace test_hostile_text
