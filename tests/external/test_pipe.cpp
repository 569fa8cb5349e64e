// Programs behind pipes.
#include <array>
#include <fstream>
#include <initializer_list>
#include <string>
#include <utility>

#include "catch.hpp"
#include "cli/program.hpp"

namespace test_pipe {

using namespace lostbits::test;

namespace {

const std::string pipes = std::string(LOSTBITS_SOURCE_DIR) + "/examples/pipes/";

/// A shell command that prints this much of a header and then does something.
std::string speaking(const std::string& header, const std::string& then) {
    return " --pipe \"printf 'lostbits-pipe/1\\n" + header + "\\n\\n'; " + then + "\"";
}

}  // namespace

TEST_CASE("pipe: Python and JavaScript give the answers of sphere.schoolbook in doubles", "[external]") {
    const Scratch folder;
    for (const std::string scene : {"near-benign", "rtg-fig-7-3-4100-oblique"}) {
        must("map " + scene +
                 " --size 96x64 -i 'python.*' -i 'js.*' -i sphere.schoolbook -f f64 "
                 "--pixels csv -o out --pipe " +
                 pipes + "schoolbook.py --pipe 'node " + pipes + "schoolbook.mjs'",
             folder.path());
        const auto out = folder.path() / "out" / scene;
        const std::string ours = contents(out / "sphere.schoolbook.f64.csv");
        CHECK(ours.size() > 100'000);
        CHECK(ours == contents(out / "python.schoolbook.f64.csv"));
        CHECK(ours == contents(out / "js.schoolbook.f64.csv"));
    }
    must("plugin check --pipe " + pipes + "schoolbook.py", folder.path());
}

TEST_CASE("pipe: a command that answers wrongly is named, and nothing is written", "[external]") {
    struct Fault {
        std::string pipe, says;
        int code;
    };
    for (const Fault& fault : std::initializer_list<Fault>{
             {" --pipe 'echo hello'", "printed \"hello\" first", 3},
             {" --pipe 'printf \"\\033[2Jboo\\n\"'", "printed \"\\x1b[2Jboo\" first", 3},
             {" --pipe no-such-command-here", "the shell did not find the command", 3},
             {" --pipe true", "ended with status 0", 3},
             {" --pipe 'sleep 60'", "within the time limit", 3},
             {" --pipe 'yes | tr -d \"\\n\"'", "a line of more than 4096 bytes", 3},
             {speaking("name=a.x", "cat >/dev/null"), "within the time limit", 3},
             {speaking("name=a.x", "head -c 20 >/dev/null; echo helloworld"), "answered \"hellowor\"", 3},
             {speaking("name=a.x", "head -c 20 >/dev/null; printf 'LBA1'"),
              "ended before it had written a whole answer", 3},
             {speaking("name=a.x", "exit 3"), "status 3", 3},
             {speaking("name=a.x", "head -c 100 >/dev/null; kill -SEGV \\$\\$"), "signal 11", 3},
             {speaking("name=a.x\\nshape=cube", "cat"), "shape is \"cube\"; it must be one of sphere, box, triangle",
              2},
             {speaking("shape=box", "cat"), "a form begins with name=", 2},
             {speaking("name=a.x\\ncolour=red", "cat"), "unknown key \"colour\"", 2},
             {speaking("name=a.x\\nred", "cat"), "is not key=value", 2},
             {speaking("name=a.x\\nflags=fast", "cat"), "flags is \"fast\"; it must be one of line, no_end, one_thread",
              2}}) {
        const Scratch folder;
        const Outcome o =
            run("map near-benign --size 32x24 -i 'a.*' -f f32 -o out --time-limit 1" + fault.pipe, folder.path());
        INFO(fault.pipe << ": " << o.err);
        CHECK(o.code == fault.code);
        CHECK(has(o.err, fault.says));
        CHECK_FALSE(has(o.err, "\033"));
        CHECK(folder.files().empty());
    }
}

TEST_CASE("pipe: a function of a segment may return a point, in Python and in JavaScript", "[external]") {
    const Scratch folder;
    folder.write("mine.mjs", "import { serve } from \"" + pipes + R"(lostbits_pipe.mjs";
const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
function mine(from, to, sphere) {
    const d = to.map((x, k) => x - from[k]), f = sphere.centre.map((x, k) => x - from[k]);
    const t = dot(f, d) / dot(d, d), aside = f.map((x, k) => x - t * d[k]);
    const half = sphere.radius ** 2 - dot(aside, aside);
    if (half < 0) return undefined;
    const share = t - Math.sqrt(half / dot(d, d));
    return share < 0 || share > 1 ? undefined : POINT;
}
serve({ name: "js.NAME", roots: "near", takes: "segment", answers: "NAME" }, mine);
)");
    folder.write("mine.py", "import sys\nsys.path.insert(0, '" + pipes + R"(')
from lostbits_pipe import serve
def dot(a, b): return sum(x * y for x, y in zip(a, b))
def mine(start, to, sphere):
    d, f = [x - y for x, y in zip(to, start)], [x - y for x, y in zip(sphere.centre, start)]
    t = dot(f, d) / dot(d, d)
    aside = [x - t * y for x, y in zip(f, d)]
    half = sphere.radius ** 2 - dot(aside, aside)
    if half < 0: return None
    share = t - (half / dot(d, d)) ** 0.5
    return None if share < 0 or share > 1 else POINT
serve(mine, name="py.NAME", roots="near", takes="segment", answers="NAME")
)");
    const std::string js = "from.map((x, k) => x + share * d[k])", py = "[x + share * y for x, y in zip(start, d)]";
    for (const auto& [name, in_js, in_py] :
         {std::array{std::string("point"), js, py},
          std::array{std::string("t"), std::string("share"), std::string("share")}}) {
        for (const auto& [file, point] : {std::pair("mine.mjs", in_js), std::pair("mine.py", in_py)}) {
            std::string text = contents(folder / file);
            for (const auto& [from, to] :
                 {std::pair(std::string("NAME"), name), std::pair(std::string("POINT"), point)})
                for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
                    text.replace(at, from.size(), to);
            folder.write(name + file, text);
        }
        const std::string pipe = " --pipe 'node " + name + "mine.mjs' --pipe 'python3 " + name + "mine.py'";
        const Outcome o = must("plugin check" + pipe, folder.path());
        INFO(o.out);
        CHECK(has(o.out, "js." + name + " in binary64, a sphere: keeps its contract"));
        CHECK(has(o.out, "py." + name + " in binary64, a sphere: keeps its contract"));
    }
    folder.write("plane.mjs", "import { serve } from \"" + pipes +
                                  "lostbits_pipe.mjs\";\nserve({ name: 'a.x', shape: 'plane', takes: 'segment' }, "
                                  "() => 1);\n");
    const Outcome refused = run("plugin check --pipe 'node plane.mjs'", folder.path());
    CHECK(refused.code == 3);
    CHECK(has(refused.err, "a plane gives a segment no end behind it"));
}

TEST_CASE("pipe: JavaScript copies data in proportion to the rays of a batch", "[external]") {
    const Scratch folder;
    folder.write("ball.toml", scene_text("[[mesh]]\nmake = \"icosphere\"\nlevels = 2\nradius = 2\ncentre = [0, 0, 0]\n",
                                         "", "kind = \"pinhole\"\nfov_deg = 60\neye = [0, 0, 5]\n"));
    folder.write("counts.mjs", R"(
// Counts the numbers that are read one by one from typed arrays.
const array = Object.getPrototypeOf(Float64Array.prototype), iterate = array[Symbol.iterator];
let copied = 0, rays = 0;
array[Symbol.iterator] = array.values = function () { copied += this.length; return iterate.call(this); };
const { serve } = await import(")" +
                                   pipes + R"(lostbits_pipe.mjs");
process.on("exit", () => console.error(`copied ${Math.round(copied / rays)} numbers of each ray`));
serve({ name: "js.counts", shape: "triangle", roots: "first" }, () => { ++rays; });
)");
    const Outcome o =
        must("map ball.toml --size 48x48 -j 1 -i js.counts -f f64 -o out --pipe 'node counts.mjs'", folder.path());
    INFO(o.err);
    CHECK(has(o.err, "copied 15 numbers of each ray"));  // 6 of the ray, 9 of its triangle
}

TEST_CASE("pipe: plugin serve refuses malformed requests", "[external]") {
    const Scratch folder;
    std::ofstream(folder.path() / "request") << std::string(4096, '#');
    const Outcome o =
        run("plugin serve " + std::string(LOSTBITS_LIBRARIES) + "/schoolbook.so <request >/dev/null", folder.path());
    CHECK(o.code == 2);
    CHECK(has(o.err, "is not a request of lostbits-pipe/1"));
}

}  // namespace test_pipe
