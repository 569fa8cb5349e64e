// The program around a function, and the messages of compilers about it.
#include <algorithm>
#include <string>

#include "catch.hpp"
#include "intersect/shader/compiler_log.hpp"
#include "intersect/shader/kernel.hpp"

namespace test_program_text {

using namespace lostbits::intersect::shader;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

ShaderSource shader_of(const std::string& text) {
    ShaderSource shader;
    shader.path = "a.glsl";
    shader.text = text;
    for (const Function& function : find_functions(code_tokens(split_into_tokens(text)))) {
        if (const auto s = read_signature(function)) shader.signature = *s;
    }
    return shader;
}

/// Between the two `#line`.
std::string users_part(const std::string& program) {
    const std::string first = "\n#line 1\n", second = "\n#line 1000001\n";
    const std::size_t begin = program.find(first) + first.size();
    return program.substr(begin, program.find(second) - begin);
}

}  // namespace

TEST_CASE("shader text: removing pixel code moves no line and no column", "[shader]") {
    const std::string text =
        "#version 300 es\n"
        "layout(location = 0) out vec4 color;\n"
        "in vec2 uv; uniform vec2 size;\n"
        "float f(in vec3 ro, in vec3 rd, in vec4 s) { return ro.x; }\n"
        "void main() { color = gl_FragCoord * f(vec3(iTime), vec3(0), vec4(0)); }\n";
    const std::string program = write_program_text(shader_of(text), 32, 430);
    CHECK(program.starts_with("#version 430\n"));
    CHECK(users_part(program) == std::string(15, ' ') + "\n" + std::string(25, ' ') +
                                     "vec4 color;\n"
                                     "   vec2 uv;         vec2 size = vec2(0);\n"
                                     "float f(in vec3 ro, in vec3 rd, in vec4 s) { return ro.x; }\n"
                                     "void lb_m() { color = lb_FragCoord * f(vec3(iTime), vec3(0), vec4(0)); }\n");
    CHECK(has(program, "#define iTime 0.0\n"));
    CHECK_FALSE(has(program, "iMouse"));
    CHECK(std::ranges::count(users_part(program), '\n') == std::ranges::count(text, '\n'));
}

TEST_CASE("shader text: a file in float is converted to double and back", "[shader]") {
    const std::string floats =
        "precision highp float;\n#define H 0.5f\nfloat f(vec3 a) { return a.x * 1e-3 + 2.0 + H; // 1.5\n}";
    const std::string doubles = "\n#define H 0.5LF\ndouble f(dvec3 a) { return a.x * 1e-3LF + 2.0LF + H; // 1.5\n}";
    const std::string made = convert_precision(floats, true);
    CHECK(made.substr(made.find("\n#define")) == doubles);
    CHECK_FALSE(has(made, "precision highp"));
    CHECK(has(convert_precision(doubles, false), "float f(vec3 a) { return a.x * 1e-3 + 2.0 + H; // 1.5"));
    CHECK(convert_precision("int a[3]; uint b = 0xEFu; x.f1;", true) == "int a[3]; uint b = 0xEFu; x.f1;");
}

TEST_CASE("shader text: compiler errors point to the user's lines for every compiler", "[shader]") {
    const ShaderSource shader = shader_of("// one\nfloat f(vec3 ro, vec3 rd, vec4 s) {\n    return nope;\n}\n");
    CHECK(errors_of("0:3(9): error: `nope' undeclared\n", shader) == "a.glsl:3:12: `nope' undeclared");
    CHECK(errors_of("ERROR: 0:3: 'nope' : undeclared identifier\nERROR: 1 compilation errors.\n", shader) ==
          "a.glsl:3:12: 'nope' : undeclared identifier");
    CHECK(errors_of("program.comp\nERROR: program.comp:3: 'nope' : undeclared identifier\nERROR: program.comp:3: '' : "
                    "compilation terminated\n",
                    shader) == "a.glsl:3:12: 'nope' : undeclared identifier");
    CHECK(errors_of("0(3) : error C1503: undefined variable \"nope\"\n", shader) ==
          "a.glsl:3:12: error C1503: undefined variable \"nope\"");
    CHECK(errors_of("0:1(1): warning: old\n0:3(9): error: a\n0:2(1): error: b\n", shader) ==
          "a.glsl:3:12: a\na.glsl:2:1: b");
    CHECK(has(errors_of("0:1000020(3): error: no function with name 'f'\n", shader),
              "a.glsl:2:7: the call of `f` is rejected"));
    CHECK(has(errors_of("out of memory\n", shader), "a.glsl:1:1: the driver's compiler rejects it"));
    CHECK(has(errors_of("", shader), "does not say why"));
    CHECK(has(errors_of("0:3(1): error: \x1b[2Jx\n", shader), "\\x1b[2Jx"));
}

TEST_CASE("shader text: a distance field is marched with the constants of the file", "[shader]") {
    ShaderSource shader = shader_of("float map(vec3 p) { return length(p) - 1.0; }");
    shader.march = {.hit_eps = 0.0001, .max_dist = 50, .max_steps = 128};
    const std::string program = write_program_text(shader, 32, 430);
    CHECK(has(program, "lb_k < 128"));
    CHECK(has(program, "lb_d < 1.00000000000000005e-04)"));
    CHECK(has(program, "lb_t > 5.00000000000000000e+01)"));
    CHECK(has(program, "= map(lb_point);"));
}

}  // namespace test_program_text
