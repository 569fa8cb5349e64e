// Every way to be wrong: the place, the remedy, the exit code, and nothing written.
#include <tuple>

#include "catch.hpp"
#include "program.hpp"

namespace test_bad_input {

using namespace lostbits::test;

namespace {

std::string with_axis(const std::string& name) { return replaced(small_sweep, "distance_radii", name); }

}  // namespace

TEST_CASE("a bad scene or sweep is refused with its place and a remedy, and nothing is written") {
    // tests/scene has what else can be wrong with a file.
    const Scratch scratch;
    scratch.write("scene.toml", good_scene);
    std::string endless = "schema = \"lostbits-scene/1\"\nx";
    for (int i = 0; i < 60000; ++i) endless += ".a";
    const std::string head = "schema = \"lostbits-sweep/1\"\ntitle = \"t\"\nsource = \"-\"\nnote = \"-\"\n";
    const std::pair<const char*, std::string> files[] = {
        {"key.toml", spoilt("look_at", "lookat")},
        {"radius.toml", spoilt("radius = 1", "radius = 1e-60")},
        {"syntax.toml", spoilt("kind = \"orthographic\"", "kind = \"orthographic")},
        {"book.toml", spoilt("title = \"", "title = \"" + std::string(400, 'x'))},
        {"deep.toml", endless + " = 1\n"},
        {"edges.toml", head + "[edge_search]\nscene = \"near-bening\"\n"},
        {"axis.toml",
         head + "scene = \"near-bening\"\n[[axis]]\nname = \"a\"\nfrom = 1\nto = 2\nset = [\"sphere[0].radius\"]\n"},
        {"form.toml", with_axis("form")},
        {"hex.toml", with_axis("hex")},
        {"views.toml", with_axis("views")},
    };
    for (const auto& [name, text] : files) scratch.write(name, text);
    check_refused(scratch, "map -o out",
                  {{"key.toml", "key.toml:11:1: camera.look_at is missing, but there is"},
                   {"radius.toml", "radius.toml:17:10: sphere[0].radius becomes 0 in binary32"},
                   {"syntax.toml", "syntax.toml:9:"},
                   {"book.toml", "book.toml:2:9: title"},
                   {"book.toml", "400 are enough"},
                   {"deep.toml", "deep.toml:2:1:"}});
    check_refused(
        scratch, "sweep -i sphere.press -f f32 -o out",
        {{"--worst edges.toml", "edges.toml:6:9: edge_search.scene cannot be found: no scene \"near-bening\""},
         {"axis.toml", "axis.toml:5:9: scene cannot be found: no scene \"near-bening\""},
         {"form.toml", "form.toml:11:8: an axis that is named \"form\" gives the results two columns"},
         {"hex.toml", "an axis that is named \"hex\" gives the results two columns"},
         {"views.toml", "an axis that is named \"views\" gives the results two columns"}});
}

TEST_CASE("bad words on the command line: exit code and what was meant") {
    const Scratch scratch;
    scratch.write("scene.toml", good_scene);
    check_refused(scratch, "map -o out",
                  {{"scene.toml -i sphere.schoolbok", "sphere.schoolbook"},
                   {"scene.toml -i 'box.*'", "sphere.*", 4},
                   {"scene.toml -i 'prism.*'", "list forms", 4},
                   {"scene.toml -f f23", "f32"},
                   {"scene.toml -f p1", "pN"},
                   {"scene.toml -f p54", "pN"},
                   {"scene.toml -f p12..p5", "pN"},
                   {"scene.toml -i sphere.double_inside -f f64", "formats", 4},
                   {"scene.toml --metric lost_bit", "lost_bits"},
                   {"scene.toml -i sphere.schoolbook --metric contribution:dist", "did you mean \"disc\""},
                   {"scene.toml --size 100", "512x384"},
                   {"scene.toml --size 0x100", "size"},
                   {"scene.toml --size 100000x100000", "65536"},
                   {"scene.toml --set sphere[0].radus=2", "radius"},
                   {"scene.toml --set sphere[7].radius=2", "sphere"},
                   {"scene.toml --set sphere[99999999999999999999].radius=1", "has an index that is too large"},
                   {"scene.toml --set sphere[0].radius=-1", "radius"},
                   {"scene.toml --variant v1", "variant"},
                   {"scene.toml scene.toml", "twice"},
                   {"rtg-fig-7-5", "rtg-fig-7-4"},
                   {"missing.toml", "missing.toml"},
                   {"'" + scratch.path().string() + "'", "folder"},
                   {"rtg-fig-7-4.r1e9", "r1e3"}});
    check_refused(scratch, "map scene.toml -o ''", {{"", "-o: the name of the folder is empty"}});
    check_refused(scratch, "explain --ranges -i sphere.press",
                  {{"scene.toml --range d.x=0..1 --range d.x=0..2", "has a range already"},
                   {"scene.toml --range =0..1", "NAME=LOW..HIGH"},
                   {"scene.toml --range d.x=nan..1", "--range d.x=nan..1: \"nan\""},
                   {"scene.toml --range d.q=0..1", "d.x"},
                   {"scene.toml --at 4", "is a step of a sweep"},
                   {"none.toml --at 4", "none.toml: there is no such file"},
                   {"sphere-distance", "--at distance_radii"}});
}

TEST_CASE("what the machine cannot do ends the run with 3, and leaves no half-written file") {
    const Scratch scratch;
    scratch.write("scene.toml", good_scene);
    const std::string map = "map scene.toml -i sphere.press -f f32 ", itself = (scratch / "scene.toml").string();
    // The limit on a file's size stands in for the full disk: 8 blocks of 1024 bytes in bash, 512 in others.
    for (const auto& [words, before, says] :
         {std::tuple<std::string, std::string, std::string>{"-o /proc/nowhere", "", "/proc/nowhere"},
          {"-o '" + itself + "'", "", itself},
          {"-o out", "LOSTBITS_IMAGE_MODULE=/nowhere.so", "/nowhere.so"},
          {"-o out --size 400x400", "ulimit -f 8;", "cannot write"}}) {
        const auto r = run(map + words, scratch.path(), before);
        CHECK(r.code == 3);
        CHECK(has(r.err, says));
        CHECK(scratch.files() == std::vector<std::string>{"scene.toml"});
    }
    CHECK(run("list metrics >&- 2>&-").code == 3);
    CHECK(has(run("list intersectors >/dev/full").err, "standard output"));
}

}  // namespace test_bad_input
