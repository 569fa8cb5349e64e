# cmake -P recipe_form.cmake: follows the recipe "A form" of CONTRIBUTING.md literally, on a copy of the sources. One
# file and one line of the catalogue must be enough to put the form into every list of forms. The rules of a formula
# must hold for it: with an `if` in it, it must not compile over Archetype.
#   CXX, ROOT (the repository), WORK (a folder), INCLUDES (other include folders that the headers need)
file(REMOVE_RECURSE ${WORK})
foreach(layer text number geometry shapes intersect)
    file(COPY ${ROOT}/src/${layer} DESTINATION ${WORK}/src)
endforeach()

file(READ ${ROOT}/CONTRIBUTING.md recipes)
string(REGEX MATCH "`src/(shapes/sphere/forms/[a-z_]+\\.hpp)`" _ "${recipes}")
set(header ${CMAKE_MATCH_1})
string(REGEX MATCH "to the list of the shape: `([A-Za-z:]+),  //`" _ "${recipes}")
set(type ${CMAKE_MATCH_1})
string(FIND "${recipes}" "```cpp\n" begin)
if(NOT header OR NOT type OR begin EQUAL -1)
    message(FATAL_ERROR "CONTRIBUTING.md: the recipe of a form no longer gives its file, its type and its code in the "
        "pattern that recipe_form.cmake reads")
endif()
math(EXPR begin "${begin} + 7")
string(SUBSTRING "${recipes}" ${begin} -1 form)
string(FIND "${form}" "```" end)
string(SUBSTRING "${form}" 0 ${end} form)
file(WRITE ${WORK}/src/${header} "${form}")

set(catalogue ${WORK}/src/shapes/sphere/forms/forms.hpp)
file(READ ${catalogue} list)
string(REPLACE "#pragma once\n" "#pragma once\n#include \"${header}\"\n" list "${list}")
string(REGEX REPLACE "(using SphereForms = FormList<[^\n]*\n)" "\\1    ${type},  //\n" list "${list}")
file(WRITE ${catalogue} "${list}")

file(WRITE ${WORK}/forms.cpp [=[
#include <cstdio>
#include "intersect/catalogue.hpp"
int main() {
    using namespace lostbits;
    intersect::sphere::SphereForms::for_each([]<class Form>() {
        const Ray<float> ray{{0, 0, 5}, {0, 0, -1}};
        std::printf("%s %g\n", Form::info.name.data(), double(Form::intersect(ray, Sphere<float>{{0, 0, 0}, 1}).t));
    });
}
]=])
set(compile ${CXX} -std=c++20 -ffp-contract=off -DGLM_FORCE_XYZW_ONLY -I${WORK}/src)
foreach(folder ${INCLUDES})
    list(APPEND compile -I${folder})
endforeach()

execute_process(COMMAND ${compile} ${WORK}/forms.cpp -o ${WORK}/forms RESULT_VARIABLE failed ERROR_VARIABLE errors)
if(failed)
    message(FATAL_ERROR "the form of the recipe does not compile:\n${errors}")
endif()
execute_process(COMMAND ${WORK}/forms OUTPUT_VARIABLE forms)
if(NOT forms MATCHES "sphere\\.half_chord 4\n")
    message(FATAL_ERROR "the catalogue does not have the form of the recipe, or it does not hit at 4:\n${forms}")
endif()

set(archetype ${compile} -fsyntax-only ${ROOT}/tests/intersect/archetype_forms.cpp)
execute_process(COMMAND ${archetype} RESULT_VARIABLE failed ERROR_VARIABLE errors)
if(failed)
    message(FATAL_ERROR "the form of the recipe breaks a rule of a formula:\n${errors}")
endif()
string(REPLACE "const T h = sqrt(h2);" "T h = sqrt(h2);\n        if (h2 < T(0)) h = T(0);" branching "${form}")
file(WRITE ${WORK}/src/${header} "${branching}")
execute_process(COMMAND ${archetype} RESULT_VARIABLE failed ERROR_QUIET)
if(NOT failed)
    message(FATAL_ERROR "a form that branches on a mask compiles over Archetype, but it must not")
endif()
