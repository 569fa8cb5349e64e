# lostbits_add_formulas(NAME SOURCE [MORE…]): builds a library of the forms in SOURCE, which are written with
# lostbits_form.hpp. It contains them for every number type and register width, and is loaded with `lostbits …
# --plugin`. MORE is compiled once, for code that packs do not call. NAME.so is written to the build folder of the
# caller.
function(lostbits_add_formulas name source)
    add_library(${name} MODULE ${source} ${ARGN})
    target_link_libraries(${name} PRIVATE lostbits::core)
    target_compile_options(${name} PRIVATE -O2)
    # The narrowest width comes first. If several objects define a function, the linker keeps the first one, and that
    # must run on every processor.
    foreach(isa IN LISTS LOSTBITS_ISAS)
        add_library(${name}_${isa} OBJECT ${source})
        target_include_directories(${name}_${isa} PRIVATE
            $<TARGET_PROPERTY:lostbits::core,INTERFACE_INCLUDE_DIRECTORIES>)
        target_link_libraries(${name}_${isa} PRIVATE glm::glm)
        lostbits_isa_flags(${name}_${isa} ${isa})
        target_sources(${name} PRIVATE $<TARGET_OBJECTS:${name}_${isa}>)
        set_target_properties(${name}_${isa} PROPERTIES POSITION_INDEPENDENT_CODE ON)
        list(APPEND all ${name}_${isa})
    endforeach()
    # The library has its own copy of the code that it shares with the program, and hides its symbols.
    set_target_properties(${name} PROPERTIES PREFIX "")
    target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
    foreach(target ${name} ${all})
        set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
        target_compile_features(${target} PRIVATE cxx_std_20)
        # The first error of a formula says what is wrong. The next ones repeat it for other number types.
        target_compile_options(${target} PRIVATE -Wfatal-errors)
    endforeach()
endfunction()
