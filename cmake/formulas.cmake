# lostbits_add_formulas(NAME SOURCE [MORE…]): a library of the forms in SOURCE, written with lostbits_form.hpp, in every
# arithmetic and for each width of registers, to be loaded with `lostbits … --plugin`. MORE is compiled once, and is for
# what packs do not call. NAME.so lies in the folder of the build that calls.
function(lostbits_add_formulas name source)
    add_library(${name} MODULE ${source} ${ARGN})
    target_link_libraries(${name} PRIVATE lostbits::core)
    target_compile_options(${name} PRIVATE -O2)
    # The narrowest comes first: of a function that several objects define, the linker keeps the first, and that one
    # runs everywhere.
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
    # What the library shares with the program it brings along, and keeps to itself.
    set_target_properties(${name} PROPERTIES PREFIX "")
    target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
    foreach(target ${name} ${all})
        set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
        target_compile_features(${target} PRIVATE cxx_std_20)
        # The first error of a formula says what is wrong with it; those that follow are the same of other numbers.
        target_compile_options(${target} PRIVATE -Wfatal-errors)
    endforeach()
endfunction()
