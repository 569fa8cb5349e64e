// `lostbits diff` from the outside: which differences count, the output, and the exit status.
#include <cstdlib>

#include "catch.hpp"
#include "output/image/exr_book.hpp"
#include "output/image/image.hpp"
#include "pictures.hpp"
#include "program.hpp"

namespace test_diff {

using namespace lostbits::test;
namespace output = lostbits::output;

namespace {

/// Two files with the given texts, compared in their own folder.
Outcome diff(const std::string& a, const std::string& b, const std::string& options = "") {
    const Scratch scratch;
    scratch.write("a.csv", a);
    scratch.write("b.csv", b);
    return run("diff a.csv b.csv " + options, scratch.path());
}

void write_exr(const fs::path& path, float x, const char* command = "map") {
    output::image::ExrBook exr(
        path, {{"", {2, 1, {{"err.ulp", output::image::Channel::Type::f32}}, {{"lostbits:command", command}}}}});
    const float samples[] = {1, x};
    exr.write_rows(0, 0, 1, std::as_bytes(std::span(samples)));
    exr.close();
}

/// A part of one channel and one pixel for each name and value.
void write_parts(const fs::path& path, const std::vector<std::pair<std::string, float>>& values) {
    std::vector<output::image::ExrPart> parts;
    for (const auto& value : values)
        parts.push_back({value.first, {1, 1, {{"err.ulp", output::image::Channel::Type::f32}}, {}}});
    output::image::ExrBook book(path, parts);
    for (std::size_t p = 0; p < values.size(); ++p)
        book.write_rows(p, 0, 1, std::as_bytes(std::span(&values[p].second, 1)));
    book.close();
}

}  // namespace

TEST_CASE("diff: equal results are reported as equal, with exit status 0") {
    const auto r = diff("name,x\n\"a\",1e3\n", "name,x\r\na,1000");
    CHECK(r.code == 0);
    CHECK(r.out == "same\n");
    CHECK(r.err.empty());
    const auto quiet = diff("x\n1\n", "x\n1\n", "-q");
    CHECK(quiet.code == 0);
    CHECK(quiet.out.empty());
}

TEST_CASE("diff: a difference has its line, column and size, with exit status 1") {
    const auto r = diff("form,ulp\npress,2\nunified,nan\n", "form,ulp\npress,2.5\nunified,1\n");
    CHECK(r.code == 1);
    CHECK(r.out ==
          "a.csv: 2 differences, in 2 of 2 rows\n"
          "  ulp: 2 differ, 1 of them in kind (NaN, infinite, empty or text), largest abs 0.5 at line 2, largest rel "
          "0.2 at line 2\n"
          "a.csv:2: ulp: 2 != 2.5 (abs 0.5, rel 0.2)\n"
          "a.csv:3: ulp: nan != 1\n");
    CHECK(diff("x\n1\n", "x\n2\n", "-q").code == 1);
}

TEST_CASE("diff: tolerances and ignored columns are given by name or glob, before or after the files") {
    const std::string a = "x_max,y_max,t_hex\n1,10,0x1p+0\n", b = "x_max,y_max,t_hex\n1.5,11,0x1p+1\n";
    CHECK(diff(a, b, "--allow 'x_*=0.5' --allow y_max=0,0.1 --ignore t_hex").code == 0);
    CHECK(diff(a, b, "--allow 'x_*=0.4' --allow y_max=0,0.1 --ignore t_hex").code == 1);
    CHECK(diff(a, b, "--allow 'x_*=0.5' --allow y_max=0,0.1").code == 1);
    CHECK(diff(a, b, "--ignore '*'").code == 0);
    const Scratch scratch;
    scratch.write("a.csv", a);
    scratch.write("b.csv", b);
    must("diff --allow '*=1' a.csv b.csv", scratch.path());
    must("diff --ignore '*' a.csv b.csv", scratch.path());
}

TEST_CASE("diff: at most twenty lines per file are shown with the number of the others, and all with -v") {
    std::string a = "x,y\n", b = a;
    for (int i = 0; i < 33; ++i) a += "1,5\n", b += "2,6\n";
    const auto r = diff(a, b, "--allow y=1");
    CHECK(r.code == 1);
    CHECK(r.out.ends_with("a.csv: and 13 more; -v shows all\n"));
    CHECK_FALSE(has(r.out, "  y: "));
    const auto all = diff(a, b, "--allow y=1 -v");
    CHECK(has(all.out, "a.csv:34: x: 1 != 2"));
    CHECK(has(all.out, "  y: 0 differ, largest abs 1 at line 2, largest rel 0.1667 at line 2\n"));
}

TEST_CASE("diff: only pictures need the image module, and without it diff exits with 3") {
    const Scratch scratch;
    scratch.write("a.csv", "x\n1\n");
    scratch.write("b.csv", "x\n2\n");
    write_exr(scratch / "a.exr", 2);
    write_exr(scratch / "b.exr", 3);
    const std::string without = "export LOSTBITS_IMAGE_MODULE=/nowhere.so;";
    CHECK(run("diff a.csv b.csv", scratch.path(), without).code == 1);
    must("diff a.csv a.csv", scratch.path(), without);
    const auto r = run("diff a.exr b.exr", scratch.path(), without);
    CHECK(r.code == 3);
    CHECK(has(r.err, "/nowhere.so"));
    CHECK(r.out.empty());
    must("diff a.exr a.exr", scratch.path(), without);
    CHECK(run("diff a.exr a.exr --ignore err.upl", scratch.path()).code == 2);
    CHECK(run("diff a.csv b.csv >/dev/full", scratch.path()).code == 3);
}

TEST_CASE("diff: an unreadable file makes diff exit with 3") {
    // A file whose first byte cannot be read, not even by root.
    const auto r = run("diff /proc/self/mem /proc/self/mem");
    CHECK(r.code == 3);
    CHECK(has(r.err, "/proc/self/mem: cannot read: "));
    CHECK(r.out.empty());
}

TEST_CASE("diff: an EXR file of several parts is compared part by part and by name") {
    draw_pictures();
    const Scratch scratch;
    write_parts(scratch / "a.exr", {{"press.f32", 1}, {"press.f64", 2}, {"truth", 3}});
    write_parts(scratch / "b.exr", {{"press.f32", 1}, {"press.f64", 2.5}, {"truth", 3}});
    write_parts(scratch / "c.exr", {{"press.f64", 2}, {"press.f32", 1}, {"unified.f32", 3}});
    const auto r = run("diff a.exr b.exr", scratch.path());
    CHECK(r.code == 1);
    CHECK(r.out ==
          "a.exr: 1 difference\n"
          "  press.f64: err.ulp: 1 differ, largest abs 0.5 at 0,0, largest rel 0.2 at 0,0\n"
          "a.exr: press.f64: err.ulp at 0,0: 2 != 2.5 (abs 0.5, rel 0.2)\n");
    CHECK(run("diff a.exr b.exr --allow err.ulp=0.5", scratch.path()).out == "same\n");
    CHECK(run("diff a.exr b.exr --allow err.upl=0.5", scratch.path()).code == 2);
    must("diff a.exr a.exr --ignore err.ulp", scratch.path());
    CHECK(run("diff a.exr c.exr", scratch.path()).out ==
          "a.exr: 3 differences\n"
          "a.exr: part press.f64 is moved in the second\n"
          "a.exr: part truth is missing in the second\n"
          "a.exr: part unified.f32 is added in the second\n");
}

TEST_CASE("diff: a pipe is read as the kind of the other side") {
    const Scratch scratch;
    scratch.write("a.csv", "x\n1e3\n");
    must("diff a.csv /dev/stdin", scratch.path(), "printf 'x\\n1000\\n' |");
    CHECK(run("diff /dev/stdin a.csv", scratch.path(), "printf 'x\\n1001\\n' |").code == 1);
}

TEST_CASE("diff --strict: folders are compared file by file, each kind in its own way") {
    const Scratch scratch;
    for (const char* folder : {"one/sub", "two/sub"}) {
        fs::create_directories(scratch.path() / folder);
        const std::string name = std::string(folder, 3);
        scratch.write(name + "/t.csv", name == "one" ? "x\n1e3\n" : "x\n1000\n");
        scratch.write(std::string(folder) + "/u.csv", "y\n1\n");
        scratch.write(name + "/d.json", "{}");
        write_png(scratch.path() / folder / "p.png", 6);
        write_exr(scratch.path() / folder / "e.exr", 2, name.c_str());
    }
    const auto compare = [&](const std::string& options = "") {
        return run("diff one two --strict " + options, scratch.path());
    };
    CHECK(compare().out == "same\n");
    CHECK(compare().code == 0);
    CHECK(compare("-v").out ==
          "one/d.json: same\none/sub/e.exr: same\none/sub/p.png: same\none/sub/u.csv: same\none/t.csv: same\nsame\n");

    // A column is known if one of the two files has it.
    scratch.write("two/sub/u.csv", "y\n2\n");
    CHECK(compare().code == 1);
    CHECK(has(compare().out, "one/sub/u.csv:2: y: 1 != 2"));
    CHECK(compare("--allow y=1").code == 0);
    CHECK(compare("--ignore y").code == 0);
    CHECK(compare("--ignore z").code == 2);
    scratch.write("two/sub/u.csv", "y\n1\n");

    scratch.write("two/d.json", "{ }");
    CHECK(has(compare().out, "one/d.json:1: bytes differ from byte 1 on; 2 != 3 bytes in total\n"));
    scratch.write("two/d.json", "{}");

    write_png(scratch / "two/sub/p.png", 7);
    CHECK(has(compare().out, "one/sub/p.png: pixel at 1,0: 4,5,6 != 4,5,7\n"));
    write_png(scratch / "two/sub/p.png", 6);

    scratch.write("two/sub/extra.txt", "");
    scratch.write("one/.hidden", "");
    const auto r = compare();
    CHECK(r.code == 1);
    CHECK(r.out == "one/.hidden: only in one\ntwo/sub/extra.txt: only in two\n");
    fs::remove(scratch / "one/.hidden");
    fs::remove(scratch / "two/sub/extra.txt");
    CHECK(compare().code == 0);

    // One bad file makes the answer an error, and a pipe or a broken link is not skipped.
    scratch.write("two/t.csv", "x\n1,2\n");
    CHECK(compare().code == 2);
    CHECK(has(compare().err, "two/t.csv:2: "));
    scratch.write("two/t.csv", "x\n1000\n");
    fs::create_symlink("nowhere", scratch / "two/link");
    CHECK(compare().code == 2);
}

TEST_CASE("diff: two equal runs of map are the same, and another form is not") {
    draw_pictures();
    const Scratch scratch;
    const std::string map = "map near-benign --size 96x72 -f f32 --pixels csv --exr -i ";
    for (const char* out : {"one", "two"}) must(map + "sphere.press -o " + out, scratch.path());
    must(map + "sphere.schoolbook -o three", scratch.path());
    CHECK(run("diff one two", scratch.path()).out == "same\n");
    const std::string stem = "/near-benign/sphere.";
    const auto tables = run("diff one" + stem + "press.f32.csv three" + stem + "schoolbook.f32.csv", scratch.path());
    CHECK(tables.code == 1);
    CHECK(has(tables.out, "\n  ulp_error: "));
    const auto pictures = run("diff one/near-benign/near-benign.exr three/near-benign/near-benign.exr", scratch.path());
    CHECK(pictures.code == 1);
    CHECK(has(pictures.out, ": part sphere.press.f32 is missing in the second\n"));
    CHECK(has(pictures.out, ": part sphere.schoolbook.f32 is added in the second\n"));
    CHECK_FALSE(has(pictures.out, "truth"));
}

}  // namespace test_diff
