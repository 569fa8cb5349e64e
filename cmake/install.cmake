# Installs the program, its image module and its data. Also installs the libraries as the CMake package `lostbits`
# (targets lostbits::core, lostbits::scene, lostbits::measure), for programs that use the numbers, the forms or the
# truth.
include(CMakePackageConfigHelpers)

install(TARGETS lostbits RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS lostbits_library LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
# The program looks in lib/lostbits, whatever the system calls its folder of libraries.
install(TARGETS lostbits_image LIBRARY DESTINATION lib/lostbits)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/lostbits RENAME copyright)
install(FILES analysis/library/lostbits.h plugins/lostbits_dump.h plugins/lostbits_plugin.h plugins/lostbits_plugin.hpp plugins/lostbits_form.hpp
    ${PROJECT_BINARY_DIR}/include/lostbits_build.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/lostbits/data FILES_MATCHING PATTERN "*.toml" PATTERN "dumps/*")

set(layers text number geometry shapes intersect scene measure)
foreach(room IN LISTS layers)
    install(DIRECTORY src/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lostbits FILES_MATCHING PATTERN "*.hpp")
endforeach()
# An installed header is included as <lostbits/number/error.hpp>, never as "number/error.hpp": that could be mixed up
# with a header of another project.
string(REPLACE ";" "|" layers "${layers}")
install(CODE "set(include \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}\")
set(layers \"${layers}\")")
install(CODE [[
    file(GLOB_RECURSE headers "${include}/lostbits/*.hpp")
    foreach(header IN LISTS headers ITEMS "${include}/lostbits_plugin.hpp" "${include}/lostbits_form.hpp")
        file(READ "${header}" text)
        string(REGEX REPLACE "#include \"((${layers})/[^\"]*)\"" "#include <lostbits/\\1>" text "${text}")
        file(WRITE "${header}" "${text}")
    endforeach()
]])
foreach(library core external scene measure)
    set_target_properties(lostbits_${library} PROPERTIES EXPORT_NAME ${library})
    add_library(lostbits::${library} ALIAS lostbits_${library})
endforeach()
install(TARGETS lostbits_core lostbits_external lostbits_scene lostbits_measure EXPORT lostbits-targets ARCHIVE DESTINATION
    ${CMAKE_INSTALL_LIBDIR})

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/lostbits)
install(EXPORT lostbits-targets NAMESPACE lostbits:: DESTINATION ${package_dir})
configure_package_config_file(cmake/lostbits-config.cmake.in lostbits-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(lostbits-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/lostbits-config.cmake
    ${CMAKE_CURRENT_BINARY_DIR}/lostbits-config-version.cmake
              cmake/FindMPFR.cmake cmake/FindMPFI.cmake cmake/isa.cmake cmake/formulas.cmake
        DESTINATION ${package_dir})

# Writes the flags with which a compiler called by hand makes a library of forms:
#   c++ -shared mine.cpp -o mine.so @form.flags
function(lostbits_form_flags file library)
    list(TRANSFORM ARGN REPLACE "(.+)" "\"-I\\1\"" OUTPUT_VARIABLE includes)
    list(JOIN includes " " includes)
    file(GENERATE OUTPUT ${file} CONTENT "-std=c++20 -O2 -fPIC -fvisibility=hidden -Wfatal-errors
$<JOIN:${LOSTBITS_ARITHMETIC_FLAGS}, > -DGLM_FORCE_XYZW_ONLY ${includes}
\"${library}\" -lmpfi -lmpfr -Wl,--exclude-libs,ALL
" TARGET lostbits_core)
endfunction()

# Writes the flags for its packs: c++ -c mine.cpp -o packs.o @form.flags @form.w256.flags. The command above then also
# takes packs.o.
foreach(isa IN LISTS LOSTBITS_PACK_ISAS)
    set(words "$<TARGET_PROPERTY:lostbits_packed_${isa},COMPILE_DEFINITIONS>")
    set(options "$<FILTER:$<TARGET_PROPERTY:lostbits_packed_${isa},COMPILE_OPTIONS>,INCLUDE,^-(m|O|ffp|fno)>")
    file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/form.${isa}.flags CONTENT
        "-D$<JOIN:${words}, -D> $<JOIN:${options}, >\n" TARGET lostbits_packed_${isa})
    install(FILES ${PROJECT_BINARY_DIR}/form.${isa}.flags DESTINATION lib/lostbits)
endforeach()

lostbits_form_flags(${PROJECT_BINARY_DIR}/form.flags $<TARGET_FILE:lostbits_core> ${PROJECT_SOURCE_DIR}/src
    ${PROJECT_SOURCE_DIR}/plugins ${PROJECT_BINARY_DIR}/include)
lostbits_form_flags(${PROJECT_BINARY_DIR}/installed/form.flags @PREFIX@/${CMAKE_INSTALL_LIBDIR}/liblostbits_core.a
    @PREFIX@/${CMAKE_INSTALL_INCLUDEDIR})
install(CODE "file(READ \"${PROJECT_BINARY_DIR}/installed/form.flags\" flags)")
install(CODE [[
    string(REPLACE @PREFIX@ "${CMAKE_INSTALL_PREFIX}" flags "${flags}")
    file(WRITE "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/lib/lostbits/form.flags" "${flags}")
]])
