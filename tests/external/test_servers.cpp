// A function of the user's own behind a pipe, by the servers of examples/pipes.
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"
#include "counts.hpp"

namespace test_servers {

using namespace lostbits::test;

namespace {

const std::string pipes = std::string(LOSTBITS_SOURCE_DIR) + "/examples/pipes/";

std::string node(const Scratch& folder, const std::string& serve) {
    return " --pipe 'node " + folder.write("mine.mjs", "import { serve } from \"" + pipes + R"(lostbits_pipe.mjs";
function roots(o, d, s) {
    const f = o.map((x, k) => x - s.centre[k]), dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    const a = dot(d, d), b = 2 * dot(f, d), disc = b * b - 4 * a * (dot(f, f) - s.radius * s.radius);
    if (!(disc >= 0)) return undefined;
    return [(-b - Math.sqrt(disc)) / (2 * a), (-b + Math.sqrt(disc)) / (2 * a)];
}
const first = (r) => (r === undefined || r[1] < 0 ? undefined : r[0] < 0 ? r[1] : r[0]);
const at = (o, d, t) => o.map((x, k) => x + t * d[k]);
)" + serve) +
           "'";
}

std::string python(const Scratch& folder, const std::string& serve) {
    return " --pipe 'PYTHONPATH=" + pipes + " python3 -B " + folder.write("mine.py", R"(import math
from lostbits_pipe import serve

def roots(o, d, s):
    f = [x - c for x, c in zip(o, s.centre)]
    dot = lambda u, v: u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    a, b = dot(d, d), 2 * dot(f, d)
    disc = b * b - 4 * a * (dot(f, f) - s.radius * s.radius)
    return ((-b - math.sqrt(disc)) / (2 * a), (-b + math.sqrt(disc)) / (2 * a)) if disc >= 0 and a > 0 else None

def first(r):
    return None if r is None or r[1] < 0 else r[1] if r[0] < 0 else r[0]

def at(o, d, t):
    return [x + t * y for x, y in zip(o, d)]

)" + serve) +
           "'";
}

}  // namespace

TEST_CASE("servers: a function in ten lines has the bits of sphere.schoolbook", "[external]") {
    const Scratch folder;
    must("map near-benign --size 48x32 -i 'mine.*' -i sphere.schoolbook -f f64 --pixels csv -o out" +
             node(folder, "serve({ name: 'mine.js', roots: 'first' }, (o, d, s) => first(roots(o, d, s)));") +
             python(folder, "serve(lambda o, d, s, end: first(roots(o, d, s)), 'mine.py', roots='first')"),
         folder.path());
    const auto out = folder.path() / "out/near-benign";
    const std::string ours = contents(out / "sphere.schoolbook.f64.csv");
    CHECK(ours.size() > 20'000);
    CHECK(ours == contents(out / "mine.js.f64.csv"));
    CHECK(ours == contents(out / "mine.py.f64.csv"));
}

TEST_CASE("servers: every way to take rays and to answer works as declared", "[external]") {
    int turn = 0;
    for (const auto& [js, py] : std::initializer_list<std::array<std::string, 2>>{
             {"serve({ name: 'mine.form', roots: 'first', takes: 'segment' }, (from, to, s) => {\n"
              "    const t = first(roots(from, to.map((x, k) => x - from[k]), s));\n"
              "    return t > 1 ? undefined : t;\n});",
              "serve(lambda o, to, s: first(roots(o, [b - a for a, b in zip(o, to)], s)), 'mine.form', 'segment',"
              " roots='first')"},
             {"serve({ name: 'mine.form', flags: 'line', answers: 'point' },\n"
              "    (o, d, s) => roots(o, d, s)?.map((t) => at(o, d, t)));",
              "serve(lambda o, d, s, end: [at(o, d, t) for t in roots(o, d, s) or ()] or None, 'mine.form',"
              " answers='point', flags='line')"},
             {"serve({ name: 'mine.form', flags: 'line', answers: 'thickness' }, (o, d, s) => {\n"
              "    const r = roots(o, d, s);\n    return r && [r[0], r[1] - r[0]];\n});",
              "def thick(o, d, s, end):\n    r = roots(o, d, s)\n    return r and (r[0], r[1] - r[0])\n"
              "serve(thick, 'mine.form', answers='thickness', flags='line')"},
             {"serve({ name: 'mine.form', roots: 'none' }, (o, d, s) => first(roots(o, d, s)) !== undefined);",
              "serve(lambda o, d, s, end: first(roots(o, d, s)) is not None, 'mine.form', roots='none')"}}) {
        const Scratch folder;
        ++turn;
        for (const bool by_node : {true, false}) {
            if (!is_long() && by_node != (turn % 2 == 0)) continue;  // the short tests run one or the other, in turns
            const std::string pipe = by_node ? node(folder, js) : python(folder, py);
            const Outcome o = must("plugin check" + pipe, folder.path());
            CHECK(has(o.out, "mine.form in binary64, a sphere: keeps its contract"));
        }
    }
}

}  // namespace test_servers
