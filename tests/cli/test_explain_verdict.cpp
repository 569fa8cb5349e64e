// lostbits explain: its first lines, the operation that it blames, and the lines that it leaves out.
#include <nlohmann/json.hpp>

#include <cctype>
#include <set>
#include <sstream>

#include "catch.hpp"
#include "intersect/table/table.hpp"
#include "program.hpp"
#include "scene_and_pixel.hpp"

namespace test_explain_verdict {

using namespace lostbits;
using namespace lostbits::test;

namespace {

const std::string far = "explain rtg-fig-7-3-4100-oblique --pixel 128,40 ";

}  // namespace

TEST_CASE("explain: the verdict comes first, and no operation is blamed for less than one bit") {
    const auto far_away = run(far + "-i sphere.schoolbook -f f32").out;
    const auto at = [](const std::string& text, const std::string& part) { return text.find(part); };
    CHECK(at(far_away, "the formula loses the other") < at(far_away, "The culprit is"));
    CHECK(at(far_away, "The culprit is") < at(far_away, "Better on this ray"));
    CHECK(at(far_away, "Better on this ray") < at(far_away, "radius   = 0x1p+0"));
    CHECK(at(far_away, "\n* c  ") != std::string::npos);
    CHECK(has(far_away, "The last column uses difference quotients, because derivatives are infinite on this ray."));
    const auto near = run("explain near-benign --pixel 100,128 -i sphere.unified").out;
    CHECK(has(near, "No operation is to blame: less than a bit is lost."));
    CHECK(has(near, "does better on this ray in this format"));
    CHECK_FALSE(has(near, "culprit"));
    CHECK_FALSE(has(near, "\n* "));
    const auto j = nlohmann::json::parse(run("explain near-benign --pixel 100,128 -i sphere.unified --json").out);
    CHECK(j["culprit"].is_null());
    CHECK(j["sentence"] == "No operation is to blame: less than a bit is lost.");
    CHECK(has(j["largest_sentence"], "The largest contribution is that of"));
}

TEST_CASE("explain: another form is better only if it keeps at least one bit more") {
    const std::string what = "explain near-benign --pixel 100,128 -i sphere.schoolbook -f f32";
    const auto j = nlohmann::json::parse(run(what + " --json").out);
    const auto text = run(what).out;
    const auto line = text.substr(text.find("etter on this ray"));
    int quality = 0, less = 0;
    for (const auto& s : j["better"]) {
        const bool bit = j["lost_bits_around"].get<double>() - s["lost_bits_around"].get<double>() >= 1;
        quality += bit;
        less += !bit;
        if (!bit) CHECK_FALSE(has(line.substr(0, line.find('\n')), s["form"].get<std::string>() + " ("));
    }
    INFO(text);
    CHECK(less > 0);
    CHECK((quality > 0) == has(text, "Better on this ray and around it:"));
}

TEST_CASE("explain: error from inputs that the format cannot hold is not blamed on a rounding") {
    // Every number of the scene is rounded to 8 bits first; the form itself does well.
    const auto r = run("explain near-benign --pixel 100,128 -i sphere.unified -f bf16");
    CHECK(has(r.out, "bf16 cannot represent all of these numbers"));
    CHECK(has(r.out, "the rest comes from inputs that the format cannot hold"));
    CHECK_FALSE(has(r.out, "The culprit is"));
}

TEST_CASE("explain: a hit of the wrong primitive is reported, with the command for the right one") {
    const auto r = run("explain sphereflake-far --pixel 102,5 -i sphere.schoolbook -f f32");
    INFO(r.out.substr(0, 2000));
    CHECK(has(
        r.out,
        "The wrong primitive: the form hits primitive 58865, but the ray first meets primitive 0 (counted from 0)."));
    CHECK(has(r.out, "\nThe scene has the primitives 0 to 66430; this is primitive 58865.\n"));
    CHECK(has(r.out, "\nAt primitive 0: Condition 17.5: half an ulp in each input costs 3.5 bits.\n"));
    const auto at = r.out.find("lostbits explain --sphere=");
    REQUIRE(at != std::string::npos);
    const auto other = must(r.out.substr(at + 9, r.out.find('\n', at) - at - 9));
    CHECK(has(other.out, "the true t is 306.782093"));
    CHECK_FALSE(has(run("explain sphereflake-near --pixel 100,100 -i sphere.unified").out, "The wrong primitive"));
}

TEST_CASE("explain: the far side of a sphere instead of the near one is reported as a wrong root") {
    // The worst ray of sphere-height-r1e6 a thousandth above the sphere: c is off by more than itself.
    const auto text = run("explain --sphere=-0x1.803p+19,-0x1.803p+18,0x1.d03ap+18,0x1.e83dp+19 "
                          "--ray=0x1.9c864cp-11,0x1.9c864cp-12,-0x1.f2779cp-12,-0x1.a1130ep-1,-0x1.50003ep-2,"
                          "0x1.e9c538p-2 -i sphere.unified -f f32")
                          .out;
    CHECK(
        has(text, "Perhaps the wrong root: another crossing of the same primitive is nearer to t than the true one."));
    CHECK(has(text, "The culprit is t = select("));
    CHECK(has(text, "its wrong choice"));
}

TEST_CASE("explain: every operation that a row names has a row of its own") {
    for (const intersect::table::Intersector& form : intersect::table::intersectors()) {
        const auto out = run("explain " + scene_and_pixel_of(form.shape) + " -i " + std::string(form.info->name)).out;
        std::set<std::string> rows, named;
        std::istringstream lines(out.substr(out.find("  operation ")));
        for (std::string line; std::getline(lines, line) && !line.starts_with("- what");) {
            const auto equals = line.find(" = ");
            if (equals == std::string::npos || line.size() < 3) continue;
            rows.insert(line.substr(2, line.find(' ', 2) - 2));
            // Names from the tape: m12, s12, v1, v1.x. The formula stands before the numbers.
            for (std::size_t k = equals; k + 1 < line.size(); ++k) {
                const bool starts = std::string("msv").find(line[k]) != std::string::npos &&
                                    std::isdigit(static_cast<unsigned char>(line[k + 1])) &&
                                    !std::isalnum(static_cast<unsigned char>(line[k - 1])) && line[k - 1] != '_';
                if (!starts) continue;
                std::size_t end = k + 1;
                while (end < line.size() && std::isdigit(static_cast<unsigned char>(line[end]))) ++end;
                std::string name = line.substr(k, end - k);
                if (line.compare(end, 1, ".") == 0) name += line.substr(end, 2);
                else if (line[k] == 'v') name += ".x";
                named.insert(name);
            }
        }
        INFO(form.info->name << "\n" << out);
        CHECK(rows.size() > 3);
        for (const std::string& name : named) {
            INFO(name);
            CHECK(rows.contains(name));
        }
    }
}

TEST_CASE("explain names the last column after the sum of its contributions and writes no NaN there") {
    const std::string hit = run("explain near-benign --pixel 100,128 -i sphere.schoolbook -f f32").out,
                      turned = run("explain grazing --worst -i sphere.press -f f32").out;
    CHECK(has(hit, " share of t, ulp\n"));
    CHECK(has(turned, " share of disc, ulp\n"));
    CHECK_FALSE(has(turned, " share of t, ulp"));
    // Rounding changed no decision, so there is no error in ulps.
    const std::string plain = run("explain --sphere 0x1.0b429p+8,0x1.0b429p+9,-0x1.90e3d8p+9,1 --ray "
                                  "-0x1.2bcp-2,0x1.adp-1,0x1.d8p-2,0x1.11cp-2,0x1.11cp-1,-0x1.9a8p-1 "
                                  "-i sphere.unified -f fp16")
                                  .out;
    CHECK(has(plain, "Rounding changed no decision"));
    const auto row = plain.find("= d.z·d.z ");
    REQUIRE(row != std::string::npos);
    CHECK_FALSE(has(plain.substr(row, plain.find('\n', row) - row), "nan"));
}

TEST_CASE("explain: what the culprit accounts for and what it causes are both shown") {
    // By hand, in fractions and with a root of 120 digits: 0.51969… with c exact, 0.44830… with c alone rounded.
    const auto j = nlohmann::json::parse(run(far + "-i sphere.schoolbook -f f32 --json").out);
    CHECK(j["culprit_alone_exact"] == nlohmann::json{{"hit", true}, {"error", 0.5196979229332985}});
    CHECK(j["culprit_alone_rounded"] == nlohmann::json{{"hit", true}, {"error", 0.44830994599291074}});
    // docs/explain.md has the sentences of it.
    CHECK(has(run(far + "-i sphere.schoolbook -f f32").out,
              "If c alone were exact, t would still be 1064 ulp off, so repairing it alone does not help much. If c"));
    const std::string beyond = run("explain --sphere 0,0,0x1p80,1 --ray 0,0,0,0,0,1 -i sphere.schoolbook -f f32").out;
    CHECK(
        has(beyond, "If b·b alone were exact, the form would miss. If b·b alone were rounded, t would not be finite."));
}

TEST_CASE("explain: a range that decides is in the verdict, with the operands compared and the rounding to blame") {
    // t is 6.6e-5 without rounding and 1.4e-4 in binary32; tmin, 1e-4, lies in between, and so the ray misses.
    const std::string what =
        "explain --sphere=0,-1001,-30,1000 --ray=-0x1.99f126p-1,-0x1.00b684p+0,-0x1.bccd1p+4,0x1.9a5e32p-2,"
        "0x1.576072p-1,0x1.3f964ep-1 --tmin 0x1.a36e2ep-14 -i sphere.unified -f f32";
    const std::string text = run(what).out;
    const auto j = nlohmann::json::parse(run(what + " --json").out);
    CHECK(has(text, "a false hit."));
    CHECK_FALSE(has(text, "The decision is the same without rounding"));
    CHECK_FALSE(has(text, "the form hits even without rounding"));
    CHECK(has(text, "The culprit is v1.y = o.y − centre.y: its rounding of 0.371 ulp accounts for "));
    CHECK(has(text,
              "If o.y − centre.y alone were exact, the form would miss. If o.y − centre.y alone were rounded, it would "
              "hit."));
    CHECK(has(text, "Rounding changed the decision t < ray.tmin: t is 0.0001395695289829746, without rounding 6.6353"));
    CHECK(has(text, "\n  ray.tmin = 0x1.a36e2ep-14         9.999999747378752e-05 (closed)\n"));
    CHECK(has(text, "\n  ray.tmax = inf                    inf (no end)\n"));
    CHECK(j["culprit"] == "v1.y");
    CHECK(has(text, j["sentence"].get<std::string>() + "\n"));
    CHECK(j["hit"] == true);
    CHECK(j["attribution"]["exact_hit"] == false);
    CHECK(j["inputs"]["ray.tmin"]["hex"] == "0x1.a36e2ep-14");
    // Behind the near root the far root counts, for those who call the form and in the C program.
    const std::string behind =
        "explain --sphere 0,0,5,1 --ray 0,0,0,0,0,1 --tmin 4.5 --open-ends tmin -i sphere.press ";
    CHECK(has(run(behind + "--c").out, "t_in_range"));
    CHECK(nlohmann::json::parse(run(behind + "--json").out)["t"]["decimal"] == 6);
    CHECK(has(run(behind).out, "4.5 (open: a surface there does not count)\n"));
}

TEST_CASE("explain: where the range alone makes a miss, the verdict says where the exact hit lies") {
    const std::string ball = "explain --sphere 0,0,5,1 --ray 0,0,0,0,0,1 -i sphere.unified -f f64 ";
    const auto says = [&ball](const std::string& range, const std::string& words) {
        const std::string text = run(ball + range).out;
        INFO(range << "\n" << text);
        CHECK(has(text, "a correct miss" + words + "\n"));
    };
    says("--tmax 3.5", ". The exact hit at t = 4 lies beyond tmax = 3.5.");
    says("--tmin 6.5", ". The exact hit at t = 4 lies before tmin = 6.5.");
    says("--tmin 5 --tmax 5.5",
         ". The exact hit at t = 4 lies before tmin = 5, and that at t = 6 lies beyond tmax = 5.5.");
    says("--tmax 4 --open-ends tmax", ". The exact hit at t = 4 lies at tmax = 4, which is open.");
    says("--tmin 7 --tmax 8", ". The exact hit at t = 4 lies before tmin = 7.");
    const std::string beside = run("explain --sphere 0,9,5,1 --ray 0,0,0,0,0,1 -i sphere.unified --tmax 3").out;
    CHECK(has(beside, "a correct miss.\n"));
    // A form of unit directions returns a distance, and so its range is a distance.
    const std::string unit = run("explain --sphere 0,0,5,1 --ray 0,0,0,0,0,2 -i sphere.unified_unit --tmax 1.5").out;
    CHECK(has(unit, "The exact hit at t = 4 lies beyond tmax = 3."));
}

TEST_CASE("explain: a ray that begins inside a box hits at its start, which no input changes") {
    const std::string box = "explain --box=-1,-1,-1,1,1,1 --ray 0,0,-5,0,0,1 -i box.signs ";
    // The far face is at t = 6, too.
    for (const std::string range : {"--tmin 6", "--tmin 5"}) {
        const std::string text = run(box + range).out;
        INFO(text);
        CHECK(has(text, "Condition 0: half an ulp in each input would cost 0.0 bits. Less than one bit is lost."));
    }
    // The near face is at t = 4: an input may move that.
    CHECK_FALSE(has(run(box + "--tmin 4").out, "would cost 0.0 bits"));
}

TEST_CASE("explain: no operation is blamed where the form is wrong without rounding, not even for a NaN") {
    const std::string what = "explain --sphere 0,0,5,1 --ray 0,0,0,0,0,0 -i sphere.unified ";
    CHECK(has(run(what).err, "--ray 0,0,0,0,0,0: the direction is 0,0,0, so this is not a ray"));
    const std::string text = run(what).out;
    INFO(text);
    CHECK(has(text,
              "No operation is to blame: the formula itself gives NaN in b'/a, even without rounding; all later "
              "operations inherit it."));
    CHECK_FALSE(has(text, "\n* "));
    CHECK(nlohmann::json::parse(run(what + "--json").out)["culprit"].is_null());
}

TEST_CASE("explain: a camera ray that is NaN is blamed on the camera's operation") {
    const std::string text = run("explain camera-far.endless --pixel 96,96 -i sphere.unified@ray-glm").out;
    INFO(text);
    CHECK_FALSE(has(text, "is normalised"));
    CHECK_FALSE(has(text, "The input d.x"));
}

TEST_CASE("explain: an operand that an operation uses twice is listed once") {
    const std::string text = run("explain rtg-fig-7-3-4100-oblique --pixel 128,40 -i sphere.schoolbook+fma -f f32").out;
    INFO(text);
    const auto line = text.substr(0, text.find("Better on"));
    const auto first = line.find("b was already off");
    CHECK((first == std::string::npos || line.find("b was already off", first + 1) == std::string::npos));
}

TEST_CASE("explain: a wrong order of two primitives is reported, with the one whose t is further off") {
    // Without rounding the large sphere is met at 6.6e-5 and the small one at 1e-4; in binary32 at 1.4e-4 and 1e-4.
    const std::string what =
        "explain "
        "--sphere=0,-1001,-30,1000 "
        "--sphere=-0x1.66a0200000000p-1,-0x1.ab8c220000000p-1,-0x1.ba4da20000000p+4,0x1.0000000000000p-2 "
        "--ray=-0x1.99f1260000000p-1,-0x1.00b6840000000p+0,-0x1.bccd100000000p+4,0x1.9a5e320000000p-2,0x1."
        "5760720000000p-1,0x1.3f964e0000000p-1 "
        "-i sphere.unified -f f32";
    const std::string text = run(what).out;
    CHECK(
        has(text,
            "Rounding changed which primitive comes first: without it primitive 0 is hit at 6.635315565288782e-05, and "
            "primitive 1 is hit at 9.99264"));
    CHECK(has(text, "The larger error is that of primitive 0, which the command above explains."));
    CHECK_FALSE(has(text, "The decision is the same without rounding"));
}

TEST_CASE("explain: a deliberate step to the next number is not blamed as a rounding") {
    const std::string what = "explain instance-far.sphere --pixel 96,96 -i sphere.unified@pbrt";
    const std::string text = run(what).out;
    CHECK(has(text,
              "No rounding is to blame: the form goes to the next number on purpose, in next_up(1). That step of 1 "
              "ulp accounts for 11000 ulp in t, 91 % of the error."));
    CHECK_FALSE(has(text, "rounding of 1 ulp"));
    CHECK(has(text, "  on purpose\n"));
}

TEST_CASE("explain: operations that only choose a branch are on the way to the answer") {
    // The box is entered through y: the entries through x and z were compared with it.
    const std::string text = run("explain box-one --pixel 128,100 -i box.signs --verbose").out;
    for (const char* const name : {"dmin ", "dmin2 ", "dmin3 "}) {
        INFO(name);
        CHECK(has(text, std::string("\n  ") + name));
    }
    CHECK_FALSE(has(text, "\n- dmin"));
}

TEST_CASE("explain compares the other ray generators and says which problem the envelope belongs to") {
    const std::string what = "explain camera-far.gl --pixel 14,20 --size 48x48 -i sphere.unified@ray-three";
    const std::string text = run(what).out;
    CHECK(has(text, "half an ulp in each number of the ideal ray and of the primitive would cost"));
    CHECK(has(text, "Better on this ray and around it: sphere.unified@ray-"));
    CHECK(has(text, " pixels around it, sphere.unified@ray-three loses "));
    CHECK_FALSE(has(text, "No other form that was tried does better"));
    const std::string placed = run("explain instance-far.sphere --pixel 96,96 -i sphere.unified@plain").out;
    CHECK(has(placed, "half an ulp in each number of ray, primitive and matrix as the world stores them would cost"));
    CHECK(has(placed,
              "transform and form lose no more. The inputs are exact: wider arithmetic on them helps. Other forms do "
              "better (see below)."));
    CHECK(has(placed, "sphere.unified@relative (0.4 bits lost"));
}

}  // namespace test_explain_verdict
