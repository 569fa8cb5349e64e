# cmake -P recipe_shape.cmake: follows the recipe "A shape" of CONTRIBUTING.md on a copy of the sources. The plane's
# folder, at most 120 lines, and its line and its include in the list must be enough: the list of shapes, the names of
# its numbers, a solid of plain numbers, the forms of the catalogue and the span over Ball must have it.
#   CXX, ROOT (the repository), WORK (a folder), INCLUDES (what the headers need besides)
#   PROGRAM: also build the whole program in the copy (with BUILD_WITH, for CMake), and try it
file(REMOVE_RECURSE ${WORK})
foreach(layer number geometry shapes intersect)
    file(COPY ${ROOT}/src/${layer} DESTINATION ${WORK}/src)
endforeach()

file(COPY ${ROOT}/tests/repository/plane DESTINATION ${WORK}/src/shapes)
file(GLOB_RECURSE files ${WORK}/src/shapes/plane/*)
set(lines 0)
foreach(file IN LISTS files)
    file(READ ${file} text)
    string(REGEX MATCHALL "\n" ends "${text}")
    list(LENGTH ends length)
    math(EXPR lines "${lines} + ${length}")
endforeach()
if(lines GREATER 120)
    message(FATAL_ERROR "the plane's folder has ${lines} lines")
endif()

set(list ${WORK}/src/shapes/list.hpp)
file(READ ${list} text)
string(REPLACE "    line(triangle, Triangle)\n" "    line(triangle, Triangle) \\\n    line(plane, Plane)\n" text "${text}")
string(REPLACE "FILE(triangle)\n" "FILE(triangle)\n#include LOSTBITS_SHAPE_FILE(plane)\n" text "${text}")
file(WRITE ${list} "${text}")

file(WRITE ${WORK}/shapes.cpp [=[
#include <cstdio>
#include "intersect/catalogue.hpp"
#include "intersect/takes.hpp"
#include "number/ball.hpp"
int main() {
    using namespace lostbits;
    for (const ShapeRow& row : shape_rows) std::printf("%s: %zu\n", row.name.data(), row.numbers);
    const Plane<double> plane{{0, 0, 3}, {0, 0, -2}};
    const Solid<double> solid(plane);
    std::printf("%s of %zu numbers, last %g\n", name_of(solid.shape).data(), solid.used().size(), solid.used().back());
    intersect::for_each_form([&]<class Form>() {
        if constexpr (intersect::shape_of<Form> == Shape::plane)
            std::printf("%s hits at %g\n", Form::info.name.data(),
                        intersect::intersect_solid<Form>(Ray<double>{{0, 1, 1}, {0, 0, 0.5}}, plane, 0.0).t);
    });
    const Plane<Ball> exact{{Ball(0), Ball(0), Ball(3)}, {Ball(0), Ball(0), Ball(-2)}};
    for (const double side : {-1, 1}) {
        const Ray<Ball> ray{{Ball(0), Ball(1), Ball(3 + 2 * side)}, {Ball(0), Ball(0), Ball(-0.5 * side)}};
        const auto ends = ends_of(exact.span(ray));
        std::printf("truly %g, and leaves at %g\n", ends->near.hi(), ends->far.hi());
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
set(expected "sphere: 4\nbox: 6\ntriangle: 9\nplane: 6\nplane of 6 numbers, last -2\nplane.quotient hits at 4\n"
    "truly 4, and leaves at 4\ntruly 4, and leaves at 4\n")
string(CONCAT expected ${expected})
if(NOT said STREQUAL expected)
    message(FATAL_ERROR "the shape of the recipe is not what it should be:\n${said}")
endif()
if(NOT PROGRAM)
    return()
endif()

# The whole program.
foreach(part CMakeLists.txt LICENSE analysis cmake data docs plugins src/CMakeLists.txt src/scene src/measure
        src/output)
    if(EXISTS ${ROOT}/${part})
        get_filename_component(folder ${WORK}/${part} DIRECTORY)
        file(COPY ${ROOT}/${part} DESTINATION ${folder})
    endif()
endforeach()
execute_process(COMMAND ${CMAKE_COMMAND} -S ${WORK} -B ${WORK}/build -G Ninja -DCMAKE_BUILD_TYPE=Debug
    -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS_DEBUG=-O0 -g0" -DLOSTBITS_BUILD_TESTS=OFF -DLOSTBITS_BUILD_BENCH=OFF
    -DLOSTBITS_BUILD_PLUGINS=OFF OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build --target lostbits -- -k 0
    OUTPUT_VARIABLE said RESULT_VARIABLE failed)
if(failed)
    message(FATAL_ERROR "the program with a plane does not build:\n${said}")
endif()

set(head "source = \"-\"\ntitle = \"A floor\"\n")
file(WRITE ${WORK}/floor.toml "schema = \"lostbits-scene/1\"\n${head}size = [16, 16]\n[camera]\nkind = \"pinhole\"\n"
    "eye = [0, 1, 0]\nlook_at = [0.25, 0, -3]\nup = [0, 1, 0]\nfov_deg = 90\n"
    "[[plane]]\npoint = [0.1, -0.2, 0.3]\nnormal = [0.1, 1, 0.2]\n")
file(WRITE ${WORK}/lower.toml "schema = \"lostbits-sweep/1\"\n${head}scene = \"floor.toml\"\n"
    "[[axis]]\nname = \"height\"\n"
    "unit = \"world\"\nspacing = \"log2\"\nfrom = 1\nto = 65536\nsteps = 3\n"
    "set = [\"plane[0].point[1]\"]\nfactors = [-1]\n")
# The second answer is wrong, the third ray passes by.
file(WRITE ${WORK}/rays.csv "ox,oy,oz,dx,dy,dz,px,py,pz,nx,ny,nz,hit,t\n0,0,5,0,0,-1,0,0,1,0,0,1,1,4\n"
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
say("^0\n.*plane\\.quotient" list intersectors)
say("^0\n" map floor.toml -i plane.* -f f32 -f f64 -o map)
hold(map/floor/summary.csv "\nplane\\.quotient,f32,256,199,57,0,0,0,0,")
say("^0\n" sweep lower.toml -i plane.* -f f32 -o sweep)
hold(sweep/lower/samples.csv "\n65536,0x1p.16,plane\\.quotient,f32,256,199,57,0,0,0,0,")
say("^0\n.*file\\.rays +f64 +2 +0 +0 +0 +0 +0\\.00 +50\\.00" judge rays.csv -o judge)
say("^0\n.*culprit is n\\.\\(P-o\\)" explain floor.toml --pixel 3,12 -i plane.quotient -f f32)
