# cmake -P recipe_shape.cmake: follows the recipe "A shape" of CONTRIBUTING.md on a copy of the sources. The folder of
# half spaces, of at most 120 lines, with a line and an include in the list, must be enough. Then the list of shapes,
# the names of its numbers, a primitive of plain numbers, the forms of the catalogue and the span over Ball must have
# it.
#   CXX, ROOT (the repository), WORK (a folder), INCLUDES (other include folders that the headers need)
#   PROGRAM: also builds the whole program in the copy, with a file of metrics and its entry in the list, and tests both
file(REMOVE_RECURSE ${WORK})
foreach(layer text number geometry shapes intersect)
    file(COPY ${ROOT}/src/${layer} DESTINATION ${WORK}/src)
endforeach()

file(COPY ${ROOT}/tests/repository/half_space DESTINATION ${WORK}/src/shapes)
file(GLOB_RECURSE files ${WORK}/src/shapes/half_space/*)
set(lines 0)
foreach(file IN LISTS files)
    file(READ ${file} text)
    string(REGEX MATCHALL "\n" ends "${text}")
    list(LENGTH ends length)
    math(EXPR lines "${lines} + ${length}")
endforeach()
if(lines GREATER 120)
    message(FATAL_ERROR "the folder of half spaces has ${lines} lines; at most 120 are allowed")
endif()

set(list ${WORK}/src/shapes/list.hpp)
file(READ ${list} text)
string(REPLACE "    line(torus, Torus)\n" "    line(torus, Torus) \\\n    line(half_space, HalfSpace)\n" text "${text}")
string(REPLACE "FILE(torus)\n" "FILE(torus)\n#include LOSTBITS_SHAPE_FILE(half_space)\n" text "${text}")
file(WRITE ${list} "${text}")

file(WRITE ${WORK}/shapes.cpp [=[
#include <cstdio>
#include "intersect/catalogue.hpp"
#include "intersect/form_shape.hpp"
#include "number/ball.hpp"
int main() {
    using namespace lostbits;
    for (const ShapeRow& row : shape_rows) std::printf("%s: %zu\n", row.name.data(), row.number_count);
    const HalfSpace<double> half{{0, 0, 3}, {0, 0, -2}};
    const Primitive<double> primitive(half);
    std::printf("%s of %zu numbers, last %g\n", name_of(primitive.shape).data(), primitive.shape_numbers().size(), primitive.shape_numbers().back());
    intersect::AllForms::for_each([&]<class Form>() {
        if constexpr (intersect::shape_of<Form> == Shape::half_space)
            std::printf("%s hits at %g\n", Form::info.name.data(),
                        intersect::intersect_primitive<Form>(Ray<double>{{0, 1, 1}, {0, 0, 0.5}}, half, 0.0).t);
    });
    const HalfSpace<Ball> exact{{Ball(0), Ball(0), Ball(3)}, {Ball(0), Ball(0), Ball(-2)}};
    for (const double side : {-1, 1}) {
        const Ray<Ball> ray{{Ball(0), Ball(1), Ball(3 + 2 * side)}, {Ball(0), Ball(0), Ball(-0.5 * side)}};
        const auto ends = ends_of(exact.span(ray));
        std::printf("truly %s at %g\n", side < 0 ? "in" : "out", side < 0 ? ends->near.hi() : ends->far.hi());
    }
}
]=])
set(compile ${CXX} -std=c++20 -ffp-contract=off -DGLM_FORCE_XYZW_ONLY -I${WORK}/src)
foreach(folder ${INCLUDES})
    list(APPEND compile -I${folder})
endforeach()
execute_process(COMMAND ${compile} ${WORK}/shapes.cpp -o ${WORK}/shapes RESULT_VARIABLE failed ERROR_VARIABLE errors)
if(failed)
    message(FATAL_ERROR "the shape of the recipe does not compile:\n${errors}")
endif()
execute_process(COMMAND ${WORK}/shapes OUTPUT_VARIABLE said)
set(expected "sphere: 4\nbox: 6\ntriangle: 9\nellipsoid: 6\ncylinder: 7\ncapsule: 7\ntube: 7\ncone: 8\ndisc: 8\nplane: 6\ntorus: 8\nhalf_space: 6\n"
    "half_space of 6 numbers, last -2\nhalf_space.quotient hits at 4\n"
    "truly in at 4\ntruly out at 4\n")
string(CONCAT expected ${expected})
if(NOT said STREQUAL expected)
    message(FATAL_ERROR "the shape of the recipe is not what it should be:\n${said}")
endif()
if(NOT PROGRAM)
    return()
endif()

# Build the whole program.
foreach(part CMakeLists.txt LICENSE analysis cmake data docs plugins src/CMakeLists.txt src/scene src/measure
        src/output)
    if(EXISTS ${ROOT}/${part})
        get_filename_component(folder ${WORK}/${part} DIRECTORY)
        file(COPY ${ROOT}/${part} DESTINATION ${folder})
    endif()
endforeach()
file(WRITE ${WORK}/src/measure/metric/lateness.hpp [=[
#pragma once
#include "measure/metric/metrics.hpp"
namespace lostbits::measure::metric {
inline constexpr Metric metrics_of_lateness[] = {
    table_row({"lateness", "length", "recipe.lateness"}, "t - RN(t*)",
              [](const Sample& s) { return s.t - s.rounded_truth; },
              {.needs = needs_rounded_truth, .ramp = Ramp::magnitude, .low = 0x1p-30, .high = 1})};
}
]=])
set(metrics ${WORK}/src/measure/metric/metrics.cpp)
file(READ ${metrics} text)
string(REPLACE "#include \"measure/metric/values.hpp\"\n"
    "#include \"measure/metric/lateness.hpp\"\n#include \"measure/metric/values.hpp\"\n" text "${text}")
string(REPLACE "metrics_of_barycentrics()});" "metrics_of_barycentrics(), metrics_of_lateness});" text "${text}")
file(WRITE ${metrics} "${text}")
execute_process(COMMAND ${CMAKE_COMMAND} -S ${WORK} -B ${WORK}/build -G Ninja -DCMAKE_BUILD_TYPE=Debug
    -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS_DEBUG=-O0 -g0" -DLOSTBITS_BUILD_TESTS=OFF -DLOSTBITS_BUILD_BENCH=OFF
    -DLOSTBITS_BUILD_PLUGINS=OFF OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build --target lostbits -- -k 0
    OUTPUT_VARIABLE said RESULT_VARIABLE failed)
if(failed)
    message(FATAL_ERROR "the program with a half space does not build:\n${said}")
endif()

set(head "source = \"-\"\ntitle = \"A floor\"\n")
file(WRITE ${WORK}/floor.toml "schema = \"lostbits-scene/1\"\n${head}size = [16, 16]\n[camera]\nkind = \"pinhole\"\n"
    "eye = [0, 1, 0]\nlook_at = [0.25, 0, -3]\nup = [0, 1, 0]\nfov_deg = 90\n"
    "[[half_space]]\npoint = [0.1, -0.2, 0.3]\nnormal = [0.1, 1, 0.2]\n")
file(WRITE ${WORK}/lower.toml "schema = \"lostbits-sweep/1\"\n${head}scene = \"floor.toml\"\n"
    "[[axis]]\nname = \"height\"\n"
    "unit = \"world\"\nspacing = \"log2\"\nfrom = 1\nto = 65536\nsteps = 3\n"
    "set = [\"half_space[0].point[1]\"]\nfactors = [-1]\n")
# The second answer is wrong. The third ray misses.
file(WRITE ${WORK}/rays.csv "ox,oy,oz,dx,dy,dz,ax,ay,az,vx,vy,vz,hit,t\n0,0,5,0,0,-1,0,0,1,0,0,1,1,4\n"
    "0,0,5,0,0,-1,0,0,1,0,0,1,1,4.5\n0,0,5,1,0,0,0,0,1,0,0,1,0,\n")
function(say expected)
    execute_process(COMMAND ${WORK}/build/lostbits ${ARGN} WORKING_DIRECTORY ${WORK} OUTPUT_VARIABLE said
        ERROR_VARIABLE complained RESULT_VARIABLE code)
    if(NOT "${code}\n${said}" MATCHES "${expected}")
        message(SEND_ERROR "lostbits ${ARGN} ended with ${code} and says:\n${said}\n${complained}")
    endif()
endfunction()
function(hold file expected)
    file(READ ${WORK}/${file} text)
    if(NOT text MATCHES "${expected}")
        message(SEND_ERROR "${file} holds:\n${text}")
    endif()
endfunction()
say("^0\n.*half_space\\.quotient" list intersectors)
say("^0\n" map floor.toml -i half_space.* -f f32 -f f64 -o map)
hold(map/floor/summary.csv "\nhalf_space\\.quotient,f32,256,199,57,0,0,0,0,")
say("^0\n.*lateness" list metrics)
say("^0\n" map floor.toml -i half_space.* -f f32 --metric lateness --pixels csv --pictures all -o metric)
hold(metric/floor/half_space.quotient.f32.csv ",lateness")
hold(metric/floor/summary.csv "lateness_max")
if(NOT EXISTS ${WORK}/metric/floor/half_space.quotient.f32.png)
    message(SEND_ERROR "the picture of the metric was not written")
endif()
say("^0\n" sweep lower.toml -i half_space.* -f f32 -o sweep)
hold(sweep/lower/samples.csv "\n65536,0x1p.16,half_space\\.quotient,f32,256,199,57,0,0,0,0,")
say("^0\n.*file\\.rays +f64 +2 +0 +0 +0 +0 +0\\.00 +50\\.00" judge rays.csv -o judge)
# Test random rays from the ray distribution in its folder, and time them.
file(WRITE ${WORK}/size.toml "schema = \"lostbits-sweep/1\"\n${head}[half_space_rays]\nviews = 64\n"
    "[[axis]]\nname = \"distance\"\nunit = \"sizes\"\nspacing = \"log2\"\nfrom = 1\nto = 65536\nsteps = 2\n"
    "set = [\"distance\"]\n")
say("^0\n" sweep size.toml -i half_space.* -f f32 -o drawn)
hold(drawn/size/samples.csv "\n65536,0x1p.16,half_space\\.quotient,f32,64,64,0,0,0,0,0,")
say("^0\n.*half_space\\.quotient" trade --shape half_space --quick -o trade)
# Test the same formula from outside: through the C interface, as a form in a library, and as a shader.
file(WRITE ${WORK}/outside.c [=[
#include <lostbits_plugin.h>
static const char* run(const lb_batch* b) {
    for (size_t i = 0; i < b->size; ++i) {
        const double *r = (const double*)b->rays + 6 * i, *p = (const double*)b->primitives + b->primitive_stride * i;
        double n = 0, m = 0;
        for (int k = 0; k < 3; ++k) n += p[3 + k] * (p[k] - r[k]), m += p[3 + k] * r[3 + k];
        ((double*)b->near_far)[2 * i] = n >= 0 ? 0 : n / m;
        b->hit[i] = n >= 0 || n / m >= 0;
    }
    return NULL;
}
const lb_form* lostbits_forms(int abi, size_t* count) {
    static const lb_form form = {.name = "outside.half_space", .shape = 11, .format = LB_F64, .roots = LB_FIRST,
                                 .flags = LB_NO_END, .run = run};
    *count = 1;
    return abi == LOSTBITS_PLUGIN_ABI ? &form : NULL;
}
]=])
file(WRITE ${WORK}/header.cpp [=[
#include <lostbits_form.hpp>
using namespace lostbits;
struct Header {
    static constexpr intersect::Info info{.name = "header.half_space", .roots = intersect::Roots::first_only};
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const HalfSpace<T>& half) {
        const T n = dot(half.normal, half.point - ray.origin);
        const T t = select(n >= T(0), T(0), n / dot(half.normal, ray.direction));
        return {t >= T(0), t, t, t};
    }
};
LOSTBITS_FORMULAS(Header)
]=])
file(WRITE ${WORK}/half_space.glsl "// lostbits: direction=any roots=first\n"
    "float half_space(vec3 ro, vec3 rd, vec3 normal, vec3 point) {\n"
    "    float n = dot(normal, point - ro);\n    return n >= 0.0 ? 0.0 : n / dot(normal, rd);\n}\n")
execute_process(COMMAND ${CXX} -x c -std=c99 -O2 -ffp-contract=off -fPIC -shared -I${WORK}/plugins ${WORK}/outside.c
    -o ${WORK}/outside.so COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CXX} -shared ${WORK}/header.cpp -o ${WORK}/header.so @${WORK}/build/form.flags
    COMMAND_ERROR_IS_FATAL ANY)
say("^0\n.*outside\\.half_space in binary64, a half_space: keeps its contract" plugin check ${WORK}/outside.so)
say("^0\n.*header\\.half_space" plugin check ${WORK}/header.so)
file(READ ${WORK}/outside.c outside)
string(REPLACE "0 : n / m;" "0 : 2 * n / m;" outside "${outside}")
file(WRITE ${WORK}/wrong.c "${outside}")
execute_process(COMMAND ${CXX} -x c -std=c99 -O2 -ffp-contract=off -fPIC -shared -I${WORK}/plugins ${WORK}/wrong.c
    -o ${WORK}/wrong.so COMMAND_ERROR_IS_FATAL ANY)
say("^1\n.*BROKEN t +t is wrong \\(origin \\(0, 0, 5\\), direction \\(0, 0, -1\\), .*7 is right, it answers 14"
    plugin check ${WORK}/wrong.so)
say("^0\n" map floor.toml --plugin ${WORK}/outside.so --plugin ${WORK}/header.so -i *.half_space -f f64 -o doors)
hold(doors/floor/summary.csv "\noutside\\.half_space,f64,256,199,57,0,0,0,0,")
hold(doors/floor/summary.csv "\nheader\\.half_space,f64,256,199,57,0,0,0,0,")
say("^0\n.*shader\\.half_space in binary32, a half_space: keeps its contract" plugin check --shader ${WORK}/half_space.glsl)
say("^0\n" map floor.toml --shader ${WORK}/half_space.glsl -i shader.half_space -f f32 -o shader)
hold(shader/floor/summary.csv "\nshader\\.half_space,f32,256,199,57,0,0,0,0,")
say("^0\n.*culprit is n\\.\\(P-o\\)" explain floor.toml --pixel 3,12 -i half_space.quotient -f f32)
