// Public reports on wrong answers of intersection functions, reproduced with the numbers of their reporters where they
// gave any: lostbits names the cause, and the answer of the repaired function is right. The causes and the right
// answers below come from the reports and from exact fractions, not from lostbits.
#include <cstdlib>
#include <string>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"
#include "user_functions.hpp"

namespace test_reports {

using namespace lostbits;
using namespace lostbits::test;

namespace {

const std::string bug_files = functions_folder + "reported_bugs";

bool is_installed(const std::string& program) {
    return std::system((program + " --version >/dev/null 2>&1").c_str()) == 0;
}

/// `named` is FILE:NAME after the name of the folder's files: `.cpp:glm::plane`.
bool can_compile(const std::string& named) { return !named.starts_with(".rs") || is_installed("rustc"); }

/// The name of the form of a function: `function.glm.plane`.
std::string form_of(const std::string& named) {
    std::string form = "function." + named.substr(named.find(':') + 1);
    for (auto at = form.find("::"); at != std::string::npos; at = form.find("::")) form.replace(at, 2, ".");
    return form;
}

std::string run_explain(const std::string& named, const std::string& ray, const std::string& suffix = "") {
    return must("explain " + ray + " -f f32 -i " + form_of(named) + suffix + " --function " + bug_files + named).out;
}

std::string run_plugin_check(const std::string& named) {
    return run("plugin check --function " + bug_files + named).out;
}

}  // namespace

TEST_CASE("reports: the operations give the bits of the compiled function", "[external]") {
    for (const char* const named :
         {".cpp:tinybvh::triangle", ".cpp:tinybvh::triangle_repaired", ".cpp:mitsuba::sphere",
          ".cpp:mitsuba::sphere_of_2023", ".cpp:mitsuba::sphere_repaired", ".cpp:wicked::sphere",
          ".cpp:wicked::sphere_repaired", ".cpp:glm::plane", ".cpp:glm::plane_repaired", ".rs:slice",
          ".rs:slice_repaired", ".rs:sphere", ".rs:sphere_asked", ".rs:sphere_repaired", ".glsl:triangle"}) {
        CAPTURE(named);
        if (!can_compile(named)) continue;
        CHECK(count_differences(*intersect::function::load_function(bug_files + named, {})) == 0);
    }
}

TEST_CASE("reports: explain names the cause, and the repaired function is right", "[external]") {
    // The triangle has sides of 2e-4f, and the ray goes through (s/3, s/3).
    const std::string small =
        "--triangle 0,0,0,0x1.a36e2ep-13,0,0,0,0x1.a36e2ep-13,0 --ray 0x1.179ecap-14,0x1.179ecap-14,-1,0,0,1";
    const std::string in_a_face =
        "--box=5.693442e-39,-5000,5000,5.693442e-39,-5000,5000 "
        "--ray=-5000,-5000,5000,0.70710677,0.70710677,0 --as f32";
    // A ray of the reporter's orthographic view of a unit sphere from 1000 away. Its error is 940 ulp.
    const std::string far_ball = "--sphere 0,0,0,1 --ray=0.96875,0.15625,1000,0,0,-1";
    const std::string parallel = "--plane 0,0,0,0,1,0 --ray 0,1,0,1,0,0";
    // Numbers of our own.
    const std::string twice = "--sphere 0,0,0,2 --ray=0,0,-10,0,0,2";
    const std::string from_inside = "--sphere 0,0,0,5 --ray 0,0,0,0,0,1";
    struct Case {
        const char* named;
        std::string ray;
        std::vector<std::string> says;  ///< the wrong answer, the cause, and its place
        const char* repaired;
        std::string repaired_says;
    };
    for (const Case& case_ : {
             Case{".cpp:tinybvh::triangle",
                  small,
                  {"reports a miss, but the ray hits at 1: a false miss",
                   "Without rounding abs(a) < 1e-06 holds, where abs(a) is 3.999999797903004e-08.",
                   "if (std::fabs(a) < 0.000001f) return false;"},
                  ".cpp:tinybvh::triangle_repaired",
                  "t = 1 (0x1p+0), the true t is 1: 0 ulp off"},
             Case{".cpp:mitsuba::sphere",
                  far_ball,
                  {"t = 999.75 (0x1.f3ep+9), the true t is 999.8073620624073", "The culprit is fma(o2.z, o2.z, ",
                   "return fmaf(a.z, b.z, fmaf(a.y, b.y, a.x * b.x));"},
                  ".cpp:mitsuba::sphere_repaired",
                  "Less than one bit is lost."},
             // The library's first repair has an error of its own.
             Case{".cpp:mitsuba::sphere_of_2023",
                  "--sphere 0,0,0,1 --ray 0.5,0,0,0,0,1",
                  {"reports a miss, but the ray hits at 0.8660254037844386: a false miss",
                   "Without rounding plane_t <= 0 holds", "if (plane_t == 0 && (l.x != 0 || l.y != 0 || l.z != 0))"},
                  ".cpp:mitsuba::sphere_repaired",
                  "Less than one bit is lost."},
             Case{".rs:slice",
                  in_a_face,
                  {"reports a hit at 0, but the ray misses: a false hit",
                   "tmin is not a number because of 1/d.z·(hi.z − o.z), where 1/d.z is infinity and hi.z − o.z is 0.",
                   "reported_bugs.rs:25:19\n 25 |         let rtr = (max[k] - origin[k]) * inv_direction[k];"},
                  ".rs:slice_repaired",
                  "a correct miss"},
             Case{".rs:sphere",
                  twice,
                  {"the true t is 4", "No operation is to blame: rounding inside the form causes",
                   "the rest comes from what the form assumes"},
                  ".rs:sphere_repaired",
                  "t = 4 (0x1p+2), the true t is 4: 0 ulp off"},
             Case{".cpp:wicked::sphere",
                  from_inside,
                  {"reports a miss, but the ray hits at 5: a false miss",
                   "Without rounding discr > 0 holds, where discr is 25; t > 0 does not hold, where t is -5; t2 < "
                   "ray.tmax "
                   "holds",
                   "if (t < TMax && t > TMin) dist = t;"},
                  ".cpp:wicked::sphere_repaired",
                  "t = 5 (0x1.4p+2), the true t is 5: 0 ulp off"},
             Case{".cpp:glm::plane",
                  parallel,
                  {"reports a hit at minus infinity, but the ray misses: a false hit",
                   "intersectionDistance = dot(planeOrig - orig, planeNormal) / d;",
                   "Without rounding d < 1.1920929e-07 holds, where d is 0."},
                  ".cpp:glm::plane_repaired",
                  "a correct miss"},
         }) {
        CAPTURE(case_.named);
        if (!can_compile(case_.named)) continue;
        const std::string text = run_explain(case_.named, case_.ray);
        for (const std::string& part : case_.says) CHECK(HasText(text, part));
        CHECK(HasText(run_explain(case_.repaired, case_.ray), case_.repaired_says));
    }
}

TEST_CASE("reports: plugin check names what a function assumes", "[external]") {
    CHECK(HasText(run_plugin_check(".cpp:tinybvh::triangle"), "it seems to compare with a fixed number, an epsilon"));
    CHECK(HasText(run_plugin_check(".cpp:tinybvh::triangle_repaired"), "keeps its contract"));
    CHECK(HasText(run_plugin_check(".cpp:mitsuba::sphere_of_2023"),
                  "BROKEN inside       a ray from inside that starts exactly beside the centre"));
    CHECK(HasText(run_plugin_check(".cpp:mitsuba::sphere_repaired"), "keeps its contract"));
    CHECK(HasText(run_plugin_check(".cpp:wicked::sphere"), "BROKEN inside"));
    CHECK_FALSE(HasText(run_plugin_check(".cpp:wicked::sphere_repaired"), "BROKEN inside"));
    CHECK(HasText(run_plugin_check(".cpp:glm::plane"), "BROKEN within       a ray in its plane hits"));
    CHECK(HasText(run_plugin_check(".cpp:glm::plane_repaired"), "kept   within"));
    if (!is_installed("rustc")) return;
    CHECK(HasText(run_plugin_check(".rs:sphere"), "the formula may assume length 1; if so, say LB_UNIT"));
    CHECK(HasText(run_plugin_check(".rs:sphere_repaired"), "kept   direction"));
    // The change that the reporter asks for makes t a distance. The crate multiplies it by the direction, so the point
    // stays wrong: with the ray above, z = -10 + 2 * 8 = 6 in place of -2.
    CHECK(HasText(run_plugin_check(".rs:sphere_asked"), "t is a distance: a direction twice as long changes nothing"));
}

TEST_CASE("reports: a ray between two triangles is lost by fused operations, not by rounding", "[external]") {
    const std::string ray = " --ray=0,0,10,0.30458447,0.30458447,-0.9024725 --as f32";
    struct Case {
        const char *triangle, *culprit, *line;
    };
    for (const auto& [triangle, culprit, line] :
         {Case{"--triangle=-5,-5,0,5,-5,0,5,5,0", "The culprit is tvec.y·pvec.y",
               "float u = dot(tvec, pvec) * invDet;"},
          Case{"--triangle=-5,-5,0,5,5,0,-5,5,0", "The culprit is d.y·qvec.y", "float v = dot(dir, qvec) * invDet;"}}) {
        CAPTURE(triangle);
        CHECK(HasText(run_explain(".glsl:triangle", triangle + ray), "Less than one bit is lost."));
        const std::string fused = run_explain(".glsl:triangle", triangle + ray, "+fma");
        CHECK(HasText(fused, "reports a miss, but the ray hits at 11.08"));
        CHECK(HasText(fused, culprit));
        CHECK(HasText(fused, line));
    }
}

}  // namespace test_reports
