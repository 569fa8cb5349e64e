// Functions of C, C++ and Rust as they are: the operations that were read give the bits of the compiled function, and
// code that cannot be followed is refused with its place.
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"
#include "intersect/external/plugin.hpp"
#include "intersect/function/walk.hpp"
#include "random_functions.hpp"
#include "user_functions.hpp"

namespace test_functions {

using namespace lostbits;
using namespace lostbits::test;
namespace table = lostbits::intersect::table;

namespace {

const std::string& folder = functions_folder;

bool has_rustc() { return std::system("rustc --version >/dev/null 2>&1") == 0; }

}  // namespace

TEST_CASE("functions: the operations give the bits of the compiled function", "[external]") {
    struct Case {
        const char *named, *says;
    };
    int in_both = 0;
    for (const auto& [named, says] :
         {Case{"sphere.c:hit_sphere", "sphere: origin = o, direction = d, centre = c, radius = r"},
          Case{"sphere.c:schoolbook", "hit where t is not negative"},
          Case{"sphere.c:precise", "hit where t is not infinite"},
          Case{"sphere.c:mixed_sphere", "hit where t is a number"},
          Case{"sphere.cpp:scene::Sphere::intersect",
               "centre = this.center, radius = this.radius, origin = ray.origin"},
          Case{"sphere.cpp:scene::intersect_sphere", "hit where its hit is not 0, t = its t"},
          Case{"box.c:hit_box", "lo = b.bounds[0], hi = b.bounds[1]"}, Case{"box.c:slabs", "1/direction = inv_dir"},
          Case{"triangle.cpp:hit_triangle", "triangle: origin = orig, direction = dir, a = v0, b = v1, c = v2"},
          Case{"sphere.rs:hit_sphere", "hit where the result has a value"}, Case{"sphere.rs:hit_box", "far = its __1"},
          Case{"public.c:ray_triangle", "c = v2; hit where the result is not 0, t = d"},
          Case{"public.c:HitBoundingBox",
               "lo = minB, hi = maxB, origin = origin, direction = dir; hit where the result"},
          Case{"public.cpp:sphere_ray_intersect",
               "origin = orig, direction = dir; hit where the result is not 0, t = t0"},
          Case{"public.cpp:sphere::hit",
               "tmin = ray_t.min, tmax = ray_t.max; hit where the result is not 0, t = rec.t"},
          Case{"public.rs:Sphere::intersect", "hit where the result has a value, t = the result"},
          Case{"public.rs:intersects_triangle", "c = c; t = its distance; hit where t is not infinite"},
          Case{"public.rs:intersection_slice_for_aabb", "1/direction = inv_direction, lo = aabb.min, hi = aabb.max"}}) {
        CAPTURE(named);
        if (std::string(named).find(".rs:") != std::string::npos && !has_rustc()) continue;
        const auto f = intersect::function::load_function(folder + named, {});
        CHECK(f->signature_text.find(says) != std::string::npos);
        CHECK(count_differences(*f) == 0);
        if (!std::string(named).starts_with("public")) continue;
        in_both += agrees_in_other_format(folder + named, f->bits) ? 1 : 0;
    }
    CHECK(in_both >= (has_rustc() ? 4 : 3));
}

TEST_CASE("functions: whole numbers beside a number have the bits of the C library", "[external]") {
    const Scratch made;
    for (const char* const f : {"floor", "ceil", "trunc", "round", "rint"}) {
        CAPTURE(f);
        const std::string own = f;
        const std::string file = made.write(
            "whole.c",
            "#include <math.h>\nfloat in_float(const float o[3], const float d[3], const float c[3], float r) {\n"
            "    return " +
                own + "f(o[0] * 4) + d[1] * " + own + "f(c[0] * 2e3f) + " + own +
                "f(r * 1e30f);\n}\n"
                "double in_double(const double o[3], const double d[3], const double c[3], double r) {\n    return " +
                own + "(o[0] * 4) + " + own + "(d[1] * 0.5) * " + own + "(c[0] * 1e9) + r;\n}\n");
        for (const char* const name : {":in_float", ":in_double"}) {
            const auto g = intersect::function::load_function(file + name + ":sphere(o, d, c, r)", {});
            CHECK(count_differences(*g) == 0);
        }
    }
}

TEST_CASE("functions: the same operations as a form of the catalogue have its answers", "[external]") {
    const auto f = intersect::function::load_function(folder + "sphere.c:schoolbook", {});
    for (const auto& row : intersect::table::catalogue())
        if (row.info->name == "sphere.schoolbook")
            CHECK(count_differences(f->intersector.native32, row.native32, Shape::sphere) == 0);
}

TEST_CASE("functions: the culprit is a line of the user's file", "[external]") {
    const Outcome said =
        must("explain rtg-fig-7-3-4100-oblique --pixel 128,128 -f f32 -i function.schoolbook --function " + folder +
             "sphere.c:schoolbook");
    CHECK(said.out.find("sphere.c:34:55") != std::string::npos);
    CHECK(said.out.find(" 34 |     float c = v[0] * v[0]") != std::string::npos);
    CHECK(said.out.find("~^~") != std::string::npos);
    const Outcome method =
        must("explain rtg-fig-7-3-4100-oblique --pixel 128,128 -f f32 -i function.sphere.hit --function " + folder +
             "public.cpp:sphere::hit");
    CHECK(method.out.find("public.cpp:59:26\n 59 |         auto c = oc * oc - radius * radius;") != std::string::npos);
    const Scratch made;
    must(
        "map near-benign --size 8x8 -f f32 -f f64 -f fp16 --bits 12 --metric culprit -o out -i function.hit_sphere "
        "--function " +
            folder + "sphere.c:hit_sphere",
        made.path());
}

TEST_CASE("functions: constants in double keep their values in both formats", "[external]") {
    const Scratch made;
    const std::string file = made.write("wide.c", R"(
float wide(const float o[3], const float d[3], const float c[3], float r) { return 0.1 * o[2] + 3.7 * r; }
)");
    const auto f = intersect::function::load_function(file + ":wide:sphere(o, d, c, r)", {});
    const std::vector<Primitive<double>> sphere{Primitive<double>(Sphere<double>{{0, 0, 0}, 1})};
    const std::vector<double> zero{0}, five{5}, down{-1};
    std::array<std::vector<double>, 3> t{std::vector<double>(1), std::vector<double>(1), std::vector<double>(1)};
    std::vector<std::uint8_t> hit(1);
    f->intersector.native64({zero, zero, five, zero, zero, down}, intersect::Target<double>(std::span(sphere)),
                            {t[0], t[1], t[2], hit});
    CHECK(hit[0] == 1);
    CHECK(t[0][0] == 0.1 * 5.0 + 3.7 * 1.0);
}

TEST_CASE("functions: rounding in a narrow format is not taken for a broken contract", "[external]") {
    const Scratch made;
    const Outcome said = must("map near-benign --size 16x16 -f bf16 -f fp16 -i function.schoolbook -o out --function " +
                                  folder + "sphere.c:schoolbook",
                              made.path());
    CHECK(said.out.find("function.schoolbook          bf16") != std::string::npos);
    CHECK(said.err.find("wrong on") == std::string::npos);
}

TEST_CASE("functions: each member of a struct has its own meaning and place", "[external]") {
    const Scratch made;
    const std::string body = R"({
    float x = o[0] - s.c[0], y = o[1] - s.c[1], z = o[2] - s.c[2];
    float b = x * d[0] + y * d[1] + z * d[2], disc = b * b - (x * x + y * y + z * z - s.r * s.r);
    return disc < 0 ? -1 : -b - sqrtf(disc);
})";
    for (const char* const members : {"float r; float c[3];", "float c[3]; float r;", "float c[3]; int id; float r;"}) {
        CAPTURE(members);
        const std::string file =
            made.write("struct.c", std::string("#include <math.h>\nstruct sphere { ") + members +
                                       " };\nfloat hit(const float o[3], const float d[3], struct sphere s) " + body);
        const auto f = intersect::function::load_function(file + ":hit", {});
        CHECK(f->signature_text.find("centre = s.c") != std::string::npos);
        CHECK(f->signature_text.find("radius = s.r") != std::string::npos);
        const Outcome map =
            must("map near-benign --size 16x16 -f f32 -i function.hit -o out --force --function " + file + ":hit",
                 made.path());
        CHECK(map.out.find(
                  "function.hit                 f32        157                0          0           0      0") !=
              std::string::npos);
    }
}

TEST_CASE("functions: x, y and z may be three arguments", "[external]") {
    const Scratch made;
    const std::string path = (made.path() / "components.c").string();
    const auto write = [&](const std::string& comment, const std::string& arguments, const std::string& assignments) {
        made.write("components.c", "#include <math.h>\n" + comment + "\nfloat hit(" + arguments + ") {\n" +
                                       assignments +
                                       R"(
    float x = ox - cx, y = oy - cy, z = oz - cz, a = dx * dx + dy * dy + dz * dz;
    float b = x * dx + y * dy + z * dz, disc = b * b - a * (x * x + y * y + z * z - r * r);
    return disc < 0 ? -1 : (-b - sqrtf(disc)) / a;
})");
        return path + ":hit";
    };
    const std::string named =
                          "float ox, float oy, float oz, float dx, float dy, float dz, float cx, float cy, float cz, "
                          "float r",
                      unnamed =
                          "float p, float q, float s, float u, float v, float w, float k, float l, float m, float r",
                      assignments = "float ox = p, oy = q, oz = s, dx = u, dy = v, dz = w, cx = k, cy = l, cz = m;",
                      mixed =
                          "float r, float ox, float dx, float cx, float oy, float dy, float cy, float oz, float dz, "
                          "float cz";

    // By the names ox, oy, oz; by a comment with the vectors; by a comment with their components in any order.
    for (const auto& [comment, arguments, says] :
         {std::tuple{"", named, "origin = (ox, oy, oz), direction = (dx, dy, dz), centre = (cx, cy, cz), radius = r"},
          std::tuple{"// lostbits: sphere(o, d, c, r)", named, "origin = (ox, oy, oz)"},
          std::tuple{"// lostbits: sphere(o, d, c, r)", unnamed, "direction = (u, v, w), centre = (k, l, m)"},
          std::tuple{"// lostbits: sphere(r, o.x, d.x, c.x, o.y, d.y, c.y, o.z, d.z, centre.z)", mixed,
                     "radius = r, origin.x = ox, direction.x = dx, centre.x = cx, origin.y = oy"}}) {
        CAPTURE(comment, arguments);
        const std::string function = write(comment, arguments, arguments == unnamed ? assignments : "");
        const auto f = intersect::function::load_function(function, {});
        CHECK(HasText(f->signature_text, says));
        CHECK(count_differences(*f) == 0);
        const Outcome map = must(
            "map near-benign --size 16x16 -f f32 -i function.hit -o out --force --function " + function, made.path());
        CHECK(HasText(map.out,
                      "function.hit                 f32        157                0          0           0      0"));
    }

    // Each number needs a meaning, and each meaning has one place.
    const auto refusal = [&](const std::string& comment, const std::string& arguments) {
        return find_refusal(write("// lostbits: " + comment, arguments, arguments == unnamed ? assignments : ""));
    };
    CHECK(HasText(refusal("sphere(o, d, c)", named), "components.c:2:4: names 3 arguments, and none for r; name each"));
    CHECK(HasText(refusal("sphere(o, o, o, d, d, d, c, c, c, r)", named),
                  "\"o\" is named twice; a vector is named once"));
    CHECK(HasText(refusal("sphere(o, d, c, 1/d)", named), "\"1/d\" is a vector, but r is a number, and not the first"));
    CHECK(HasText(refusal("sphere(r, o.x, d.x, c.x, o.y, d.y, c.y, o.z, d.z, -)", mixed),
                  "cx is a component of a vector, and the vector has no other ones; name all of x, y and z"));
    CHECK(HasText(refusal("sphere(o, d, c, r, r.x)", named), "names \"r.x\", but the function takes only 4 vectors"));
}

TEST_CASE("functions: the underline fits lines with letters of several bytes", "[external]") {
    const Scratch made;
    const std::string file = made.write("letters.c", R"(#include <math.h>
float hit(const float o[3], const float d[3], const float c[3], float r) {
    float x = o[0] - c[0], y = o[1] - c[1], z = o[2] - c[2], b = x * d[0] + y * d[1] + z * d[2];
    /* ∑éé */ float disc = b * b - (x * x + y * y + z * z - r * r);
    return disc < 0 ? -1 : -b - sqrtf(disc);
}
)");
    const Outcome said =
        must("explain rtg-fig-7-3-4100-oblique --pixel 128,128 -f f32 -i function.hit --function " + file + ":hit");
    CHECK(said.out.find(" 4 |     /* ∑éé */ float disc = b * b - (x * x + y * y + z * z - r * r);\n"
                        "   |                                     ~~~~~~~~~~~~~~~~~~~~~~^~~~~~~\n") !=
          std::string::npos);
}

TEST_CASE("functions: plugin check, choose, diff and claims take them", "[external]") {
    const Scratch made;
    const std::string schoolbook = " --function " + folder + "sphere.c:schoolbook ";
    CHECK(must("plugin check" + schoolbook).out.find("function.schoolbook in binary32, a sphere:") !=
          std::string::npos);
    CHECK(must("choose near-benign --size 8x8 --bits 8 -f f32 -i function.schoolbook" + schoolbook, made.path())
              .out.find("The cheapest is function.schoolbook in f32") != std::string::npos);
    must("map near-benign --size 8x8 -f f32 -o out -i function.schoolbook -i sphere.schoolbook" + schoolbook,
         made.path());
    CHECK(must("diff out -i function.schoolbook -i sphere.schoolbook", made.path()).out.find("same") !=
          std::string::npos);
    std::ofstream(made.path() / "mine.toml")
        << "schema = \"lostbits-claims/1\"\nprofile = \"libraries\"\n[[claim]]\nid = \"mine.decides\"\nstatement = "
           "\"Mine decides correctly\"\nsource = \"-\"\nverdict = \"holds\"\n[claim.given]\nscene = "
           "\"near-benign\"\nform = \"function.schoolbook\"\nformat = \"f32\"\n[claim.expect]\nmetric = "
           "\"false_hit_fraction\"\nin = [0, 0]\ncriterion = \"= 0\"\n";
    CHECK(must("check mine.toml --profile libraries" + schoolbook, made.path()).out.find("1 verdict confirmed") !=
          std::string::npos);
}

TEST_CASE("functions: what cannot be followed is refused with its place", "[external]") {
    CHECK(find_refusal(folder + "refused.c:sine").find("refused.c:4:78: it calls sin") != std::string::npos);
    CHECK(find_refusal(folder + "refused.c:endless").find("refused.c:8:5: a loop has no bound") != std::string::npos);
    CHECK(find_refusal(folder + "refused.c:rounded").find("refused.c:12:88: a number becomes an integer") !=
          std::string::npos);
    CHECK(find_refusal(folder + "refused.c:counting").find("refused.c:16:11: a global variable is written") !=
          std::string::npos);
    CHECK(find_refusal(folder + "refused.c:calls").find("cannot compile it") != std::string::npos);
    CHECK(find_refusal(folder + "refused.c:nothing")
              .ends_with("refused.c: has no function \"nothing\"; it defines \"counting\", \"endless\", \"rounded\", "
                         "\"sine\""));
    CHECK(find_refusal(folder + "sphere.c").find("names no function") != std::string::npos);
    CHECK(find_refusal(folder + "nowhere.c:f").find("no such file") != std::string::npos);
}

TEST_CASE("functions: LLVM IR as text and as bitcode, with and without debug information", "[external]") {
    const Scratch made;
    const auto shell = [](const std::string& command) { REQUIRE(std::system(command.c_str()) == 0); };
    const std::string to = made.path().string() + "/";
    shell("clang -O1 -g -S -emit-llvm -o " + to + "with.ll " + folder + "sphere.c");
    shell("clang++ -std=gnu++20 -O0 -g -S -emit-llvm -o " + to + "cpp.ll " + folder + "sphere.cpp");
    shell("clang -O1 -S -emit-llvm -fno-discard-value-names -o " + to + "none.ll " + folder + "sphere.c");
    shell("clang -O0 -c -emit-llvm -o " + to + "none.bc " + folder + "sphere.c");
    struct Case {
        const char *named, *says;
    };
    for (const auto& [named, says] :
         {Case{"with.ll:hit_sphere",
               "origin = o, direction = d, centre = c, radius = r; hit where the result is not 0"},
          Case{"with.ll:schoolbook", "hit where t is not negative"},
          Case{"cpp.ll:scene::intersect_sphere", "direction = ray.direction, tmin = ray.tmin, tmax = ray.tmax"},
          Case{"none.ll:schoolbook", "centre = centre, radius = radius"},
          Case{"none.bc:precise", "origin = p0, direction = p1, centre = p2, radius = p3"}}) {
        CAPTURE(named);
        const auto f = intersect::function::load_function(to + named, {});
        CHECK(f->signature_text.find(says) != std::string::npos);
        CHECK(count_differences(*f) == 0);
    }
    const auto culprit = [&](const std::string& file) {
        return must("explain rtg-fig-7-3-4100-oblique --pixel 128,128 -f f32 -i function.schoolbook --function " + to +
                    file + ":schoolbook")
            .out;
    };
    CHECK(culprit("with.ll").find("sphere.c:34:55\n 34 |     float c = v[0] * v[0]") != std::string::npos);
    const std::string line = culprit("none.ll");
    CHECK(line.find("none.ll:") != std::string::npos);
    CHECK(line.find(" = call float @llvm.fmuladd.f32(") != std::string::npos);
    CHECK(find_refusal(to + "none.ll:hit_sphere").find("compile it with -g") != std::string::npos);
}

namespace {

struct RandomCounts {
    std::size_t functions = 0, refused = 0, differ = 0, hits = 0;
    std::string first;  ///< about the first one that is refused or differs
};

/// Numbers of random rays: ordinary ones, small whole numbers, zeros of both signs, and those at the ends of the
/// format.
template <class S>
std::vector<S> random_inputs(std::mt19937_64& random, std::size_t count) {
    constexpr S infinity = std::numeric_limits<S>::infinity(), tiny = std::numeric_limits<S>::denorm_min();
    const std::array<S, 10> edges{S(0),
                                  -S(0),
                                  infinity,
                                  -infinity,
                                  std::numeric_limits<S>::quiet_NaN(),
                                  std::numeric_limits<S>::max(),
                                  tiny,
                                  -tiny,
                                  S(1),
                                  std::numeric_limits<S>::min()};
    std::vector<S> all;
    for (std::size_t i = 0; i < count; ++i) {
        const auto plain = static_cast<S>(static_cast<double>(random() >> 11) * 0x1p-52 - 1);
        const std::uint64_t kind = random() % 16;
        if (kind == 0) all.push_back(edges[random() % edges.size()]);
        else if (kind < 4) all.push_back(static_cast<S>(static_cast<int>(random() % 7) - 3));
        else all.push_back(kind < 6 ? std::ldexp(plain, static_cast<int>(random() % 40) - 20) : 4 * plain);
    }
    return all;
}

/// Compiles a file of random functions once and compares each, on 100 rays, with its operations.
template <class S>
void compare_random(std::uint64_t seed, int count, RandomCounts& counts) {
    const Scratch made;
    const std::string name = made.path().string() + "/random", flags = " -w -ffp-contract=off -fno-math-errno ";
    std::ofstream(name + ".c") << RandomFunctions(seed, sizeof(S) == 8).file(count);
    REQUIRE(std::system(("clang -O0 -S -emit-llvm" + flags + "-o " + name + ".ll " + name + ".c").c_str()) == 0);
    REQUIRE(std::system(("clang -O2 -shared -fPIC" + flags + "-o " + name + ".so " + name + ".c -lm").c_str()) == 0);
    const auto library = intersect::external::load_library(name + ".so");
    intersect::function::Module module(contents(name + ".ll"));
    const auto fail = [&](int k, const std::string& words) {
        if (counts.first.empty())
            counts.first = "seed " + std::to_string(seed) + " function " + std::to_string(k) +
                           (sizeof(S) == 8 ? " in double: " : " in float: ") + words;
    };
    std::mt19937_64 random(seed);
    constexpr std::size_t rays = 100, inputs = RandomFunctions::inputs;
    for (int k = 0; k < count; ++k) {
        ++counts.functions;
        const std::string entry = "lostbits_entry_" + std::to_string(k);
        const auto compiled = intersect::external::find_symbol<void (*)(const S*, S*, int*)>(library, entry.c_str());
        REQUIRE(compiled != nullptr);
        std::shared_ptr<table::WrittenFormula> formula;
        try {
            intersect::function::Nodes nodes(8 * sizeof(S));
            const auto answer = intersect::function::Walk(module, nodes, made.path().string()).run(entry, inputs);
            formula = std::make_shared<table::WrittenFormula>(
                nodes.to_formula(answer.hit, answer.t, answer.t, answer.t).formula);
        } catch (const InputError& error) {
            ++counts.refused;
            fail(k, error.what());
            continue;
        }
        formula->name = entry, formula->shape = Shape::sphere;
        table::require_valid(*formula);
        table::WrittenForm form(formula, formula);
        const table::Intersector* some = nullptr;
        for (const auto& row : table::catalogue())
            if (row.info->name == "sphere.schoolbook") some = &row;
        const table::Intersector row = form.make_intersector(*some->info);
        const std::vector<S> numbers = random_inputs<S>(random, rays * inputs);
        std::vector<Primitive<S>> primitives(rays, Primitive<S>(Shape::sphere));
        std::array<std::vector<S>, 6> columns;
        for (std::size_t i = 0; i < rays; ++i) {
            const S* const in = &numbers[inputs * i];
            for (std::size_t c = 0; c < 6; ++c) columns[c].push_back(in[c]);
            std::copy_n(in + 6, 4, primitives[i].numbers.begin());
        }
        const table::RayBatch<S> batch{columns[0], columns[1], columns[2], columns[3], columns[4], columns[5]};
        std::array<std::vector<S>, 3> t;
        for (auto& column : t) column.resize(rays);
        std::vector<std::uint8_t> hits(rays);
        const auto& kernel = [&]() -> const table::Kernel<S>& {
            if constexpr (sizeof(S) == 4) return row.native32;
            else return row.native64;
        }();
        kernel(batch, intersect::Target<S>(std::span<const Primitive<S>>(primitives)), {t[0], t[1], t[2], hits});
        for (std::size_t i = 0; i < rays; ++i) {
            S out[2] = {};
            int hit = 0;
            compiled(&numbers[inputs * i], out, &hit);
            counts.hits += hit != 0;
            const bool same =
                std::memcmp(&out[0], &t[0][i], sizeof(S)) == 0 || (std::isnan(out[0]) && std::isnan(t[0][i]));
            if ((hit != 0) == (hits[i] != 0) && (hit == 0 || same)) continue;
            ++counts.differ;
            std::ostringstream words;
            words << std::hexfloat << "compiled " << hit << " " << out[0] << ", read " << int(hits[i]) << " " << t[0][i]
                  << " of";
            for (std::size_t c = 0; c < inputs; ++c) words << " " << numbers[inputs * i + c];
            fail(k, words.str());
            break;
        }
    }
}

}  // namespace

TEST_CASE("functions: random functions have the bits of the compiled ones", "[external]") {
    RandomCounts counts;
    // LOSTBITS_FILES=1250 makes 100,000 functions, which take an hour of one core; LOSTBITS_FIRST_FILE=626 begins
    // there.
    const auto given = [](const char* name, std::uint64_t usual) {
        const char* const text = std::getenv(name);
        return text ? std::strtoull(text, nullptr, 10) : usual;
    };
    const std::uint64_t files = given("LOSTBITS_FILES", is_long() ? 125 : 1);
    for (std::uint64_t seed = given("LOSTBITS_FIRST_FILE", 1); seed <= files; ++seed) {
        compare_random<float>(seed, 40, counts);
        compare_random<double>(seed, 40, counts);
    }
    CAPTURE(counts.functions, counts.hits, counts.first);
    CHECK(counts.refused == 0);
    CHECK(counts.differ == 0);
    CHECK(counts.hits > counts.functions * 20);
}

TEST_CASE("functions: damaged LLVM IR gives a sentence", "[external]") {
    const std::string whole = R"(%struct.v = type { [3 x float], <2 x float>, i8 }
@k = private constant [2 x float] [float 1.000000e+00, float 0x3FF8000000000000]
define void @lostbits_entry(float* %0, ptr %out, i32* noundef %hit) #0 !dbg !4 {
  %s = alloca %struct.v, align 4
  %a = load float, float* %0, align 4, !dbg !5
  %g = getelementptr inbounds %struct.v, ptr %s, i64 0, i32 0, i64 1
  store float %a, ptr %g, align 4
  %c = fcmp olt float %a, 0.000000e+00
  br i1 %c, label %left, label %right

left:                                             ; preds = %1
  %n = fneg float %a
  br label %end

right:
  %r = call float @llvm.sqrt.f32(float %a)
  switch i32 2, label %end [
    i32 1, label %left
    i32 3, label %left
  ]

end:
  %p = phi float [ %n, %left ], [ %r, %right ]
  %q = load float, ptr getelementptr inbounds ([2 x float], ptr @k, i64 0, i64 1), align 4
  %m = fmul float %p, %q
  store float %m, ptr %out, align 4
  store i32 1, i32* %hit, align 4
  ret void
}
!4 = distinct !DISubprogram(name: "f", scope: !6, file: !6, line: 1)
!5 = !DILocation(line: 2, column: 3, scope: !4)
!6 = !DIFile(filename: "f.c", directory: "/x")
)";
    const auto read = [](const std::string& text) {
        try {
            intersect::function::Module module(text);
            intersect::function::Nodes nodes(32);
            intersect::function::Walk walk(module, nodes, "/x");
            walk.run("lostbits_entry", 11);
            return true;
        } catch (const InputError&) {
            return false;
        }
    };
    REQUIRE(read(whole));
    for (std::size_t size = 0; size < whole.size(); size += 3) read(whole.substr(0, size));
    std::mt19937 random(3);
    for (int k = 0; k < 3000; ++k) read(damage(whole, random, "%@!0123456789 ()[]{}<>,*\"x", 9));
}

}  // namespace test_functions
