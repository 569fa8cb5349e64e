// Functions and contracts read from GLSL files.
#include <ctime>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <string>

#include "catch.hpp"
#include "intersect/shader/kernel.hpp"
#include "intersect/shader/source.hpp"
#include "number/error.hpp"
#include "scratch.hpp"

namespace test_source {

using namespace lostbits;
using namespace lostbits::intersect;
using namespace lostbits::intersect::shader;

namespace {

/// A file that is removed after the test.
class File {
public:
    explicit File(const std::string& text, const std::string& name = "mine.glsl") : file_(name, text) {}
    [[nodiscard]] std::string path() const { return file_.path().string(); }

private:
    lostbits::test::ScratchFile file_;
};

std::string join_arguments(const Signature& signature) {
    std::string all;
    for (const std::string& a : signature.arguments) all += (all.empty() ? "" : " ") + a;
    return all;
}

std::string find_refusal(const std::string& text, const std::string& words = "",
                         const std::string& name = "mine.glsl") {
    const File file(text, name);
    try {
        const ShaderSource taken = read_shader(file.path() + words);
        return "taken: " + taken.contract.title;
    } catch (const InputError& error) {
        return error.what();
    }
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("shader: functions in the style of shader sites are recognised by their types", "[shader]") {
    struct KnownShader {
        std::string function, arguments;
        Shape shape;
        Roots roots;
        Direction direction;
    };
    const std::string sphere = "vec4(lb_centre, lb_primitive[3])";
    for (const KnownShader& k : std::initializer_list<KnownShader>{
             {"vec2 f(vec3 ro, vec3 rd, vec4 s)", "lb_origin lb_direction " + sphere, Shape::sphere, Roots::both,
              Direction::unit},
             {"float f(in vec4 s, in vec3 ro, in vec3 rd)", sphere + " lb_origin lb_direction", Shape::sphere,
              Roots::near_only, Direction::unit},
             {"float f(vec3 ro, vec3 rd, vec3 center, float radius)",
              "lb_origin lb_direction lb_centre lb_primitive[3]", Shape::sphere, Roots::near_only, Direction::unit},
             {"float f(vec3 c, float r, vec3 o, vec3 d)", "lb_centre lb_primitive[3] lb_origin lb_direction",
              Shape::sphere, Roots::near_only, Direction::unit},
             {"float f(vec3 rd, vec3 ro, vec4 s)", "lb_direction lb_origin " + sphere, Shape::sphere, Roots::near_only,
              Direction::unit},
             {"bool f(vec3 a, vec3 b, vec4 s)", "lb_origin lb_direction " + sphere, Shape::sphere, Roots::none,
              Direction::unit},
             {"bool f(vec3 ro, vec3 rd, vec4 s, out float t, out vec3 n)",
              "lb_origin lb_direction " + sphere + " lb_out_3 lb_out_4", Shape::sphere, Roots::near_only,
              Direction::unit},
             {"vec2 f(vec3 ro, vec3 rd, vec3 lo, vec3 hi)", "lb_origin lb_direction lb_lo lb_hi", Shape::box,
              Roots::both, Direction::any},
             {"bool f(vec3 bmin, vec3 bmax, vec3 orig, vec3 invDir, float tmax, out float tn, out float tf)",
              "lb_lo lb_hi lb_origin (1.0 / lb_direction) lb_tmax lb_out_5 lb_out_6", Shape::box, Roots::both,
              Direction::any},
             {"dvec2 f(dvec3 ro, dvec3 rd, dvec4 s)", "lb_origin lb_direction dvec4(lb_centre, lb_primitive[3])",
              Shape::sphere, Roots::both, Direction::unit},
             {"float map(vec3 p)", "lb_point", Shape::sphere, Roots::near_only, Direction::unit},
             {"float sdScene(vec3 p, vec4 s)", "lb_point " + sphere, Shape::sphere, Roots::near_only, Direction::unit},
             {"float march(vec3 ro, vec3 rd)", "lb_origin lb_direction", Shape::sphere, Roots::near_only,
              Direction::unit}}) {
        const File file("// nothing else\n" + k.function + " { return 0; }\n");
        const ShaderSource shader = read_shader(file.path());
        INFO(k.function);
        CHECK(join_arguments(shader.signature) == k.arguments);
        CHECK(shader.contract.shape == k.shape);
        CHECK(shader.contract.roots == k.roots);
        CHECK(shader.contract.direction == k.direction);
        CHECK(shader.signature.function.line == 2);
        CHECK(shader.contract.name == "shader.mine");
        CHECK(shader.f32 == (k.function[0] != 'd'));
        CHECK(shader.f64 == (k.function[0] == 'd'));
    }
}

TEST_CASE("shader: parameters for primitives of every shape and for ranges are recognised in any order", "[shader]") {
    for (const ShapeRow& row : shape_rows) {
        std::string parameters, arguments;
        for_each_key(row.shape, [&](const Key& key, std::size_t k) {
            const bool one = key.count() == 1;
            parameters += (one ? "float " : "vec3 ") + std::string(key.name) + ", ";
            arguments += one ? "lb_primitive[" + std::to_string(k) + "] " : "lb_" + std::string(key.name) + " ";
        });
        INFO(row.name);
        for (const bool last : {false, true}) {
            const std::string ray = "vec3 ro, vec3 rd, ", of_ray = "lb_origin lb_direction ";
            const File file("float f(" + (last ? parameters + ray : ray + parameters) + "float tmin, float tmax)" +
                            " { return 0.0; } // lostbits: roots=first flags=range");
            const ShaderSource shader = read_shader(file.path());
            CHECK(shader.signature.shape == row.shape);
            CHECK(join_arguments(shader.signature) ==
                  (last ? arguments + of_ray : of_ray + arguments) + "lb_tmin lb_tmax");
            CHECK(shader.contract.flags == (LB_RANGE | LB_ONE_THREAD));
        }
    }
}

TEST_CASE("shader: helpers, prototypes, calls and comments are not mistaken for the function", "[shader]") {
    const File file(R"(
/* float no(vec3 ro, vec3 rd, vec4 s) { return 1.0; } */
float yes(vec3 ro, vec3 rd, vec4 s);
#define N 3
float map(vec3 p) { return 1.0; }
float noise(vec3 p) { return map(p); }
void mainImage(out vec4 c, in vec2 p) { c = vec4(yes(vec3(0), vec3(1), vec4(1))); }
float yes(vec3 ro, vec3 rd, vec4 s) { if (ro.x > 0.0) { return -1.0; } return map(ro); }
)");
    const ShaderSource shader = read_shader(file.path());
    CHECK(shader.signature.function.name == "yes");
    CHECK(shader.signature.function.line == 8);
    CHECK(read_shader(file.path() + ":map").contract.name == "shader.map");
    CHECK(read_shader(file.path() + ":noise").signature.kind == Signature::Kind::field);
}

TEST_CASE("shader: comments and command-line options set the contract", "[shader]") {
    const File file(R"(// lostbits: roots=first touching=miss miss=1e20
/* lostbits: title="two words" format=both
   lostbits: flags=one_thread */
float f(vec3 ro, vec3 rd, vec4 s) { return 1.0; }
)");
    const ShaderSource shader = read_shader(file.path());
    CHECK(shader.contract.roots == Roots::first_only);
    CHECK(shader.contract.touching == Touching::miss);
    CHECK(shader.contract.title == "two words");
    CHECK((shader.f32 && shader.f64));
    CHECK(shader.miss_sentinel.kind == MissSentinel::Kind::above);
    CHECK(shader.miss_sentinel.bound == 1e20);
    const ShaderSource other = read_shader(file.path() + ":roots=near,touching=hit,format=f64");
    CHECK(other.contract.roots == Roots::near_only);
    CHECK(other.contract.touching == Touching::hit);
    CHECK_FALSE(other.f32);
}

TEST_CASE("shader: errors are reported with their place", "[shader]") {
    const std::string f = "float f(vec3 ro, vec3 rd, vec4 s) { return 1.0; }\n";
    CHECK(has(find_refusal("// x\n  // lostbits: roots=some\n" + f),
              "mine.glsl:2:6: roots is \"some\"; it must be one of both"));
    CHECK(has(find_refusal("/* a\nlostbits: colour=red */" + f), "mine.glsl:2:1: unknown key \"colour\""));
    CHECK(has(find_refusal(f, ":g"), "no function \"g\" in "));
    CHECK(has(find_refusal(f, ":miss=sometimes"), "miss is \"sometimes\"; it must be negative"));
    CHECK(has(find_refusal(f + "vec2 g(vec3 ro, vec3 rd, vec4 s) { return vec2(1); }"),
              "several functions have the types"));
    CHECK(has(find_refusal("// nothing\n"), "mine.glsl: contains no function; write one, such as float f(vec3 ro"));
    CHECK(has(find_refusal("float noise(vec3 p) { return 1.0; }"), "no function has the types of an intersector"));
    CHECK(has(find_refusal("float noise(vec3 p) { return 1.0; }"),
              "\n  float map(vec3 p)\nThe functions of the file are:\n"));
    CHECK(
        has(find_refusal("float noise(float x) { return x; }", "", "mine.c"), "for C, C++ or Rust write --function "));
    CHECK(has(find_refusal("float g(vec2 p) { return 1.0; }", ":g"),
              "mine.glsl:1:7: `float g(vec2 p)` does not have the types"));
    CHECK(has(find_refusal("float march(vec3 ro, vec3 rd[2], vec4 s) { return 1.0; }"), "no function has the types"));
    CHECK(has(find_refusal("float map(vec3 p) { return 1.0; } // lostbits: hit_eps=-1"),
              "hit_eps is \"-1\"; it must be a number"));
    CHECK(has(find_refusal(f, ":roots=none,flags=clipped"), "clipped describes an interval, so it needs roots = both"));
    const std::string range = ":roots=first,flags=range", told = "mine.glsl:1:7: flags=range is given, but `float ";
    CHECK(has(find_refusal(f, range),
              told + "f(vec3 ro, vec3 rd, vec4 s)` has no parameters for where rays begin and end; add"));
    CHECK(has(find_refusal("float f(vec3 ro, vec3 rd, vec4 s, float tmax) { return 1.0; }", range),
              "has no parameters for where rays"));
    CHECK(has(find_refusal("float f(vec3 ro, vec3 rd, vec4 s, float tmin) { return 1.0; }", range),
              "has no parameters for where rays"));
    CHECK(has(find_refusal("float map(vec3 p, float tmin, float tmax) { return 1.0; }", range),
              "` is a field: the loop"));
    CHECK_THROWS_AS(read_shader("no-such-file.glsl"), InputError);
    CHECK_THROWS_AS(read_shader(std::filesystem::temp_directory_path().string()), InputError);
}

TEST_CASE("shader: numbers mean a miss by the chosen convention", "[shader]") {
    using Kind = MissSentinel::Kind;
    const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(MissSentinel{Kind::negative}.means_miss(-1, -1));
    CHECK_FALSE(MissSentinel{Kind::negative}.means_miss(-1, 1));  // from inside
    CHECK_FALSE(MissSentinel{Kind::negative}.means_miss(0, 0));
    CHECK_FALSE(MissSentinel{Kind::negative}.means_miss(nan, nan));  // an answer, if a bad one
    // A slab test that returns its two numbers unchanged reports a miss by their order.
    const File slabs("vec2 f(vec3 ro, vec3 rd, vec3 lo, vec3 hi) { return vec2(2, 1); }");
    CHECK(read_shader(slabs.path()).miss_sentinel.kind == Kind::crossed);
    CHECK(MissSentinel{Kind::crossed}.means_miss(2, 1));
    CHECK(MissSentinel{Kind::crossed}.means_miss(-2, -1));
    CHECK_FALSE(MissSentinel{Kind::crossed}.means_miss(1, 1));
    CHECK(MissSentinel{Kind::zero}.means_miss(0, 0));
    CHECK(MissSentinel{Kind::infinite}.means_miss(infinity, infinity));
    CHECK(MissSentinel{Kind::above, 1e20}.means_miss(1e20, 1e20));
    CHECK_FALSE(MissSentinel{Kind::above, 1e20}.means_miss(9e19, 9e19));
}

TEST_CASE("shader: loops are found together with their bounds", "[shader]") {
    const File file(R"(#define STEPS 100000
const int FEW = 5;
float f(vec3 ro, vec3 rd, vec4 s) {
    for (int i = 0; i < STEPS; ++i) ro.x += 1.0;
    for (int i = 2; i < FEW + 1; ++i) {
        for (int i = 70; i > 0; --i) ro.x += 1.0;
        ro.y = 1.0;
    }
    for (int i = 0; i < 3; ++i) for (int k = 0; k < 4; ++k) ro.x += 1.0;
    for (float x = 0.0; x < 1.0; x += 0.5) ro.x += 1.0;
    while (true) ro.x += 1.0;
    return ro.x;
}
)");
    const auto loops = read_shader(file.path()).loops;
    REQUIRE(loops.size() == 6);
    const auto is = [&loops](std::size_t i, std::size_t line, long long most, long long together) {
        return loops[i].line == line && loops[i].max_iterations == most && loops[i].max_nested_iterations == together;
    };
    CHECK(is(0, 4, 100000, 100000));
    CHECK(is(1, 5, 5, 5));
    CHECK(is(2, 6, 70, 350));
    CHECK(is(3, 9, 3, 3));
    CHECK(is(4, 9, 4, 12));
    CHECK(is(5, 11, CountedLoop::endless, CountedLoop::endless));
}

TEST_CASE("shader: nested loops are counted up to a limit", "[shader]") {
    std::string text = "float f(vec3 ro, vec3 rd, vec4 s) {\n";
    for (int i = 0; i < 40; ++i) text += "for (int i = 0; i < 1000000000; ++i) ";
    const File file(text + "ro.x += 1.0;\nreturn ro.x;\n}\n");
    const auto loops = read_shader(file.path()).loops;
    REQUIRE(loops.size() == 40);
    CHECK(loops[0].max_nested_iterations == 1'000'000'000);
    for (std::size_t i = 1; i < loops.size(); ++i) CHECK(loops[i].max_nested_iterations == 1'000'000'000'000);
}

TEST_CASE("shader: a megabyte of any text is read at once", "[shader]") {
    const auto many = [](const std::string& part) {
        std::string text;
        while (text.size() < 1'000'000) text += part;
        return text;
    };
    const std::string hit = "float hit(vec3 ro, vec3 rd, vec4 s) { return 1.0; }\n";
    for (const char* part : {"for a ", "for(", "for(;3;){", "for(;3;)", "float a(", "/*lostbits:*/ ", "uniform int a;",
                             "# version ", "{ ( ", "float a() {}\n"}) {
        INFO(part);
        const File file(hit + many(part) + "\n");
        const std::clock_t begin = std::clock();
        const ShaderSource shader = read_shader(file.path() + ":hit");
        CHECK(write_program_text(shader, 32, 450).size() > 1'000'000);
        CHECK((std::clock() - begin) / CLOCKS_PER_SEC < 20);
    }
    for (const char* part : {"lostbits:", "lostbits: ", "lostbits: a\n"}) {
        INFO(part);
        const std::clock_t begin = std::clock();
        const std::string said = find_refusal(hit + "/*" + many(part) + "*/");
        CHECK(said.size() < 10'000);
        CHECK((std::clock() - begin) / CLOCKS_PER_SEC < 20);
    }
    const std::string said = find_refusal(many("float a() {}\n"));
    CHECK(has(said, "and 76894 more"));
    CHECK(said.size() < 10'000);
}

}  // namespace test_source
