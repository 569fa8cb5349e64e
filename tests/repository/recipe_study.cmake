# cmake -P recipe_study.cmake: follows the recipe "A study" of CONTRIBUTING.md on a copy of the sources. One file of at
# most 120 lines, and its include and its name in the list, must be enough for a command with help, shards and merge, a
# table with its description, a sheet, a claim, a section of the page, `diff`, the C library and Python.
#   CXX, ROOT (the repository), BUILD (its build folder), WORK (a folder), INCLUDES (other include folders)
#   PROGRAM: also builds the program and the library in the copy, and tests all of that. PYTHON (with numpy) is needed
file(REMOVE_RECURSE ${WORK})
set(study ${ROOT}/tests/repository/angle.hpp)
file(READ ${study} text)
string(REGEX MATCHALL "\n" ends "${text}")
list(LENGTH ends lines)
if(lines GREATER 120)
    message(FATAL_ERROR "the study of the recipe has ${lines} lines; at most 120 are allowed")
endif()
foreach(part CMakeLists.txt LICENSE analysis cmake data docs plugins python src)
    if(PROGRAM OR part STREQUAL "analysis")
        file(COPY ${ROOT}/${part} DESTINATION ${WORK})
    endif()
endforeach()
file(COPY ${study} DESTINATION ${WORK}/analysis/study)
set(list ${WORK}/analysis/study/studies.hpp)
file(READ ${list} text)
string(REPLACE "#include \"analysis/study/consistency.hpp\"\n"
    "#include \"analysis/study/angle.hpp\"\n#include \"analysis/study/consistency.hpp\"\n" text "${text}")
string(REPLACE "RenderAdapter>;" "RenderAdapter, AngleAdapter>;" text "${text}")
file(WRITE ${list} "${text}")

file(WRITE ${WORK}/listed.cpp [=[
#include "analysis/study/studies.hpp"
using namespace lostbits::analysis::study;
static_assert(std::tuple_size_v<Studies> == 4);
static_assert(lostbits::measure::study::Study<AngleAdapter::Study>);
void write(const AngleAdapter::Study& study) {
    lostbits::output::study::StudyWriter<AngleAdapter::Presentation>(study, {}).finish(
        lostbits::measure::study::run_study(study));
}
bool is_there() { return with_study("angle", [](auto adapter) { return !adapter.options().empty(); }); }
]=])
set(compile ${CXX} -std=c++20 -fsyntax-only -DGLM_FORCE_XYZW_ONLY -I${WORK} -I${WORK}/analysis -I${ROOT}/src
    -I${BUILD}/include -I${ROOT}/plugins)
foreach(folder ${INCLUDES})
    list(APPEND compile -I${folder})
endforeach()
execute_process(COMMAND ${compile} ${WORK}/listed.cpp RESULT_VARIABLE failed ERROR_VARIABLE errors)
if(failed)
    message(FATAL_ERROR "the study of the recipe does not compile:\n${errors}")
endif()
if(NOT PROGRAM)
    return()
endif()

execute_process(COMMAND ${CMAKE_COMMAND} -S ${WORK} -B ${WORK}/build -G Ninja -DCMAKE_BUILD_TYPE=Debug
    -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS_DEBUG=-O0 -g0" -DLOSTBITS_BUILD_TESTS=OFF -DLOSTBITS_BUILD_BENCH=OFF
    -DLOSTBITS_BUILD_PLUGINS=OFF -DLOSTBITS_PACK_WIDTHS=machine OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build --target lostbits lostbits_library -- -k 0
    OUTPUT_VARIABLE said RESULT_VARIABLE failed)
if(failed)
    message(FATAL_ERROR "the program with the study does not build:\n${said}")
endif()

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
set(near near-benign --size 16x16 -i sphere.unified -i sphere.schoolbook -f f32 -f f64)

# The command: help, tables and their description, pictures.
say("^0\n.*--unit.*--shard" angle --help)
say("^0\n.*sphere\\.unified f32: p50 [0-9.]+.*10\\^-6, p99 " angle ${near} --unit degree --pixels csv
    --pictures all -o whole)
hold(whole/near-benign/summary.csv "^form,format,hits,angle_p50,angle_p99,angle_max\nsphere\\.schoolbook,f32,[1-9]")
hold(whole/near-benign/sphere.unified.f32.csv "^x,y,angle\n")
hold(whole/near-benign/datapackage.json "\"angle_p99\"")
foreach(picture contact.png sphere.unified.f32.png sphere.unified.f32.exr)
    if(NOT EXISTS ${WORK}/whole/near-benign/${picture})
        message(SEND_ERROR "the study wrote no ${picture}")
    endif()
endforeach()
say("^2\n" angle near-benign --unit turn -o none)
say("^2\n" angle --unit degree sphere-distance -o none)

# Shards give the same bytes, and diff compares studies.
foreach(part 1/3 2/3 3/3)
    say("^0\n" angle ${near} --unit degree --pixels csv --pictures all --shard ${part} -o parts)
endforeach()
say("^0\n" merge parts -o merged)
say("^0\n" diff whole merged --strict)
say("^0\n" angle ${near} -o radians)
say("^1\n" diff whole/near-benign/summary.csv radians/near-benign/summary.csv --strict)

# A claim, its picture, and a section of the page.
foreach(case "0;[1e-9, 1e-3]" "1;[1, 2]")
    list(GET case 0 code)
    list(GET case 1 range)
    file(WRITE ${WORK}/claims.toml "schema = \"lostbits-claims/1\"\n[[claim]]\nid = \"angle\"\nsource = \"-\"\n"
        "statement = \"The normal turns by less than a thousandth of a degree\"\nverdict = \"holds\"\n"
        "evidence = \"sample\"\n"
        "[claim.given]\nstudy = \"angle\"\nscene = \"near-benign\"\noptions = { unit = \"degree\" }\n"
        "form = \"sphere.unified\"\nformat = \"f32\"\n"
        "[claim.expect]\nmetric = \"angle_p99\"\nin = ${range}\n")
    say("^${code}\n" check claims.toml --report claimed${code})
endforeach()
hold(claimed0/README.md "near-benign, angle")
hold(claimed0/README.md "pictures/near-benign\\.angle\\.png")
say("^0\n" report near-benign --no-claims -i sphere.unified -f f32 --size 16x16 --study angle:near-benign -o page)
hold(page/index.html "study-angle-near-benign")
say("^2\n" report near-benign --no-claims --study angel:near-benign -o none)

# The C library, and Python.
file(WRITE ${WORK}/study.c [=[
#include <lostbits.h>
#include <stdio.h>
int main(void) {
    lostbits_scene* scene = NULL;
    lostbits_result* result = NULL;
    lostbits_error error = {0};
    if (lostbits_scene_open("near-benign", NULL, &scene, &error) != LOSTBITS_OK) return 1;
    const char* unit[] = {"unit=degree"};
    const lostbits_words options = {unit, 1};
    if (lostbits_study("angle", scene, &options, NULL, NULL, &result, &error) != LOSTBITS_OK) return 2;
    puts("measured");
    return 0;
}
]=])
execute_process(COMMAND ${CXX} -x c -std=c99 -I${WORK}/analysis/library -I${WORK}/plugins ${WORK}/study.c -o ${WORK}/study -x none
    ${WORK}/build/liblostbits.so -Wl,-rpath,${WORK}/build COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/study WORKING_DIRECTORY ${WORK} OUTPUT_VARIABLE said RESULT_VARIABLE code)
if(NOT "${code}\n${said}" STREQUAL "0\nmeasured\n")
    message(SEND_ERROR "the C program ended with ${code} and says:\n${said}")
endif()
execute_process(COMMAND ${PYTHON} -c "import lostbits as lb
s = lb.study('angle', 'near-benign', 'sphere.unified', unit='degree')
print(sorted(s.summary)[:2], all(s.summary['angle_p99'] > 0))"
    WORKING_DIRECTORY ${WORK}/python OUTPUT_VARIABLE said ERROR_VARIABLE complained RESULT_VARIABLE code)
if(NOT "${code}\n${said}" MATCHES "^0\n.*angle_max.*True")
    message(SEND_ERROR "Python ended with ${code} and says:\n${said}\n${complained}")
endif()
